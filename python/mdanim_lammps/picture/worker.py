# SPDX-License-Identifier: GPL-2.0-only
"""A process that draws some of a movie's pictures: the task comes on stdin, raw pictures go to stdout."""

from __future__ import annotations

import os
import pickle
import sys

from ..errors import MdanimError
from ..results.trajectory import Trajectory
from .render import Painter


def main() -> int:
    path, render, size, action, frames = pickle.load(sys.stdin.buffer)
    # Whatever a graphics library prints must not get between the pictures.
    pictures = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    try:
        with Trajectory(path) as trajectory, Painter(trajectory, render, size=size, action=action) as painter:
            for frame in frames:
                pictures.write(painter.frame(frame))
                pictures.flush()
    except MdanimError as error:
        print(error, file=sys.stderr)
        return int(error.exit_code)
    except BrokenPipeError:
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
