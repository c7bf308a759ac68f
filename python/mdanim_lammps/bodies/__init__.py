# SPDX-License-Identifier: GPL-2.0-only
"""Kinds of bodies: what objects are made of. The kinds themselves are in the folders of features, module ``body``."""

from .kind import BodyKind, all_held, beneath, driven, kind_of, kinds, only_features, unguided

__all__ = ["BodyKind", "all_held", "beneath", "driven", "kind_of", "kinds", "only_features", "unguided"]
