# SPDX-License-Identifier: GPL-2.0-only
"""``python -m mdanim_lammps``."""

from .cli import main

if __name__ == "__main__":
    main()
