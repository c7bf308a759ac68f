# SPDX-License-Identifier: GPL-2.0-only
"""The light of the pictures as GLSL: a key light with soft shadows, light from the sky, a floor, liquid.

VTK builds its shaders from a template; the pieces below replace marks in it. VTK's own shadow maps have hard
edges and leave much of the floor dark under a parallel lamp, so the shadow is looked up here, in a depth
picture taken from the lamp (light.py).
"""

from .rays import FAR, NEAR, ROOM, SKY_PIXELS, SKY_SIDE, sky_axes
from .textures import FLOORS, NOISE

HIDDEN = 0.75
"""Share of the light that is missing where nothing is seen of the sky; surfaces that hide it throw the rest back."""

REFRACTIVE_INDEX = 1.33
"""Refractive index of the liquid, over that of air."""

VERTEX = {
    "//VTK::PositionVC::Dec": """//VTK::PositionVC::Dec
out vec3 worldPosition;
out vec3 worldNormal;
""",
    "//VTK::PositionVC::Impl": """//VTK::PositionVC::Impl
worldPosition = vertexMC.xyz;
worldNormal = normalMC;
""",
}


def fragment_head(liquid: bool, sky: bool, lamp: str, functions: str) -> dict[str, str]:
    """Declarations and functions that every lit fragment shader below uses, how it sees the lamp (LAMP or LAMP_ON_FLOOR), and
    those that one uses, by VTK's mark."""
    return {
        "//VTK::PositionVC::Dec": """//VTK::PositionVC::Dec
in vec3 worldPosition;
in vec3 worldNormal;
""",
        # The first mark after VTK's own declaration of the texture.
        "//VTK::Picking::Dec": "//VTK::Picking::Dec\n"
        + COMMON
        + lamp
        + (sky_looked_at() if sky else SKY_NOT_LOOKED_AT)
        + (THROUGH_LIQUID if liquid else THROUGH_AIR)
        + functions,
    }


COMMON = """
// A number of a field whose texels hold four. To choose among them is quicker than to index them.
float numberAt(sampler2D field, ivec2 place)
{
  vec4 four = texelFetch(field, ivec2(place.x >> 2, place.y), 0);
  int which = place.x & 3;
  return which < 2 ? (which == 0 ? four.r : four.g) : (which == 2 ? four.b : four.a);
}

// Normal of the triangle that is drawn, on the side of the shading's normal.
vec3 facet(vec3 where, vec3 normal)
{
  vec3 flat_ = cross(dFdx(where), dFdy(where));
  float size = length(flat_);
  return size > 0.0 ? flat_ * (sign(dot(flat_, normal)) / size) : normal;
}

vec3 linear(vec3 c) { return c * c; }
"""

LAMP = """
// Share of the lamp that is seen from a point of a surface: the mean over a square four depth pixels wide that slides
// smoothly over them, so that the edge of a shadow is soft and has no steps however near the camera comes. What a depth pixel
// holds is compared with the plane of the surface there. What is nearer by less than `slack` depth pixels does not shade.
float lampSeen(vec3 where, vec3 normal, float slack)
{
  vec3 p = (lampMatrix * vec4(where, 1.0)).xyz;
  if (any(lessThan(p.xy, vec2(0.0))) || any(greaterThan(p.xy, vec2(1.0)))) return 1.0;
  vec2 texel = p.xy * lampPixels - 0.5;
  ivec2 corner = ivec2(floor(texel));
  vec2 part = texel - floor(texel);
  vec2 slope = lampTouch * vec2(dot(normal, lampRight), dot(normal, lampUp)) / max(dot(normal, lamp), 0.15);
  float least = p.z - slack * lampTouch;
  // Most lit points have no object between them and the lamp, nor near that line.
  ivec2 block = clamp(corner, ivec2(0), ivec2(lampPixels) - 1) / lampBlock;
  float nearest = numberAt(lampNearest, block);
  int rows = nearest > least + 3.0 * (abs(slope.x) + abs(slope.y)) ? 0 : 5;
  // Five pixels of a row lie in two texels. Of their eight pixels those count that are less than 2.5 from the middle.
  ivec2 last = ivec2(lampPixels) - 1;
  int first = (corner.x - 2) >> 2;
  float begin = float(4 * first - corner.x) - part.x;
  vec4 one = begin + vec4(0.0, 1.0, 2.0, 3.0), other = one + 4.0;
  vec4 oneCounts = clamp(2.5 - abs(one + 0.5), 0.0, 1.0), otherCounts = clamp(2.5 - abs(other + 0.5), 0.0, 1.0);
  vec4 oneAbove = least + slope.x * one, otherAbove = least + slope.x * other;
  float lit = rows == 0 ? 16.0 : 0.0;
  // Software OpenGL computes both ways of a branch, but a loop ends where no pixel near by needs it.
  for (int j = 0; j < rows; j++) {
    float row = j == 0 ? 1.0 - part.y : j == 4 ? part.y : 1.0, rise = slope.y * (float(j - 2) - part.y);
    int y = clamp(corner.y + j - 2, 0, last.y);
    vec4 there = texelFetch(lampDepth, ivec2(clamp(first, 0, last.x >> 2), y), 0);
    vec4 beside = texelFetch(lampDepth, ivec2(clamp(first + 1, 0, last.x >> 2), y), 0);
    vec4 free = vec4(greaterThan(there, min(oneAbove + rise, vec4(0.9999999))));
    vec4 alsoFree = vec4(greaterThan(beside, min(otherAbove + rise, vec4(0.9999999))));
    lit += row * (dot(oneCounts, free) + dot(otherCounts, alsoFree));
  }
  return lit > 15.9999 ? 1.0 : lit / 16.0;
}

float shadow(vec3 where, vec3 normal, float slack)
{
  return mix(1.0, lampSeen(where, normal, slack), shadowDarkness);
}
"""

