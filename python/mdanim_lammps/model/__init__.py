# SPDX-License-Identifier: GPL-2.0-only
"""Solids as particles and springs: ``plan_spacing``, ``build_models``, ``check_geometry``."""

from .build import build_models
from .model import Layer, Model, Surface
from .overlap import check_geometry
from .spacing import Spacing, plan_spacing

__all__ = ["Layer", "Model", "Spacing", "Surface", "build_models", "check_geometry", "plan_spacing"]
