# SPDX-License-Identifier: GPL-2.0-only
"""Messages to a page hold what the trajectory holds."""

import json
import struct
from dataclasses import replace

import numpy as np
import pytest
from mdanim_lammps import Trajectory
from mdanim_lammps.errors import OutputError
from mdanim_lammps.picture.camera import action_of, automatic_view
from mdanim_lammps.picture.foam import Foam
from mdanim_lammps.picture.surfaces import shaded_mesh
from mdanim_lammps.results.trajectory_writer import TrajectoryWriter
from mdanim_lammps.scene.render import Camera, Floor, Render
from mdanim_lammps.view.feed import ASPECT, DRY, HIDDEN, MOST_FOAM, MOST_STRAIN, OPEN, PARTICLES, STRAIN, Feed, first_action
from picture_samples import column_centres, falling, flat, pool_scene, raw_of, slab_scene, wet_frames, with_drops, write

HEAD = 36


def unpacked(message: bytes) -> tuple[dict, dict[str, np.ndarray]]:
    """Header and arrays of a scene."""
    assert message[:4] == b"MDS1"
    size = struct.unpack_from("<I", message, 4)[0]
    head = json.loads(message[8 : 8 + size])
    arrays = {
        name: np.frombuffer(message, "<" + kind, count, 8 + size + at) for name, (kind, at, count) in head["buffers"].items()
    }
    return head, arrays


def parts(message: bytes) -> tuple:
    """Numbers of the header of a frame, and the rest as bytes."""
    assert message[:4] == b"MDF1" and len(message) % 4 == 0
    return struct.unpack_from("<IdIIIII", message, 4), message[HEAD:]


@pytest.fixture(scope="module")
def slab(tmp_path_factory):
    """A folder with a held slab, a cube and a ball in six frames, and a feed of it."""
    folder = tmp_path_factory.mktemp("slab")
    scene, models = slab_scene()
    write(folder / "trajectory.h5", scene, models, falling(models, 6))
    feed = Feed(folder, "slab", finished=True)
    yield folder, feed
    feed.close()


def test_vertices_are_where_the_surfaces_are(slab):
    """Within half a step of 65 535 of each object's box in every frame, with centres and velocities."""
    folder, feed = slab
    _, arrays = unpacked(feed.scene())
    of = arrays["object"]
    with Trajectory(folder) as t:
        mesh = shaded_mesh(t.metadata, t.position(0))
        for n in range(len(t)):
            (frame, time, layers, V, count, C, D), data = parts(feed.frame(n))
            assert (frame, time, layers, V, count, C, D) == (n, t.times[n], 0, len(of), 3, 0, 0)
            objects = np.frombuffer(data, "<f4", 12 * count).reshape(count, 12)
            within = np.frombuffer(data, "<u2", 3 * V, 48 * count).reshape(V, 3)
            at = objects[of, :3] + within * (objects[of, 3:6] / 65535.0)
            wanted = mesh.vertices(t.position(n))
            order = np.argsort(mesh.object_of_vertex, kind="stable")
            assert (np.abs(at - wanted[order]) <= 0.51 * objects[of, 3:6] / 65535.0 + 1e-6).all()
            np.testing.assert_allclose(objects[:, 6:9], t.centers[n], rtol=1e-6, atol=1e-7)
            np.testing.assert_allclose(objects[:, 9:], t.center_velocities[n], rtol=1e-6, atol=1e-7)


def test_every_object_has_its_own_vertices(slab):
    """Side by side, and triangles use those of one object."""
    head, arrays = unpacked(slab[1].scene())
    triangle = arrays["triangle"].reshape(-1, 3)
    assert (np.diff(arrays["object"].astype(int)) >= 0).all()
    for k, found in enumerate(head["objects"]):
        assert (arrays["object"][found["first"] : found["first"] + found["count"]] == k).all()
    of = arrays["object"][triangle]
    assert (of == of[:, :1]).all()


def test_the_scene_tells_what_is_there(slab):
    """Names, masses, what is held, the floor, and the camera of the movie."""
    folder, feed = slab
    head = unpacked(feed.scene())[0]
    with Trajectory(folder) as t:
        assert [o["name"] for o in head["objects"]] == list(t.names)
        assert [o["mass"] for o in head["objects"]] == t.metadata.object_mass.tolist()
        view = automatic_view(action_of(t), ASPECT)
    assert [o["still"] for o in head["objects"]] == [True, False, False]
    assert head["floor"] == 0.0 and head["frames"] == 6 and head["frameTime"] == pytest.approx(0.1)
    np.testing.assert_allclose(head["view"]["eye"], view.eye)
    np.testing.assert_allclose(head["view"]["look"], view.look)