# The same on a level floor, where it is worked out beforehand (floor.py).
LAMP_ON_FLOOR = """
float shadow(vec3 where)
{
  vec3 p = (lampMatrix * vec4(where, 1.0)).xyz;
  if (any(lessThan(p.xy, vec2(0.0))) || any(greaterThan(p.xy, vec2(1.0)))) return 1.0;
  return mix(1.0, texture(floorShade, p.xy).r, shadowDarkness);
}
"""

# Hides what is behind it. It covers next to nothing: where nothing is covered VTK writes no depth.
FRAGMENT_NOTHING = """//VTK::Light::Impl
fragOutput0 = vec4(0.0, 0.0, 0.0, 1e-6);
"""

SKY_NOT_LOOKED_AT = """
float skySeen(vec3 where, vec3 normal, vec3 plane, float slack) { return 1.0; }
"""

SKY_LOOKED_AT = """
// How much light comes from the sky above this surface and from what stands around it: the mean over directions, each weighted by
// how much light it brings. A pixel that is drawn looks into every fourth direction, so one that is shown has looked into all.
// `plane` is the normal of the surface as it is drawn; `slack` is as above.
float skySeen(vec3 where, vec3 normal, vec3 plane, float slack)
{
  const float pixel = 2.0 * SKY_ROOM / SKY_PIXELS;
  vec3 p = (where - skyCentre) / skyRadius;
  // Aside, differently for each pixel and direction, so that neither depth pixels nor outlines of what hides the sky show.
  const float ASIDE = 2.0;
  vec2 aside = fract(vec2(52.98, 31.17) * fract(dot(gl_FragCoord.xy, vec2(0.0671, 0.0058))));
  float hidden = 0.0, all = 0.0;
  for (int k = (int(gl_FragCoord.x) & 1) + 2 * (int(gl_FragCoord.y) & 1); k < SKY_SIDE * SKY_SIDE; k += 4) {
    float facing = dot(normal, skyToward[k]);
    if (facing <= 0.0) continue;
    all += facing;
    vec2 across = vec2(dot(p, skyRight[k]), dot(p, skyUp[k])) / pixel + 0.5 * float(SKY_PIXELS);
    ivec2 texel = ivec2(floor(across + ASIDE * (fract(aside + float(k) * vec2(0.7548777, 0.5698403)) - 0.5)));
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(SKY_PIXELS)))) continue;
    ivec2 place = texel + SKY_PIXELS * ivec2(k % SKY_SIDE, k / SKY_SIDE);
    float there = numberAt(skyDepth, place);
    // The plane of the surface, where the pixel is.
    vec2 slope = vec2(dot(plane, skyRight[k]), dot(plane, skyUp[k])) / max(dot(plane, skyToward[k]), 0.15);
    float height = dot(p, skyToward[k]) - pixel * dot(slope, vec2(texel) + 0.5 - across);
    float nearer = (2.0 - SKY_NEAR - height) - (SKY_FAR - SKY_NEAR) * there - slack * pixel;
    // A surface far away hides nothing: it throws back about as much light as the sky behind it.
    if (there < 1.0 && nearer > 0.0) hidden += facing * max(0.0, 1.0 - nearer * skyRadius / skyReach);
  }
  return all > 0.0 ? 1.0 - SKY_HIDDEN * hidden / all : 1.0;
}
"""


