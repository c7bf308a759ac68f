# SPDX-License-Identifier: GPL-2.0-only
"""A quantity beside its limit: the entry of the certificate for every limit that a scene has to keep."""

from __future__ import annotations

import math
from dataclasses import asdict

from ..errors import Span
from ..records import dataclass


@dataclass(frozen=True, slots=True)
class Margin:
    """A quantity beside its limit, for the object where it comes closest."""

    name: str
    """``time step``, ``contact``, ``load`` ..."""
    object: str
    """Name of the object."""
    value: float
    limit: float
    unit: str
    """Unit of value and limit; empty for ratios."""
    text: str
    """Both in a sentence."""
    span: Span | None
    """Scene line of the setting that would change it."""
    severity: str
    """``ok``, ``warning`` or ``refused``."""
    least: bool = False
    """Whether the value is to be above the limit, not below."""
    hint: str = ""
    """The way out: words to write instead."""

    @property
    def used(self) -> float:
        """Part of the limit that is used [-]: more than 1 is beyond it."""
        if self.least:
            return self.limit / self.value if self.value else math.inf
        return self.value / self.limit

    def to_json(self) -> dict:
        """Plain data for certificate.json."""
        numbers = {
            k: v if math.isfinite(v) else None for k, v in (("value", self.value), ("limit", self.limit), ("used", self.used))
        }
        return {**asdict(self), **numbers, "span": str(self.span) if self.span else None}
