# SPDX-License-Identifier: GPL-2.0-only
"""The skin of the liquid: its shaders, and which of them its triangles need.

Software OpenGL computes all that a shader may need for every pixel. So there is a shader with foam and one without, one with
shadows and one without, one for steep faces and for a sheet with holes and one without these, and each triangle is drawn by the
one that does for it.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from .behind import Behind
from .light import Light
from .pieces import Lookup, MovingMesh, cells, lit_actor

REFRACTIVE_INDEX = 1.33
"""Refractive index of the liquid, over that of air."""
NORMAL_SHARE = ((REFRACTIVE_INDEX - 1.0) / (REFRACTIVE_INDEX + 1.0)) ** 2
"""Share of light that the surface throws back, seen straight on."""

LEVEL = 0.51
"""Upward part of normals from which on a face looks up: a little more than the 0.5 of shaders."""

# Foam lies in specks, which are the fewer the less of it there is: where it fades, holes grow in it. The liquid is seen
# between them also where there is most of it. On a steep face they are drawn out downward, as on a fall.
FOAM = """
float chance(ivec2 at)
{
  uint h = uint(at.x) * 73856093u ^ uint(at.y) * 19349663u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return float((h ^ (h >> 16)) & 0xffffu) / 65535.0;
}

float uneven(vec2 p)
{
  ivec2 at = ivec2(floor(p));
  vec2 t = smoothstep(0.0, 1.0, fract(p));
  return mix(mix(chance(at), chance(at + ivec2(1, 0)), t.x), mix(chance(at + ivec2(0, 1)), chance(at + ivec2(1, 1)), t.x), t.y);
}

float specks(vec2 p)
{
  return 0.55 * uneven(p) + 0.3 * uneven(2.3 * p + 17.0) + 0.15 * uneven(5.1 * p + 5.0);
}

// How much of the skin is white, and how bright the white is, 0 to 1. Seen through a wall it reaches a cell below the surface.
float foam(vec3 where, float top, vec3 normal, out float bright)
{
  bright = 1.0;
  float there = texture(liquidFoam, (where.xy - basinLow.xy) / (basinHigh.xy - basinLow.xy)).r;
  bool wall = abs(normal.z) < 1e-3;
  if (wall) there *= 1.0 - smoothstep(0.0, 1.5 * cell.z, top - where.z);
  float white = 0.0;
  // A loop, as a branch would be computed where there is no foam too.
  for (int once = there > 0.0 ? 1 : 0; once > 0; once--) {
    vec2 upright = vec2(dot(where.xy, vec2(1.0, 1.0)), wall ? where.z : 0.25 * where.z) / (0.7 * cell.z);
    float some = specks(upright);
    if (!wall) some = mix(some, specks(where.xy / (0.7 * cell.xy)), smoothstep(0.35, 0.75, normal.z));
    bright = smoothstep(0.2, 0.7, some);
    white = smoothstep(0.85, 1.22, some + 0.8 * there) * smoothstep(0.0, 0.15, there);
  }
  return white;
}
"""

NOT_BENT = """
bool bentAside(vec3 where, vec3 normal, vec3 toEye, out vec3 found) { return false; }
bool mirrors(vec3 where, vec3 way, out vec3 found) { return false; }
"""

# Things behind the surface are seen aside where the surface slopes: a ray is bent by as much as a level surface does not bend it,
# so that through a level surface all is seen where it is drawn. The bent ray is followed, piece by piece, to where it meets a
# thing that was drawn before the surface. An object that only hides it from the eye does not end it: outlines are never drawn
# out.
BENT = """
vec3 drawnAt(vec2 pixel)
{
  vec4 p = pictureInverse * vec4(2.0 * vec3(pixel / pictureSize, numberAt(behindDepth, ivec2(pixel))) - 1.0, 1.0);
  return p.xyz / p.w;
}

// Pixel where a place of the picture lies, and how far it is behind what is drawn there.
vec3 against(vec4 p)
{
  vec3 at = 0.5 + 0.5 * p.xyz / p.w;
  vec2 pixel = clamp(at.xy * pictureSize, vec2(0.5), pictureSize - 0.5);
  return vec3(pixel, at.z - numberAt(behindDepth, ivec2(pixel)));
}

