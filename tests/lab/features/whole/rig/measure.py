# SPDX-License-Identifier: GPL-2.0-only
"""What ``expect`` can ask of the rig."""

MEASURES = {("rig", "work"): lambda m, e: m.at(m.ledger("work"), e.time)}
