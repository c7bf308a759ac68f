# SPDX-License-Identifier: GPL-2.0-only
"""How far beyond their reach lists are to look: ``python bench/skin.py [scene.txt …]`` prints a table in Markdown.

The same scene runs in one instance for each skin, frame by frame in turns. A narrow skin makes lists often, a wide one makes
them long. Bits are the same.
"""

import sys
import time
from pathlib import Path

import one_thread  # noqa: F401
from mdanim_lammps.engine import commands
from mdanim_lammps.engine.instance import Instance
from mdanim_lammps.run.prepare import prepare
from mdanim_lammps.scene.parse import load_scene
from timing import interleaved, markdown

SKINS = (0.5, 0.75, 1.0, 1.5, 2.0)
"""Over the spacing."""
FRAMES = 24
SCENES = [Path(__file__).parents[1] / "scenes" / f"{name}.txt" for name in ("crowd", "float", "splash", "drop", "boat")]


def times(scene: Path) -> list:
    """A row: name, particles, ns per particle-step with the skin as it is, and for each skin the time over that."""
    plan, usual = prepare(load_scene(scene)).plan, commands.SKIN
    steps = plan.certificate.steps_per_frame
    instances = {}
    for skin in {usual, *SKINS}:
        commands.SKIN = skin
        instances[skin] = Instance(plan)
        instances[skin].setup()
    commands.SKIN = usual

    def frame(instance: Instance) -> float:
        begin = time.process_time()
        instance.run(steps)
        return time.process_time() - begin

    frames = min(FRAMES, plan.certificate.steps // steps)
    found = interleaved({skin: lambda instance=instance: frame(instance) for skin, instance in instances.items()}, frames)
    total = {skin: sum(sample.values) for skin, sample in found.items()}
    for instance in instances.values():
        instance.close()
    each = 1e9 * total[usual] / (frames * steps * plan.system.particles)
    return [scene.stem, plan.system.particles, each, *(total[skin] / total[usual] for skin in SKINS)]


def main() -> None:
    scenes = [Path(a) for a in sys.argv[1:]] or SCENES
    print(
        markdown(
            ["scene", "particles", f"ns per particle-step, skin {commands.SKIN}", *(f"time with {s}" for s in SKINS)],
            map(times, scenes),
        )
    )


if __name__ == "__main__":
    main()
