# SPDX-License-Identifier: GPL-2.0-only
"""Kinds of bodies: what objects are made of. The kinds themselves are in the folders of features, module ``body``."""

from ..scene.holding import all_held, lets_go
from .kind import BodyKind, beneath, driven, kind_of, kinds, only_features, unguided

__all__ = ["BodyKind", "all_held", "beneath", "driven", "kind_of", "kinds", "lets_go", "only_features", "unguided"]
