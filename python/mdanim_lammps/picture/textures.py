# SPDX-License-Identifier: GPL-2.0-only
"""Patterns of objects and floors that need no files, as GLSL, and where they lie in the material."""

from __future__ import annotations

import numpy as np

from ..results.trajectory import Trajectory
from ..scene.scene import Solid
from ..scene.shown import TEXTURES

PARTS = {"wood": 9.0, "brick": 3.0, "stripes": 6.0, "checker": 4.0}
"""Parts of a pattern along an object, where no size is written: along the cube that is as large as the box around it."""
MATERIAL = "material"
"""Attribute of vertices: place in the material, over the size of a part, and 1 more than the number of the pattern in TEXTURES,
or 0 for none."""


def material_places(trajectory: Trajectory, start: np.ndarray, object_of: np.ndarray) -> np.ndarray | None:
    """Attribute MATERIAL of vertices, float32, shape (V, 4); None where no object has a texture.

    Args:
        trajectory: with the scene.
        start: where vertices are in the first frame [m], shape (V, 3): places in the material are along the axes of the object,
            from the middle of the box around it. The longest axis of wood stands first.
        object_of: their objects, shape (V,).
    """
    scene = trajectory.scene
    if scene is None or not any(solid.texture for solid in scene.solids):
        return None
    found = np.zeros((len(start), 4), np.float32)
    wholes: dict[str, list[int]] = {}
    for m, solid in enumerate(scene.solids):
        wholes.setdefault(_whole(solid).name, []).append(m)
    for numbers in wholes.values():
        solid = _whole(scene.solids[numbers[0]])
        own = np.flatnonzero(np.isin(object_of, numbers))
        if solid.texture is None or not len(own):
            continue
        place = start[own] @ np.array(solid.rotation)
        low, high = place.min(axis=0), place.max(axis=0)
        pattern = solid.texture.pattern
        edge = float(np.cbrt(np.prod(np.maximum(high - low, 0.05 * (high - low).max())))) / PARTS[pattern]
        place = (place - 0.5 * (low + high)) / (solid.texture.size or edge)
        if pattern == "wood":
            place = place[:, np.argsort(low - high, kind="stable")]
        found[own] = np.column_stack([place, np.full(len(own), 1.0 + list(TEXTURES).index(pattern))])
    return found


def _whole(solid: Solid) -> Solid:
    """Whole of a piece, whose pattern goes on over the cuts; any other object itself."""
    return getattr(solid.shape, "whole", solid)


VERTEX = {
    "//VTK::Normal::Dec": """//VTK::Normal::Dec
in vec4 material;
out vec4 materialThere;
""",
    "//VTK::Normal::Impl": """//VTK::Normal::Impl
materialThere = material;
""",
}

NOISE = """
float hashed(ivec3 at)
{
  uint h = uint(at.x) * 73856093u ^ uint(at.y) * 19349663u ^ uint(at.z) * 83492791u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return float((h ^ (h >> 16)) & 0xffffu) / 65535.0;
}

// From 0 to 1, smooth over a length of 1.
float cloudy(vec3 p)
{
  ivec3 at = ivec3(floor(p));
  vec3 t = smoothstep(0.0, 1.0, fract(p));
  const ivec3 E = ivec3(0, 0, 1);
  vec4 low = vec4(hashed(at), hashed(at + E.zxx), hashed(at + E.xzx), hashed(at + E.zzx));
  vec4 high = vec4(hashed(at + E), hashed(at + E.zxz), hashed(at + E.xzz), hashed(at + E.zzz));
  vec4 four = mix(low, high, t.z);
  return mix(mix(four.x, four.y, t.x), mix(four.z, four.w, t.x), t.y);
}

// 1 in every second part of a line, -1 in those between, from one to the next within a pixel.
float square(float x)
{
  return clamp((abs(fract(0.5 * x) - 0.5) * 2.0 - 0.5) / max(fwidth(x), 1e-4), -0.5, 0.5) * 2.0;
}

// Share of a pixel beyond a seam of this half width, 0 in the seam.
float apart(float x, float seam)
{
  float away = 0.5 - abs(fract(x) - 0.5), pixel = max(fwidth(x), 1e-4);
  return mix(clamp((away - seam) / pixel + 0.5, 0.0, 1.0), 1.0 - 2.0 * seam, smoothstep(0.3, 1.0, pixel));
}

// Grain of wood along x, from 0 to 1.
float grain(vec3 p)
{
  vec3 long_ = vec3(0.12 * p.x, p.yz);
  float ring = length(p.yz + vec2(1.3, 2.1) + 0.5 * (cloudy(0.6 * long_) - 0.5)) + 0.6 * cloudy(0.8 * long_);
  float saw = fract(ring), fibre = cloudy(vec3(0.5 * p.x, 9.0 * p.yz));
  float rings = mix(smoothstep(0.0, 0.8, saw) * (1.0 - smoothstep(0.88, 1.0, saw)), 0.45, smoothstep(0.3, 1.0, fwidth(ring)));
  return 0.75 * rings + 0.25 * fibre;
}
"""