def sky_looked_at() -> str:
    """The function above with its numbers and directions."""
    numbers = {"SIDE": SKY_SIDE, "PIXELS": SKY_PIXELS, "ROOM": ROOM, "NEAR": NEAR, "FAR": FAR, "HIDDEN": HIDDEN}
    lines = [f"#define SKY_{name} {value}" for name, value in numbers.items()]
    for name, vectors in zip(("Right", "Up", "Toward"), sky_axes().transpose(1, 0, 2)):
        values = ", ".join(f"vec3({x:.7f}, {y:.7f}, {z:.7f})" for x, y, z in vectors)
        lines.append(f"const vec3 sky{name}[{len(vectors)}] = vec3[]({values});")
    return "\n".join(["", *lines, SKY_LOOKED_AT])


THROUGH_AIR = """
vec3 seen(vec3 color, vec3 where) { return color; }
"""

# Light seen through liquid takes its colour with the way that it has gone in it (Beer and Lambert).
THROUGH_LIQUID = """
// Heights of the surface, of a pond that stands on a body above it, and of the body's face below the pond.
vec3 liquidHeight(vec2 where)
{
  return texture(liquidHeights, (where - basinLow.xy) / (basinHigh.xy - basinLow.xy)).rgb;
}

// How deep a point is in the liquid; below zero outside.
float liquidCover(vec3 p)
{
  vec3 height = liquidHeight(p.xy);
  return max(height.r - p.z, min(height.g - p.z, p.z - height.b));
}

// Metres of liquid between a point and the eye, along the ray's part in the basin. Below the lowest height
// there is liquid all the way; the rest is cut into up to a dozen pieces. The surface is taken as straight
// within a piece, so that nothing jumps where it is crossed.
float liquidPath(vec3 where)
{
  vec3 ray = eye - where + vec3(1e-9);
  vec3 a = (basinLow - where) / ray;
  vec3 b = (vec3(basinHigh.xy, liquidTop) - where) / ray;
  vec3 enter = min(a, b), leave = max(a, b);
  float from = max(max(enter.x, enter.y), max(enter.z, 0.0));
  float to = min(min(leave.x, leave.y), min(leave.z, 1.0));
  if (from >= to) return 0.0;
  float cross = clamp((liquidLow - where.z) / ray.z, from, to);
  vec2 wavy = ray.z > 0.0 ? vec2(cross, to) : vec2(from, cross);
  float whole = to - from, part = wavy.y - wavy.x;
  int pieces = int(ceil(12.0 * part / whole - 1e-3));
  float wet = 0.0, before = 0.0;
  for (int k = 0; k <= pieces; k++) {
    vec3 p = where + ray * mix(wavy.x, wavy.y, float(k) / float(max(pieces, 1)));
    float cover = liquidCover(p);
    float high = max(before, cover), low = min(before, cover);
    if (k > 0) wet += clamp(high / max(high - low, 1e-9), 0.0, 1.0);
    before = cover;
  }
  return length(ray) * (whole - part + (pieces > 0 ? part * wet / float(pieces) : 0.0));
}

vec3 seen(vec3 color, vec3 where)
{
  // Light of the liquid's own colour goes farther than other light.
  float way = liquidPath(where) / liquidClear;
  vec3 left = exp(-way * (1.25 - liquidColor));
  return color * left + liquidColor * (1.0 - exp(-0.8 * way));
}
"""

