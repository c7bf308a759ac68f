# SPDX-License-Identifier: GPL-2.0-only
"""The socket on which a view listens: strangers that connect and say nothing are in nothing's way."""

from __future__ import annotations

import errno
import resource
import socket
import threading
import time
from collections import deque
from contextlib import suppress

HOST = "127.0.0.1"
MOST_WAITING = 64
"""Connections that are not pages at a time: the oldest gives way to one more. Each takes two descriptors or three."""
NO_ROOM = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)
"""Errors of a system that has no descriptor or memory for a connection."""
NAP = 0.05
"""Seconds before such a connection is tried again."""


class Listener(socket.socket):
    """Listens on this machine only; never gives up.

    Args:
        port: 0 takes a free one.

    Raises OSError where the port is taken.
    """

    def __init__(self, port: int):
        super().__init__(socket.AF_INET, socket.SOCK_STREAM)
        self._waiting: deque[socket.socket] = deque()
        self._turn = threading.Lock()
        limit = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
        self._most = MOST_WAITING if limit == resource.RLIM_INFINITY else max(1, min(MOST_WAITING, limit // 12))
        try:
            self.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self.bind((HOST, port))
            self.listen()
        except OSError:
            self.close()
            raise

    def accept(self) -> tuple[socket.socket, tuple]:
        """See `socket.socket.accept`. Raises OSError only where this socket was closed."""
        while True:
            try:
                connection, address = super().accept()
            except OSError as error:
                if error.errno == errno.ECONNABORTED:
                    continue
                if error.errno not in NO_ROOM:
                    raise
                self._keep(len(self._waiting) // 2)
                time.sleep(NAP)
                continue
            with self._turn:
                self._waiting.append(connection)
            self._keep(self._most)
            return connection, address

    def admit(self, connection: socket.socket) -> None:
        """Take note that a connection is a page: it does not give way."""
        with self._turn:
            self._waiting = deque(other for other in self._waiting if other is not connection)

    def _keep(self, most: int) -> None:
        """Break off the oldest connections, except the ``most`` latest."""
        with self._turn:
            self._waiting = deque(other for other in self._waiting if other.fileno() >= 0)
            while len(self._waiting) > most:
                with suppress(OSError):  # it may have ended
                    self._waiting.popleft().shutdown(socket.SHUT_RDWR)
