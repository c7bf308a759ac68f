# SPDX-License-Identifier: GPL-2.0-only
"""Parts of a mesh file: those that it names, or else the pieces of its surface that hang together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..scene.keywords import did_you_mean
from .mesh_formats import Polygons
from .orientation import MeshError

MOST_TOLD = 12
"""Names of parts in a message."""


def told(names: tuple[str, ...]) -> str:
    """Names of parts in a message, as a scene has them."""
    more = f" and {len(names) - MOST_TOLD} more" if len(names) > MOST_TOLD else ""
    return ", ".join(f'"{name}"' if name else f"part {k}" for k, name in enumerate(names[:MOST_TOLD], 1)) + more


def named_part(found: Polygons, part: str | int, file: str) -> Polygons:
    """The polygons of one of the parts that a file names, by its name, or by its number from 1 on. Raises MeshError."""
    names = found.names
    if part in names:
        number = names.index(part)
    elif isinstance(part, int) and part <= len(names):
        number = part - 1
    else:
        near = did_you_mean(part, names) if isinstance(part, str) else ""
        hint = f"{near if near.startswith('did') else ''} its parts are {told(names)}".strip()
        raise MeshError(f"mesh {file}: has no part {_shown(part)}", hint)
    kept = found.part == number
    return replace(found, count=found.count[kept], index=found.index[np.repeat(kept, found.count)])


def piece(points: np.ndarray, triangles: np.ndarray, part: str | int, file: str) -> np.ndarray:
    """The triangles, of shape (T, 3), of one of the pieces of a surface that hang together by points, by its number from 1 on, in
    the order in which the file begins them. Raises MeshError."""
    of = pieces(points, triangles)
    many = int(of.max()) + 1
    if isinstance(part, int) and part <= many:
        return triangles[of == part - 1]
    has = f"its surface has {many} pieces that do not hang together, part 1 to part {many}" if many > 1 else "it is one piece"
    raise MeshError(f"mesh {file}: has no part {_shown(part)}", f"the file names no parts; {has}")


def pieces(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The piece of each triangle, int, shape (T,): triangles hang together by points. First triangles are in the order of the
    numbers."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = triangles[:, [0, 1, 1, 2]].reshape(-1, 2).T
    joined = coo_array((np.ones(ends.shape[1], bool), ends), shape=(len(points),) * 2)
    of = connected_components(joined, directed=False)[1][triangles[:, 0]]
    _, first, number = np.unique(of, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[number.reshape(-1)]


def _shown(part: str | int) -> str:
    return f'"{part}"' if isinstance(part, str) else str(part)
