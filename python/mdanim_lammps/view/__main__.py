# SPDX-License-Identifier: GPL-2.0-only
"""``python -m mdanim_lammps.view DIR``: the process behind ``mdanim-lammps SCENE --view`` and ``mdanim-lammps view DIR``."""

from __future__ import annotations

import argparse
import threading
from pathlib import Path

from ..terminal import documented_exit, open_streams, stop_on_sigterm


def serve(
    folder: Path,
    *,
    port: int = 0,
    linger: float | None = None,
    edit: bool = False,
    hands: bool = False,
    scene: Path | None = None,
    on_address=lambda address: None,
) -> None:
    """Serve the view of an output folder until Ctrl-C, or for ``linger`` seconds after the run's end without a page.

    With ``edit`` pages may change the text, that of ``scene`` or of the folder's scene.lock.txt, and run it again; with ``hands``
    they may pull at objects.
    ``on_address`` is called with the address of the page. Raises OutputError, UsageError.
    """
    from ..errors import UsageError
    from .edit import Editor
    from .pull import Puller
    from .server import ViewServer
    from .tail import Tail

    with Tail(folder) as tail:
        try:
            view = ViewServer(
                tail,
                port=port,
                linger=linger,
                editor=Editor(folder, scene) if edit else None,
                puller=Puller(tail) if hands else None,
            )
        except OSError as error:
            raise UsageError(f"--port {port}: {error.strerror}; leave it out, and a free one is taken") from error
        ahead = threading.Thread(target=tail.read_ahead, daemon=True)
        ahead.start()
        try:
            on_address(view.address)
            view.wait()
        finally:
            view.end()
            ahead.join()  # a thread that is in HDF5 when the program ends would hang it


def main() -> None:
    """Serve; the first line on stdout is the address of the page."""
    open_streams()
    stop_on_sigterm()
    parser = argparse.ArgumentParser(prog="python -m mdanim_lammps.view")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--linger", type=float)
    parser.add_argument("--edit", action="store_true")
    parser.add_argument("--hands", action="store_true")
    parser.add_argument("--scene", type=Path)
    given = parser.parse_args()
    with documented_exit(debug=False):
        options = {"port": given.port, "linger": given.linger, "edit": given.edit, "hands": given.hands, "scene": given.scene}
        serve(given.folder, **options, on_address=lambda address: print(address, flush=True))


if __name__ == "__main__":
    main()
