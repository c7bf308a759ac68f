# SPDX-License-Identifier: GPL-2.0-only
"""Air that pushes at drawn surfaces: drag, wind, lift of plates (docs/physics-air.md)."""
