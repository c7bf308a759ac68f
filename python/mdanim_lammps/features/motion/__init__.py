# SPDX-License-Identifier: GPL-2.0-only
"""How whole objects move: what `expect` can ask of their centres of mass and of their spin."""
