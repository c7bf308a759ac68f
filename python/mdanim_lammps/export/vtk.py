# SPDX-License-Identifier: GPL-2.0-only
"""A PVD series: surfaces, particles and liquid of each frame as files of their own, and the list of them with times."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from ..picture.pieces import cells
from ..picture.window import silent
from .cut import Cut


def write(cut: Cut, folder: Path, stem: str, on_frame: Callable[[int], None]) -> list[str]:
    pieces = folder / f"{stem}.vtk"
    pieces.mkdir()
    solids = [body for body in cut.bodies if not body.clear]
    sizes = [len(vertices) for vertices, _ in cut.surfaces(cut.frames[0])][: len(solids)]
    of = [*cut.objects, *[-1] * (len(solids) - len(cut.objects))]
    owner, first = np.repeat(of, sizes).astype(np.int32), np.cumsum([0, *sizes])
    triangles = [body.triangle + np.int32(start) for body, start in zip(solids, first)]
    triangle = np.concatenate([np.zeros((0, 3), np.int32), *triangles])
    m, lines = cut.metadata, []
    for done, (frame, time) in enumerate(zip(cut.frames, cut.times), 1):
        surfaces = cut.surfaces(frame)
        vertices, normals = (np.concatenate([np.zeros((0, 3)), *(s[k] for s in surfaces[: len(solids)])]) for k in (0, 1))
        x = cut.position(frame)
        parts = {
            "surfaces": _mesh(vertices, _drawn(vertices, triangle), {"object": owner, "Normals": normals}),
            "particles": _mesh(
                x,
                None,
                {
                    "object": cut.objects[m.object_of].astype(np.int32),
                    "id": m.id,
                    "mass": m.mass,
                    "layer": m.layer,
                    "velocity": cut.velocity(frame),
                    "strain": cut.strain(x, frame),
                    **cut.of_particles(frame),
                },
            ),
        }
        if cut.liquid:
            parts["liquid"] = _mesh(surfaces[-1][0], cut.bodies[-1].triangle, {"Normals": surfaces[-1][1]})
        if cut.sheds_drops:
            drops = cut.drops(frame)
            parts["drops"] = _mesh(drops[:, :3], None, {"radius": drops[:, 3]})
        for part, (name, data) in enumerate(parts.items()):
            file = f"{name}-{frame:06d}.vtp"
            _save(data, pieces / file)
            lines.append(
                f'<DataSet timestep="{float(time)!r}" part="{part}" name="{name}" file={quoteattr(f"{stem}.vtk/{file}")}/>'
            )
        on_frame(done)
    text = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
    (folder / f"{stem}.pvd").write_text(text + "\n".join(lines) + "\n</Collection>\n</VTKFile>\n", encoding="utf-8")
    named = ", ".join(f"{n} {name}" for n, name in zip(cut.objects[:8], m.names))
    return [
        f"'object' counts {named}{', ...' if len(m.names) > 8 else ''}",
        "strain is the largest |r/r0 - 1| of a particle's springs",
    ]


def _drawn(points: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Triangles with three corners in different places, shape (K, 3): those of what is torn and of what is drawn once it is torn
    are in one place while they are not drawn."""
    corner = points[triangle]
    return triangle[(corner != np.roll(corner, 1, axis=1)).any(axis=2).all(axis=1)]


def _mesh(points: np.ndarray, triangle: np.ndarray | None, arrays: dict[str, np.ndarray]):
    """A mesh of triangles, or of one vertex cell for each point, with data of points."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    data, places = vtkPolyData(), vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points, float), deep=1))
    data.SetPoints(places)
    if triangle is None:
        data.SetVerts(cells(np.arange(len(points), dtype=np.int32)[:, None]))
    else:
        data.SetPolys(cells(triangle))
    for name, array in arrays.items():
        column = numpy_to_vtk(np.ascontiguousarray(array), deep=1)
        column.SetName(name)
        data.GetPointData().AddArray(column)
    if "Normals" in arrays:
        data.GetPointData().SetActiveNormals("Normals")
    return data


def _save(data, path: Path) -> None:
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()
    with silent():
        whole = writer.Write()
    if not whole:
        raise OSError(f"VTK could not write {path.name}")
