# SPDX-License-Identifier: GPL-2.0-only
"""Make the movies of the gallery: ``python docs/images/movies.py [SCENE ...]`` (runs the scenes; default all of them). They are
small, as they are stored: the site shows docs/movies/NAME.mp4 in place of a picture images/NAME.png."""

import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import imageio_ffmpeg
from mdanim_lammps import Scene
from mdanim_lammps.picture.movie import render_movie

DOCS = Path(__file__).resolve().parents[1]
SCENES = ("cradle", "dominoes", "drop", "plates", "race", "stairs", "tower")
SIZE = (384, 216)
LOSS = "33"
"""H.264's rate factor: 18 shows no loss, 33 is enough for a movie as large as a thumb; none is larger than 200 kB."""


def main(names: list[str]) -> None:
    """Write one movie per scene."""
    for name in names or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            scene, large, small = (
                Scene.load(DOCS.parent / "scenes" / f"{name}.txt"),
                Path(folder) / "a.mp4",
                DOCS / "movies" / f"{name}.mp4",
            )
            scene.run(Path(folder) / "out")
            render_movie(Path(folder) / "out", replace(scene.record.render, size=SIZE), large, processes=1)
            options = ["-c:v", "libx264", "-crf", LOSS, "-preset", "veryslow", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
            ffmpeg = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-y", "-i", large, *options, small]
            subprocess.run(ffmpeg, check=True)
        print(f"{small}  {small.stat().st_size / 1000:.0f} kB", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
