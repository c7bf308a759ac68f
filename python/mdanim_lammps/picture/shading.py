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
// Nothing here depends on what is looked up: software OpenGL is slower with a branch or a loop that may end early.
float lampSeen(vec3 where, vec3 normal, float slack)
{
  vec3 p = (lampMatrix * vec4(where, 1.0)).xyz;
  // The outermost pixels hold nothing.
  vec2 texel = clamp(p.xy * lampPixels - 0.5, vec2(2.0), lampPixels - 4.0);
  ivec2 corner = ivec2(texel);
  vec2 part = texel - floor(texel);
  vec2 slope = lampTouch * vec2(dot(normal, lampRight), dot(normal, lampUp)) / max(dot(normal, lamp), 0.15);
  float least = p.z - slack * lampTouch;
  // Five pixels of a row lie in two texels. Of their eight pixels those count that are less than 2.5 from the middle.
  int first = (corner.x - 2) >> 2;
  float begin = float(4 * first - corner.x) - part.x;
  vec4 one = begin + vec4(0.0, 1.0, 2.0, 3.0), other = one + 4.0;
  vec4 oneCounts = clamp(2.5 - abs(one + 0.5), 0.0, 1.0), otherCounts = clamp(2.5 - abs(other + 0.5), 0.0, 1.0);
  vec4 oneAbove = least + slope.x * one, otherAbove = least + slope.x * other;
  float lit = 0.0;
  for (int j = 0; j < 5; j++) {
    float row = j == 0 ? 1.0 - part.y : j == 4 ? part.y : 1.0, rise = slope.y * (float(j - 2) - part.y);
    vec4 there = texelFetch(lampDepth, ivec2(first, corner.y + j - 2), 0);
    vec4 beside = texelFetch(lampDepth, ivec2(first + 1, corner.y + j - 2), 0);
    vec4 free = vec4(greaterThan(there, min(oneAbove + rise, vec4(0.9999999))));
    vec4 alsoFree = vec4(greaterThan(beside, min(otherAbove + rise, vec4(0.9999999))));
    lit += row * (dot(oneCounts, free) + dot(otherCounts, alsoFree));
  }
  bool beyond = any(lessThan(p.xy, vec2(0.0))) || any(greaterThan(p.xy, vec2(1.0)));
  return beyond || lit > 15.9999 ? 1.0 : lit / 16.0;
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