bool bentAside(vec3 where, vec3 normal, vec3 toEye, out vec3 found)
{
  if (abs(normal.z) < 1e-3) return false;
  vec3 bent = refract(-toEye, normal, 1.0 / REFRACTIVE_INDEX);
  vec3 level = refract(-toEye, vec3(0.0, 0.0, 1.0), 1.0 / REFRACTIVE_INDEX);
  vec3 way = vec3(bent.xy / max(-bent.z, 0.3) - level.xy / max(-level.z, 0.3) - toEye.xy / max(toEye.z, 0.05), -1.0);
  // To where it leaves the basin: the glass moves nothing.
  vec3 out_ = (mix(basinLow, basinHigh, step(0.0, way)) - where) / (way + vec3(1e-9));
  way *= max(0.0, min(out_.x, min(out_.y, out_.z)));
  vec4 first = pictureMatrix * vec4(where, 1.0), last = pictureMatrix * vec4(where + way, 1.0);
  float aside = distance(against(last).xy, gl_FragCoord.xy);
  if (aside < 0.25) return false;
  int pieces = int(clamp(aside, 6.0, 48.0));
  float before = 0.0;
  bool ahead = true, met = false;
  vec2 pixel = gl_FragCoord.xy;
  for (int k = 1; k <= pieces && !met; k++) {
    float part = float(k) / float(pieces);
    vec3 at = against(mix(first, last, part));
    if (at.z > 0.0 && ahead) {
      float low = before, high = part;
      vec2 hit = at.xy;
      for (int n = 0; n < 6; n++) {
        float middle = 0.5 * (low + high);
        vec3 there = against(mix(first, last, middle));
        if (there.z > 0.0) {
          high = middle;
          hit = there.xy;
        } else {
          low = middle;
          pixel = there.xy;
        }
      }
      met = distance(drawnAt(hit), where + high * way) < 0.2 * cell.z;
      if (met) pixel = hit;
    }
    ahead = at.z <= 0.0;
    if (ahead) pixel = at.xy;
    before = part;
  }
  // The ray may end beside the outline of what is nearer, which has a share in the colours of the pixels around it.
  vec2 back = gl_FragCoord.xy - pixel;
  back *= min(1.0, 3.0 / max(length(back), 1e-3));
  if (distance(drawnAt(pixel), eye) - distance(drawnAt(pixel - back), eye) > cell.z) pixel += back;
  found = texture(behindColor, pixel / pictureSize).rgb;
  return true;
}