OBJECTS = (
    """
in vec4 materialThere;
"""
    + NOISE
    + """
vec3 textured(vec3 color)
{
  int pattern = int(materialThere.w + 0.5);
  // Faces that lie where two parts meet show one of both.
  vec3 p = 0.999 * materialThere.xyz;
  float bright = dot(color, vec3(0.2126, 0.7152, 0.0722));
  vec3 other = bright > 0.72 ? 0.35 * color : mix(color, vec3(0.97), 0.86);
  float side = 0.0;
  vec3 found = color;
  if (pattern == 1) found = color * mix(vec3(1.06), vec3(0.62, 0.55, 0.48), grain(p));
  if (pattern == 2) {
    vec3 face = abs(cross(dFdx(p), dFdy(p)));
    // Along and up a face; tops have bricks too.
    vec2 on = face.z > max(face.x, face.y) ? p.xy : face.x > face.y ? p.yz : p.xz;
    on.y *= 3.2;
    float row = floor(on.y);
    on.x += 0.5 * mod(row, 2.0);
    float brick = apart(on.x, 0.02) * apart(on.y, 0.06), tone = hashed(ivec3(floor(on.x), row, 7));
    found = mix(vec3(0.78, 0.75, 0.70), color * (0.82 + 0.32 * tone + 0.12 * (cloudy(40.0 * p) - 0.5)), brick);
  }
  if (pattern == 3) side = square(p.x + 0.5);
  if (pattern == 4) side = square(p.x + 0.5) * square(p.y + 0.5) * square(p.z + 0.5);
  if (pattern >= 3) found = mix(color, other, 0.5 - 0.5 * side);
  return clamp(found, 0.0, 1.0);
}
"""
)
"""Functions of a shader of objects with textures."""

_PLANKS = """
  vec2 on = worldPosition.xy / (1.2 * gridSpacing);
  float plank = floor(on.y), along = on.x / 7.0 + 0.37 * plank + hashed(ivec3(plank, 3, 0));
  float tone = hashed(ivec3(plank, floor(along), 1)), seams = apart(on.y, 0.012) * apart(along, 0.0018);
  float fine = 1.0 - smoothstep(0.2, 1.0, fwidth(on.y));
  float lines = mix(0.5, grain(vec3(1.4 * on.x, 3.0 * (on.y - plank - 0.5), 11.0 * tone)), fine);
  vec3 board = mix(vec3(0.80, 0.64, 0.46), vec3(0.62, 0.45, 0.29), 0.55 * tone + 0.45 * lines);
  vec3 painted = mix(vec3(0.30, 0.21, 0.14), board, seams);
"""
_TILES = """
  vec2 on = worldPosition.xy / (2.0 * gridSpacing);
  float tone = hashed(ivec3(floor(on), 2)), seams = apart(on.x, 0.016) * apart(on.y, 0.016);
  float cloud = cloudy(vec3(3.0 * on, 20.0 * tone));
  vec3 painted = mix(vec3(0.58, 0.57, 0.55), vec3(0.86, 0.85, 0.82) + 0.05 * (tone - 0.5) + 0.05 * (cloud - 0.5), seams);
"""
_GRASS = """
  vec2 on = worldPosition.xy / gridSpacing;
  float pixel = max(fwidth(on.x), fwidth(on.y));
  float fine = mix(cloudy(vec3(14.0 * on, 1.0)), 0.5, smoothstep(0.02, 0.10, pixel));
  float middle = mix(cloudy(vec3(3.1 * on, 2.0)), 0.5, smoothstep(0.1, 0.5, pixel));
  float wide = cloudy(vec3(0.35 * on, 3.0));
  vec3 painted = mix(vec3(0.27, 0.44, 0.17), vec3(0.50, 0.66, 0.30), 0.40 * fine + 0.30 * middle + 0.30 * wide);
"""
_STUDIO = "  vec3 painted = floorColor;\n"
FLOORS = {"wood": _PLANKS, "tiles": _TILES, "grass": _GRASS, "studio": _STUDIO}
"""Shaders of floors, which give the colour that is painted on them."""
