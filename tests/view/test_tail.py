# SPDX-License-Identifier: GPL-2.0-only
"""The view follows the folder of a run, here without a page."""

import pytest
from mdanim_lammps import Scene
from mdanim_lammps.results.frame_reader import FrameReader
from mdanim_lammps.view.tail import Known, Tail
from scene_texts import FALL


@pytest.mark.parametrize("names", [("trajectory.h5.part", "trajectory.h5"), ("trajectory.h5", "trajectory.h5.part")])
def test_a_trajectory_gets_another_name_while_it_is_looked_for(tmp_path, monkeypatch, names):
    """A run that ends, or is resumed, between two looks of the view is still the same run: pages do not begin anew."""
    run = tmp_path / "fall.out"
    (tmp_path / "fall.txt").write_text(FALL)
    Scene.load(tmp_path / "fall.txt").run(run)
    before, after = (run / name for name in names)
    (run / "trajectory.h5").replace(before)
    tail = Tail(run)
    asked, looked = FrameReader.is_at, []

    def is_at(frames, path):
        if not looked:
            before.rename(after)
        looked.append(path)
        return asked(frames, path)

    tail.feed()
    monkeypatch.setattr(FrameReader, "is_at", is_at)
    tail._look()
    with tail:  # which closes its files
        assert after in looked and tail.news(Known())["file"] == 0
