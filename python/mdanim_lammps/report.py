# SPDX-License-Identifier: GPL-2.0-only
"""The lines that the command line prints: a scene, its effects, its certificate, its cost."""

from __future__ import annotations

from .driver.prepare import Prepared
from .driver.run import Progress, Result
from .effects import Verdict
from .results.trajectory import trajectory_bytes


def count(number: int, noun: str) -> str:
    """``1 object``, ``2 197 particles``."""
    return f"{number:,}".replace(",", " ") + f" {noun}" + ("" if number == 1 else "s")


def scene_line(ready: Prepared) -> str:
    """One line: what is in the scene, what is on, what is off and why."""
    on = [v.name for v in ready.verdicts.values() if v.on]
    off = [f"{v.name} ({v.reason})" for v in ready.verdicts.values() if not v.on]
    file = ready.scene.path.name if ready.scene.path else ready.scene.name
    title = f"'{ready.scene.title}'  " if ready.scene.title else ""
    return (f"scene    {file}  {title}{count(len(ready.system.names), 'object')} ({count(ready.system.particles, 'particle')}); "
            f"effects: {', '.join(on) or 'none'}" + (f"   off: {', '.join(off)}" if off else ""))


def certificate_line(ready: Prepared) -> str:
    """One line: time step, bound and what sets it."""
    c = ready.certificate
    return f"certify  {c}   {count(c.steps, 'step')}, {c.steps_per_frame} per frame"


def output_line(ready: Prepared) -> str:
    """One line: how large the trajectory will be."""
    c, control = ready.certificate, ready.scene.control
    frames = 1 + c.frames + bool(c.last_steps)
    size = trajectory_bytes(ready.models, frames, control.save, control.single)
    return f"output   {count(frames, 'frame')}, trajectory of {size / 1e6:.3g} MB"


def effect_line(verdict: Verdict) -> str:
    """One line of ``check``: an effect, on or off, its reason and scene line."""
    place = f"  [{verdict.span}]" if verdict.span else ""
    return f"  {'on ' if verdict.on else 'off'}  {verdict.name:<10} {verdict.reason}{place}"


def progress_line(p: Progress) -> str:
    """The moving line of a run."""
    each = p.seconds / max(1, p.step - p.first_step)
    left = each * (p.steps - p.step)
    return (f"t={p.time:.2f} s  step {p.step}/{p.steps}  energy residual {p.residual:.1e}  "
            f"{1e3 * each:.2f} ms/step  {left:.0f} s left")


def cost_line(result: Result, simulated: float) -> str:
    """One line: where the wall time went."""
    total = sum(result.cost.values())
    parts = sorted(result.cost.items(), key=lambda item: -item[1])
    shares = "  ".join(f"{name} {100 * s / total:.0f}%" for name, s in parts if s >= 0.005 * total)
    return f"cost     {shares}   total {total:.1f} s, {simulated / total:.2g} of real time"


def check_json(ready: Prepared) -> dict:
    """What ``check --format json`` prints."""
    return {
        "scene": str(ready.scene.path) if ready.scene.path else ready.scene.name,
        "objects": [{"name": m.name, "particles": len(m.position), "springs": len(m.spring), "cell": list(m.cell)}
                    for m in ready.models],
        "effects": {v.name: {"on": v.on, "reason": v.reason, "place": str(v.span) if v.span else None}
                    for v in ready.verdicts.values()},
        "certificate": ready.certificate.to_json(),
        "warnings": [{"message": w.message, "hint": w.hint, "place": str(w.span) if w.span else None}
                     for w in ready.warnings],
    }