# `diffuseColor` is VTK's name for the colour of the surface here.
SOLID = """//VTK::Light::Impl
{
  vec3 n = normalize(worldNormal);
  vec3 toEye = normalize(eye - worldPosition);
  vec3 toLamp = normalize(lamp);
  vec3 plane = facet(worldPosition, n);
  float facing = max(dot(n, toLamp), 0.0);
  float lit = facing > 0.0 ? shadow(worldPosition, plane, 1.0) : 0.0;
  vec3 base = linear(COLOR);
  // Light from the sky above, a little thrown back from the floor below, and from behind the camera.
  vec3 sky = mix(vec3(0.20, 0.19, 0.18), vec3(0.50, 0.54, 0.60), 0.5 + 0.5 * n.z) * skySeen(worldPosition, n, plane, 0.5);
  float fill = 0.16 * max(dot(n, toEye), 0.0);
  vec3 color = base * (sky + fill + vec3(0.86, 0.83, 0.78) * facing * lit);
  vec3 halfway = normalize(toLamp + toEye);
  color += vec3(0.10) * lit * pow(max(dot(n, halfway), 0.0), 40.0);
  fragOutput0 = vec4(seen(sqrt(min(color, vec3(1.0))), worldPosition), 1.0);
}
"""

FRAGMENT_SOLID = SOLID.replace("COLOR", "diffuseColor")
FRAGMENT_TEXTURED = SOLID.replace("COLOR", "textured(diffuseColor)")

# Lines as wide as a pixel and a half, whatever the distance; they fade where they would crowd.
GRID = """
  vec2 fine = worldPosition.xy / gridSpacing;
  vec2 coarse = fine / 5.0;
  vec2 w = fwidth(fine) * linePixels;
  vec2 f = abs(fract(fine - 0.5) - 0.5) / w;
  vec2 c = abs(fract(coarse - 0.5) - 0.5) / (w / 5.0);
  float thin = (1.0 - smoothstep(0.3, 1.2, min(f.x, f.y))) * (1.0 - smoothstep(0.1, 0.4, max(w.x, w.y)));
  float bold = (1.0 - smoothstep(0.5, 1.5, min(c.x, c.y))) * (1.0 - smoothstep(0.5, 2.0, max(w.x, w.y)));
  float marked = max(0.22 * thin, 0.55 * bold);
  vec3 painted = mix(floorColor, gridColor, marked);
"""
# Squares as wide as five lines are apart; each pixel has the mean over the part of the floor that it shows.
CHECKER = """
  vec2 square = worldPosition.xy / (5.0 * gridSpacing);
  vec2 w = max(fwidth(square), vec2(1e-6));
  vec2 edge = 2.0 * (abs(fract((square - 0.5 * w) * 0.5) - 0.5) - abs(fract((square + 0.5 * w) * 0.5) - 0.5)) / w;
  float marked = 0.3 * (0.5 - 0.5 * edge.x * edge.y);
  vec3 painted = mix(floorColor, gridColor, marked);
"""
PLAIN = "  vec3 painted = mix(floorColor, gridColor, 0.0);\n"
PATTERN = {"plain": PLAIN, "grid": GRID, "checker": CHECKER, **FLOORS}
"""By ``render { floor ... }``."""


def fragment_floor(pattern: str) -> str:
    """The shader of a floor with one of `PATTERN`."""
    return FLOOR.replace("PATTERN", PATTERN[pattern])


def floor_functions(pattern: str) -> str:
    """Functions that this shader uses."""
    return NOISE if pattern in FLOORS else ""


# The floor hides nothing, so depth pictures do not hold it.
FLOOR = """//VTK::Light::Impl
{
  vec3 up = vec3(0.0, 0.0, 1.0);
  float lit = shadow(worldPosition);
PATTERN
  // A surface that hides the sky throws back some of the lamp's warmer light: in all, grey is missing.
  vec3 light = mix(vec3(0.58, 0.62, 0.68), vec3(1.0), lit) - 0.62 * (1.0 - skySeen(worldPosition, up, up, 0.0));
  vec3 color = painted * light;
  float away = length(worldPosition.xy - floorCentre.xy) / floorCentre.z;
  vec3 behind = mix(lowColor, highColor, clamp((gl_FragCoord.y + pictureBottom) / pictureHeight, 0.0, 1.0));
  fragOutput0 = vec4(seen(mix(color, behind, smoothstep(0.25, 1.0, away)), worldPosition), 1.0);
}
"""