// The colour that a ray meets which the surface throws back, among what the picture shows, up to half a basin above the basin.
bool mirrors(vec3 where, vec3 way, out vec3 found)
{
  if (way.z < 0.02) return false;
  vec3 whole = min(length(basinHigh - basinLow), (1.5 * basinHigh.z - 0.5 * basinLow.z - where.z) / way.z) * way;
  vec4 first = pictureMatrix * vec4(where, 1.0), last = pictureMatrix * vec4(where + whole, 1.0);
  float before = 0.0;
  for (int k = 1; k <= 24; k++) {
    float part = float(k) / 24.0;
    vec4 p = mix(first, last, part);
    if (p.w <= 0.0 || any(greaterThan(abs(p.xy), vec2(p.w)))) return false;
    if (against(p).z > 0.0) {
      float low = before, high = part;
      for (int n = 0; n < 6; n++) {
        float middle = 0.5 * (low + high);
        if (against(mix(first, last, middle)).z > 0.0) high = middle; else low = middle;
      }
      vec2 hit = against(mix(first, last, high)).xy;
      vec3 thing = drawnAt(hit);
      if (thing.z > where.z && distance(thing, where + high * whole) < 0.3 * cell.z) {
        found = texture(behindColor, hit / pictureSize).rgb;
        return true;
      }
    }
    before = part;
  }
  return false;
}
"""


def bent() -> str:
    """The function above with its number."""
    return BENT.replace("REFRACTIVE_INDEX", str(REFRACTIVE_INDEX))


# The skin of the liquid, laid over what `seen` has coloured already: what it mirrors, and the lamp's glint.
# Where it is thinner than half a cell it fades out, so that a dry floor is bare.
FRAGMENT_SKIN = """//VTK::Light::Impl
{
  vec3 n = normalize(worldNormal);
  vec3 toEye = normalize(eye - worldPosition);
  vec3 toLamp = normalize(lamp);
  // Beside a wall the depth is that of the column behind it.
  float inside = STEEP ? liquidHeight(worldPosition.xy - 0.25 * cell.xy * n.xy).r : worldPosition.z;
  float top = n.z > 0.5 ? worldPosition.z : abs(n.z) > 1e-3 ? max(worldPosition.z, inside) : inside;
  // The sheet runs on through a hull that is dry inside; at the glass the liquid below the hull is seen.
  vec2 place = (worldPosition.xy - basinLow.xy) / (basinHigh.xy - basinLow.xy);
  float dry = STEEP ? texture(liquidDry, place).r : 0.0;
  if (dry > 0.5 && (abs(n.z) > 1e-3 || worldPosition.z > inside + 0.5 * cell.z)) discard;
  float film = smoothstep(0.1, 0.5, (top - basinLow.z) / cell.z);
  if (film <= 0.0) discard;
  if (INNER) n = -n;
  float lit = INNER ? 0.0 : SHADED ? shadow(worldPosition, n, 0.0) : 1.0;
  float graze = pow(1.0 - max(dot(n, toEye), 0.0), 3.0);
  vec3 mirrored = reflect(-toEye, n);
  // Bright towards the horizon, blue above: what a slope mirrors tells how it leans.
  float low = n.z > 0.3 && !INNER ? 1.0 - smoothstep(0.0, 0.75, mirrored.z) : 0.15;
  vec3 color = liquidColor * (0.62 + 0.40 * max(dot(n, toLamp), 0.0) * (0.45 + 0.55 * lit));
  color = mix(color, vec3(0.96, 0.99, 1.0), min(1.0, 0.75 * low + 0.4 * graze));
  float glint = lit * pow(max(dot(normalize(toLamp + toEye), n), 0.0), 120.0);
  float cover = mix(skinCover, 0.80, max(graze, 0.6 * low));
  float bright = 1.0;
  float white = WHITE;
  vec3 flake = mix(vec3(0.80, 0.84, 0.87), vec3(0.90, 0.92, 0.93), bright);
  color = mix(color, flake + vec3(0.12, 0.10, 0.08) * max(dot(n, toLamp), 0.0) * lit, white);
  cover = mix(cover, 0.95, white);
  glint *= 1.0 - white;
  if (INNER) {
    // Behind the inner faces is floor, which `seen` has coloured, or sky, which is still to be coloured.
    vec3 past = worldPosition - toEye * (worldPosition.z - floorHeight) / toEye.z;
    bool sky = toEye.z <= 0.0 || any(greaterThan(abs(past.xy - floorCentre.xy), vec2(floorCentre.z)));
    cover = 0.10;
    if (SKY && sky) {
      cover = 1.0 - exp(-0.8 * liquidPath(worldPosition) / liquidClear);
      color = liquidColor;
    }
  }
  color = min(color + 0.8 * glint, vec3(1.0));
  cover = min(1.0, cover + 0.8 * glint);
  vec3 aside;
  if (!INNER && bentAside(worldPosition, n, toEye, aside)) {
    color = mix(aside, color, cover);
    cover = 1.0;
  }
  vec3 image;
  if (!INNER && n.z > 0.3 && mirrors(worldPosition, mirrored, image)) {
    // Schlick's share of light that a surface of this index throws back.
    float thrown = (1.0 - white) * mix(NORMAL_SHARE, 1.0, pow(1.0 - max(dot(n, toEye), 0.0), 5.0));
    float both = 1.0 - (1.0 - thrown) * (1.0 - cover);
    color = ((1.0 - thrown) * cover * color + thrown * image) / both;
    cover = both;
  }
  fragOutput0 = vec4(color, film * cover);
}
"""


def _fragment(inner: bool, steep: bool = True, foamy: bool = False, shaded: bool = False, sky: bool = False) -> str:
    """The shader of faces seen from inside or from outside; ``steep``: of any, not only of those that look up and have no holes,
    ``foamy``: with foam, ``shaded``: with shadows, ``sky``: behind which sky may be."""
    words = {"INNER": inner, "STEEP": steep, "SHADED": shaded, "SKY": sky}
    named = "".join(f"const bool {name} = {str(value).lower()};\n" for name, value in words.items())
    white = "foam(worldPosition, inside, n, bright)" if foamy else "0.0"
    return FRAGMENT_SKIN.replace("{\n", "{\n" + named, 1).replace("WHITE", white).replace("NORMAL_SHARE", repr(NORMAL_SHARE))


class LiquidSkin:
    """Actors of the faces of a sheet.

    Args:
        mesh: the sheet; its triangles are drawn by the actors here.
        foam: how white each column is.
        cut: where the sheet is not drawn.
        cell: of the grid [m].
        cover: how much it covers, seen straight on.
        behind: what is drawn before it, which it shifts where it slopes; None without.
    """

    def __init__(self, mesh: MovingMesh, foam: Lookup, cut: Lookup, cell: np.ndarray, cover: float, behind: Behind | None):
        self._mesh, self._triangle, self._foamy, self._whole = mesh, np.zeros((0, 3), np.int32), np.zeros(0, bool), True
        bend = bent() if behind else NOT_BENT
        self.inner = [self._actor(mesh.data, _fragment(True, sky=sky), NOT_BENT) for sky in (False, True)]
        """Actors of faces seen from inside, without and with the sky behind; one of them is seen."""
        self.outer, self._parts = [], []
        """Actors of faces seen from outside, each of some triangles; steep ones, as walls and crests before others, come last."""
        for kind in product((False, True), repeat=3):
            part = MovingMesh(0, np.zeros((0, 3)))
            self._parts.append((kind, part.data))
            self.outer.append(self._actor(part.data, _fragment(False, *kind), (FOAM if kind[1] else "") + bend))
        for actor in self.inner:
            actor.GetProperty().FrontfaceCullingOn()
        for actor in self.outer:
            actor.GetProperty().BackfaceCullingOn()
            actor.GetProperty().SetTexture("liquidFoam", foam.texture)
        if behind:
            behind.look_up(self.outer)
        for actor in (*self.inner, *self.outer):
            actor.ForceTranslucentOn()
            actor.GetProperty().SetTexture("liquidDry", cut.texture)
            uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
            uniforms.SetUniform3f("cell", list(cell))
            uniforms.SetUniformf("skinCover", cover)

    @staticmethod
    def _actor(data, fragment: str, functions: str):
        return lit_actor(data, fragment, liquid=True, sky=False, functions=functions)

    def take(self, triangle: np.ndarray, foamy: np.ndarray, whole: bool) -> None:
        """Have these triangles of the sheet, shape (T, 3), of whose vertices foam may be around some, bool, shape (V,);
        ``whole``: without holes."""
        self._triangle, self._foamy, self._whole = triangle, foamy[triangle].any(axis=1), whole

    def part(self, light: Light, eye: np.ndarray, floor: bool) -> None:
        """Draw each triangle by what it needs: as light falls in this frame, as an eye [m] sees it, and by whether a floor is
        behind all."""
        sky = not floor or eye[2] <= self._mesh.points[:, 2].max(initial=-np.inf)
        for actor, seen in zip(self.inner, (not sky, sky)):
            actor.SetVisibility(bool(seen))
        shaded = light.may_shade(self._mesh.points, self._triangle) if len(self._triangle) else np.zeros(0, bool)
        steep = (self._mesh.normals[:, 2] <= LEVEL)[self._triangle].any(axis=1) | (not self._whole)
        kinds, sheet = np.stack([steep, self._foamy, shaded], axis=1), self._mesh.data
        for (kind, data), actor in zip(self._parts, self.outer):
            own = self._triangle[(kinds == kind).all(axis=1)]
            data.SetPoints(sheet.GetPoints())
            data.GetPointData().SetNormals(sheet.GetPointData().GetNormals())
            data.SetPolys(cells(own))
            actor.SetVisibility(len(own) > 0)
