# SPDX-License-Identifier: GPL-2.0-only
"""What ``expect`` can ask of the wind."""

MEASURES = {("wind", "work"): lambda m, e: m.at(m.ledger("wind")[0] - m.ledger("wind"), e.time)}