# A drop of the liquid: nearly white, as spray is, bluer below, and with the lamp's glint.
FRAGMENT_DROP = """//VTK::Light::Impl
{
  vec3 n = normalize(worldNormal);
  vec3 toEye = normalize(eye - worldPosition);
  vec3 toLamp = normalize(lamp);
  float lit = shadow(worldPosition, n, 0.0);
  float graze = pow(1.0 - max(dot(n, toEye), 0.0), 2.0);
  vec3 mirrored = reflect(-toEye, n);
  vec3 color = mix(liquidColor, vec3(0.94, 0.97, 0.99), 0.55 + 0.25 * mirrored.z + 0.2 * max(dot(n, toLamp), 0.0) * lit);
  float glint = lit * pow(max(dot(normalize(toLamp + toEye), n), 0.0), 40.0);
  fragOutput0 = vec4(min(color + glint, vec3(1.0)), min(1.0, 0.65 + 0.25 * graze + glint));
}
"""

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
  float there = foamMost > 0.0 ? texture(liquidFoam, (where.xy - basinLow.xy) / (basinHigh.xy - basinLow.xy)).r : 0.0;
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
"""


def bent() -> str:
    """The function above with its number."""
    return BENT.replace("REFRACTIVE_INDEX", str(REFRACTIVE_INDEX))


# The skin of the liquid, laid over what `seen` has coloured already: what it mirrors, and the lamp's glint.
# Where it is thinner than half a cell it fades out, so that a dry floor is bare.
FRAGMENT_LIQUID = """//VTK::Light::Impl
{
  vec3 n = normalize(worldNormal);
  vec3 toEye = normalize(eye - worldPosition);
  vec3 toLamp = normalize(lamp);
  // Beside a wall the depth is that of the column behind it.
  float inside = liquidHeight(worldPosition.xy - 0.25 * cell.xy * n.xy).r;
  float top = n.z > 0.5 ? worldPosition.z : abs(n.z) > 1e-3 ? max(worldPosition.z, inside) : inside;
  // The sheet runs on through a hull that is dry inside; at the glass the liquid below the hull is seen.
  float dry = texture(liquidDry, (worldPosition.xy - basinLow.xy) / (basinHigh.xy - basinLow.xy)).r;
  if (dry > 0.5 && (abs(n.z) > 1e-3 || worldPosition.z > inside + 0.5 * cell.z)) discard;
  float film = smoothstep(0.1, 0.5, (top - basinLow.z) / cell.z);
  if (film <= 0.0) discard;
  bool inner = dot(n, toEye) < 0.0;
  if (inner) n = -n;
  float lit = inner ? 0.0 : shadow(worldPosition, n, 0.0);
  float graze = pow(1.0 - max(dot(n, toEye), 0.0), 3.0);
  vec3 mirrored = reflect(-toEye, n);
  // Bright towards the horizon, blue above: what a slope mirrors tells how it leans.
  float low = n.z > 0.3 && !inner ? 1.0 - smoothstep(0.0, 0.75, mirrored.z) : 0.15;
  vec3 color = liquidColor * (0.62 + 0.40 * max(dot(n, toLamp), 0.0) * (0.45 + 0.55 * lit));
  color = mix(color, vec3(0.96, 0.99, 1.0), min(1.0, 0.75 * low + 0.4 * graze));
  float glint = lit * pow(max(dot(normalize(toLamp + toEye), n), 0.0), 120.0);
  float cover = mix(skinCover, 0.80, max(graze, 0.6 * low));
  float bright;
  float white = inner ? 0.0 : foam(worldPosition, inside, n, bright);
  vec3 flake = mix(vec3(0.80, 0.84, 0.87), vec3(0.90, 0.92, 0.93), bright);
  color = mix(color, flake + vec3(0.12, 0.10, 0.08) * max(dot(n, toLamp), 0.0) * lit, white);
  cover = mix(cover, 0.95, white);
  glint *= 1.0 - white;
  if (inner) {
    // Behind the inner faces is floor, which `seen` has coloured, or sky, which is still to be coloured.
    vec3 past = worldPosition - toEye * (worldPosition.z - floorHeight) / toEye.z;
    bool sky = toEye.z <= 0.0 || any(greaterThan(abs(past.xy - floorCentre.xy), vec2(floorCentre.z)));
    cover = 0.10;
    if (sky) {
      cover = 1.0 - exp(-0.8 * liquidPath(worldPosition) / liquidClear);
      color = liquidColor;
    }
  }
  color = min(color + 0.8 * glint, vec3(1.0));
  cover = min(1.0, cover + 0.8 * glint);
  vec3 aside;
  if (!inner && bentAside(worldPosition, n, toEye, aside)) {
    color = mix(aside, color, cover);
    cover = 1.0;
  }
  fragOutput0 = vec4(color, film * cover);
}
"""
