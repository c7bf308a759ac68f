# SPDX-License-Identifier: GPL-2.0-only
"""What ``expect`` can ask of contact."""

MEASURES = {("penetration", "max"): lambda m, e: m.penetration}