def test_colours_of_a_mesh_file_go_with_its_vertices(tmp_path):
    """Beside objects that have one colour, in the order of the vertices; without such a file there are none."""
    scene, models = slab_scene()
    ball = models[2]
    assert ball.name == "ball"
    up = ball.surface.vertices(ball.position)[:, 2] > 1.0
    color = np.where(up[:, None], np.uint8(200), np.uint8([1, 2, 3]))
    models[2] = replace(ball, surface=replace(ball.surface, color=color))
    write(tmp_path / "trajectory.h5", scene, models, falling(models, 1))
    feed = Feed(tmp_path)
    head, arrays = unpacked(feed.scene())
    tint, of = arrays["tint"].reshape(-1, 3), arrays["object"]
    assert [tint[of == k][0].tolist() for k in (0, 1)] == [o["color"] for o in head["objects"][:2]]
    assert {tuple(c) for c in tint[of == 2].tolist()} == {(200, 200, 200), (1, 2, 3)}
    vertices = feed.vertices(models_at(models))[of == 2]
    np.testing.assert_array_equal(tint[of == 2][:, 0] == 200, vertices[:, 2] > 1.0)
    feed.close()


def models_at(models):
    """Particles of all models [m]."""
    return np.concatenate([m.position for m in models])


def test_the_way_of_an_object(slab, monkeypatch):
    """Places and velocities of all frames, or of fewer of them from the first to the last."""
    folder, feed = slab
    read = lambda k, count: unpacked(feed.track(k, count))[1]
    with Trajectory(folder) as t:
        found = read(2, len(t))
        np.testing.assert_array_equal(found["time"], t.times.astype("f4"))
        np.testing.assert_array_equal(found["centre"].reshape(-1, 3), t.centers[:, 2].astype("f4"))
        np.testing.assert_array_equal(found["velocity"].reshape(-1, 3), t.center_velocities[:, 2].astype("f4"))
        np.testing.assert_array_equal(read(2, 2)["time"], t.times[:2].astype("f4"))
        monkeypatch.setattr("mdanim_lammps.view.feed.MOST_POINTS", 3)
        np.testing.assert_array_equal(read(2, len(t))["time"], t.times[[0, 2, 5]].astype("f4"))


def test_light_and_floor_are_those_of_the_scene(slab):
    """The page follows the words of the render block that it can follow."""
    render = Render(light=(0.0, -3.0, 4.0), shadows=0.25, floor=Floor.CHECKER)
    for block, floor in ((render, 0.0), (replace(render, floor=Floor.NONE), None)):
        feed = Feed(slab[0], "", block, finished=True)
        head = feed.head()
        assert (head["floor"], head["shadows"]) == (floor, 0.25) and (floor is None or head["pattern"] == "checker")
        np.testing.assert_allclose(head["lamp"], [0.0, -0.6, 0.8])
        feed.close()


def test_the_camera_of_the_scene_comes_first(slab):
    """A finished run is seen from where its scene says."""
    camera = Camera(eye=(1.0, -3.0, 2.0), look="ball", time=0.0)
    feed = Feed(slab[0], "", Render(camera=(camera,)), finished=True)
    assert feed.head()["view"]["eye"] == [1.0, -3.0, 2.0]
    path = feed.buffers()["path"].reshape(-1, 3, 3)  # it looks at what moves, as the movie does
    with Trajectory(slab[0]) as t:
        np.testing.assert_allclose(path[:, 1], t.objects["ball"].center_of_mass, atol=1e-6)
    np.testing.assert_array_equal(path[:, 0], np.tile([1.0, -3.0, 2.0], (len(path), 1)).astype("f4"))
    feed.close()


def test_a_run_that_has_begun_has_room_below(slab):
    """The picture of a run that goes on holds its first frame and the ground."""
    folder, _ = slab
    feed = Feed(folder)
    low, high = np.array(feed.head()["bounds"])
    vertices = feed.vertices(feed.frames.value("position", 0))
    assert low[2] == 0.0 and (low <= vertices.min(axis=0)).all() and (high >= vertices.max(axis=0)).all()
    assert not first_action(feed.metadata, *feed._boxes(vertices)).escaped
    feed.close()


def test_a_run_ends_while_it_is_fed(slab, tmp_path):
    """A page that comes after the end, when the trajectory has got its last name, sees the scene of a finished run."""
    folder, finished = slab
    (tmp_path / "trajectory.h5.part").write_bytes((folder / "trajectory.h5").read_bytes())
    feed = Feed(tmp_path, "slab")
    assert feed.head()["bounds"] != finished.head()["bounds"]
    (tmp_path / "trajectory.h5.part").rename(tmp_path / "trajectory.h5")
    feed.finished = True
    del feed.action, feed._path
    assert feed.scene() == finished.scene()
    feed.close()


