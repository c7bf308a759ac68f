# SPDX-License-Identifier: GPL-2.0-only
"""Words of a liquid that only some models have, above all what makes waves."""

from __future__ import annotations

from .formatting import say, vector
from .scene import Liquid, LiquidModel


def check_waves(liquid: Liquid, block, problem) -> None:
    """Makers only with waves, only inside the basin, and with a rate; ``problem`` takes a span, a cause and a way out."""
    waves = liquid.model is LiquidModel.WAVES
    for word in ("sweeps",) if waves else ("calm", "drops", "wave", "current", "inflow", "drain"):
        if getattr(liquid, word):
            cause, way_out = f"model {liquid.model.value} has no {word}", "surface" if waves else "waves"
            problem(block.first(word).span(), cause, f"leave the line out, or write model {way_out}")
    for word in ("inflow", "drain"):
        for s, flow in zip(block.settings.get(word, ()), getattr(liquid, word)):
            corners = list(zip(flow.low, flow.high, liquid.low, liquid.high))
            if any(high < low or high < bottom or low > top for low, high, bottom, top in corners):
                cause = f"the {word} from {vector(flow.low)} to {vector(flow.high)} m is not a part of the basin"
                problem(s.span(), cause, f"the basin goes from {vector(liquid.low)} to {vector(liquid.high)} m")
            if not flow.rate > 0.0:
                problem(s.span(), f"the rate of the {word} must be > 0, found {say(flow.rate, 'm^3/s')}", "e.g. 0.002 m^3/s")
