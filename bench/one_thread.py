# SPDX-License-Identifier: GPL-2.0-only
"""Import this where times are those of one thread: without a word of the caller, runs take all cores that pay."""

import os

os.environ.setdefault("MDANIM_THREADS", "1")
