# SPDX-License-Identifier: GPL-2.0-only
"""Parts of solids of another density: keels, loaded dice, ducks that right themselves (docs/physics-solids.md, Ballast)."""
