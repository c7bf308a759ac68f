# SPDX-License-Identifier: GPL-2.0-only
"""Run all scenes of a folder, and write a page with their movies: ``python docs/gallery.py DIR [-o gallery]``.

A run that is complete is kept unless --force is given, one that was stopped goes on, or begins again where it has left no
checkpoint. A scene that fails does not stop the others: its message is on the page. Ends as the program does, with 6
where a scene has failed.
"""

import argparse
import html
import sys
import urllib.parse
from pathlib import Path

from mdanim_lammps import Interrupted, MdanimError, OutputError, Run, Scene
from mdanim_lammps.cli.options import Reading
from mdanim_lammps.errors import ExitCode
from mdanim_lammps.report import count
from mdanim_lammps.results.files import disk_errors, write_whole
from mdanim_lammps.results.overwriting import MADE, check_overwriting
from mdanim_lammps.run.folder import movie_file, output_folder
from mdanim_lammps.scene.scene import Accuracy
from mdanim_lammps.terminal import documented_exit, open_streams, stop_on_sigterm

STYLE = (
    "body{font:16px sans-serif;margin:2em;background:#f8fafb}figure{margin:0}video{width:100%}code{color:#555}"
    "main{display:grid;grid-template-columns:repeat(auto-fill,minmax(22em,1fr));gap:1.5em}"
)


def make_gallery(folder: Path, out: Path, reading: Reading, *, size=None, force=False) -> tuple[int, int]:
    """Run every ``NAME.txt`` of a folder into ``out``/NAME, and write ``out``/index.html; returns how many, and how many failed.

    Raises Interrupted, UsageError for words of ``reading`` that cannot be read, and OutputError where there are no scenes, or no
    page can be written.
    """
    reading.overrides()
    scenes = sorted(folder.glob("*.txt"))
    if not scenes:
        raise OutputError(f"{folder} holds no scenes, files NAME.txt; name a folder that does")
    check_overwriting(out / "index.html", force=force, other="DIR")
    with disk_errors(out):
        out.mkdir(parents=True, exist_ok=True)
    cells, failed = [], 0
    for number, path in enumerate(scenes, 1):
        print(f"gallery  {number} of {len(scenes)}: {path}", file=sys.stderr, flush=True)
        title = path.stem
        try:
            record = reading.load(path)
            title = record.title or title
            movie = movie_of(Scene(record), output_folder(record, out / path.stem), size, force=force)
            shown = f'<video src="{urllib.parse.quote(movie.relative_to(out).as_posix())}" controls loop muted></video>'
        except Interrupted:
            raise
        except MdanimError as error:
            failed += 1
            print(error, file=sys.stderr)
            shown = f"<pre>{html.escape(str(error))}</pre>"
        words = f"{html.escape(title)} <code>{html.escape(path.name)}</code>"
        cells.append(f"<figure>{shown}<figcaption>{words}</figcaption></figure>")
    head = f'<meta charset="utf-8"><meta name="generator" content="{MADE}"><title>Gallery</title><style>{STYLE}</style>'
    write_whole(out / "index.html", f"<!doctype html>{head}<main>{''.join(cells)}</main>\n")
    return len(scenes), failed


def movie_of(scene: Scene, place: Path, size: tuple[int, int] | None, *, force: bool) -> Path:
    """The movie of a complete run of a scene in a folder. Raises what `Scene.run` and `Run.render` do."""
    run = Run(place) if (place / "manifest.json").exists() else None
    state = run.status.state if run else ""
    movie = movie_file(place, scene.record)
    if state == "done" and not force and movie.exists():
        return movie
    # Nothing is lost where a run begins again that has no checkpoint; a folder that `build` has made is left alone.
    anew = force or (state not in ("", "built", "done") and not (place / "checkpoint").exists())
    if anew or run is None:
        run = scene.run(place, force=anew)
    elif state != "done":
        run.resume(movie=False)
    return run.render(size=size, force=True)


def main(words: list[str] | None = None) -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="docs/gallery.py", description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path, help="with scenes, NAME.txt")
    parser.add_argument("-o", "--out", type=Path, default=Path("gallery"), help="folder of the page, with a folder for each run")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="override a let of all scenes")
    parser.add_argument("--accuracy", choices=[a.value for a in Accuracy])
    parser.add_argument("--size", type=int, nargs=2, metavar=("W", "H"), help="of the movies, in pixels")
    parser.add_argument("--force", action="store_true", help="run also what is complete")
    asked = parser.parse_args(words)
    open_streams()
    stop_on_sigterm()
    with documented_exit(debug=False):
        reading = Reading(set=tuple(asked.set), accuracy=asked.accuracy)
        made, failed = make_gallery(asked.folder, asked.out, reading, size=asked.size, force=asked.force)
        print(f"gallery  {asked.out / 'index.html'}   {count(made, 'scene')}" + f", {failed} of them failed" * (failed > 0))
        if failed:
            raise SystemExit(ExitCode.DIVERGED)


if __name__ == "__main__":
    main()