def test_strain_is_that_of_the_springs(slab):
    """None in frame 0; later the mean of |strain| of a particle's springs, as a twin in a plain loop finds it."""
    folder, feed = slab
    _, arrays = unpacked(feed.springs())
    bond = arrays["bond"].reshape(-1, 2)
    with Trajectory(folder) as t:
        np.testing.assert_array_equal(t.metadata.id[bond], t.metadata.bond)
        x0, x = t.position(0), t.position(3)
        mesh = shaded_mesh(t.metadata, x0)
    strain = [[] for _ in x]
    for a, b in bond:
        found = abs(np.linalg.norm(x[a] - x[b]) / np.linalg.norm(x0[a] - x0[b]) - 1.0)
        strain[a].append(found)
        strain[b].append(found)
    order = np.argsort(mesh.object_of_vertex, kind="stable")
    wanted = np.clip((mesh.carry @ np.array([np.mean(s) if s else 0.0 for s in strain]))[order] * 255 / MOST_STRAIN, 0, 255)
    V = len(wanted)
    for n, expected in ((0, np.zeros(V)), (3, wanted)):
        (*_, layers, _, count, _, _), data = parts(feed.frame(n, STRAIN))
        found = np.frombuffer(data, "u1", V, 48 * count + (6 * V + 3) // 4 * 4)
        assert layers == STRAIN and np.abs(found - expected).max() <= 0.51
    assert wanted.max() > 20


def test_particles_are_sent_when_asked_for(slab):
    """All stored ones, in single precision, at the end of the frame."""
    folder, feed = slab
    plain, message = feed.frame(2), feed.frame(2, PARTICLES)
    with Trajectory(folder) as t:
        x = t.position(2).astype("<f4")
    assert len(message) == len(plain) + x.nbytes and message.endswith(x.tobytes())


def test_liquid(tmp_path):
    """Heights within half a step of the basin's height; where a body hides the liquid where a hull keeps it dry; and drops."""
    scene, models, grid = pool_scene()
    smooth = flat(grid, 0.45)
    raw = raw_of(grid, smooth, models[:1])
    raw[1:9, 28:36] = -np.inf
    scene = replace(scene, liquid=replace(scene.liquid, drops=1.0))
    drops = [np.full((n, 4), 0.25 * n) for n in (1, 3)]
    frames = map(with_drops, wet_frames(models, (smooth, raw), (smooth, raw)), drops)
    write(tmp_path / "trajectory.h5", scene, models, frames, grid)
    feed = Feed(tmp_path)
    head, arrays = unpacked(feed.scene())
    (_, _, _, V, count, C, D), data = parts(feed.frame(1))
    at = 48 * count + (6 * V + 3) // 4 * 4
    height = np.frombuffer(data, "<u2", C, at) / 65535.0
    state = np.frombuffer(data, "u1", C, at + (2 * C + 3) // 4 * 4).reshape(raw.shape)
    assert grid.shape[0] * grid.shape[1] == C and np.abs(height - 0.45).max() <= 0.51 / 65535
    # Two columns around are the shore of the liquid beside.
    assert (state[3:7, 30:34] == DRY).all() and (state[np.isnan(raw)] == HIDDEN).all() and state[0, 0] == OPEN
    assert D == 3 and (np.frombuffer(data, "<f4", 12, len(data) - 48) == 0.75).all()
    assert head["liquid"]["shape"] == list(grid.shape) and arrays["sheet"].max() < len(head["buffers"]) + 10 * C
    feed.close()


def test_foam_is_that_of_the_movie(tmp_path):
    """Within half a step of 63, in the upper six bits of a column's byte; none in the first frame."""
    scene, models, grid = pool_scene()
    x, _ = column_centres(grid)
    fronts = [0.6 - 0.3 * np.clip((x + 0.5 - 0.05 * n) / 0.2 + 0.5, 0.0, 1.0) for n in range(4)]
    frames = list(wet_frames(models, *[(front, raw_of(grid, front, models)) for front in fronts]))
    write(tmp_path / "trajectory.h5", scene, models, frames, grid)
    feed = Feed(tmp_path)
    with Trajectory(tmp_path) as t:
        foam, read = Foam(grid, 0.1), lambda n: (t.liquid_height(n), t.liquid_raw(n), t.liquid_drops(n))
        for n in (3, 0, 2):
            _, column = feed.liquid(n)
            assert np.abs(column // 4 / MOST_FOAM - foam.at(n, read).ravel()).max() <= 0.51 / MOST_FOAM
            assert set(np.unique(column % 4)) == {OPEN, HIDDEN} and (column // 4).any() == (n > 0)
    feed.close()


def test_frames_that_are_not_there(tmp_path):
    """Neither one that is not written, nor one beyond the end."""
    scene, models = slab_scene()
    with TrajectoryWriter(tmp_path / "trajectory.h5", scene, models, frames=2, dt=0.01, steps_per_frame=10) as out:
        frames = list(falling(models, 2))
        out.write(*frames[0])
        feed = Feed(tmp_path)
        with pytest.raises(OutputError, match="not there"):
            feed.frame(1)
        with pytest.raises(IndexError):
            feed.frame(2)
        out.write(*frames[1])
        feed.frame(1)
        feed.close()
