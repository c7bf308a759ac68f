# SPDX-License-Identifier: GPL-2.0-only
"""The light of the pictures as GLSL: a key light with soft shadows, light from the sky, a floor with a grid.

VTK builds its shaders from a template; the pieces below replace marks in it. VTK's own shadow maps have hard
edges and leave much of the floor dark under a parallel lamp, so the shadow is looked up here, in a depth
picture taken from the lamp (render.py).
"""

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

FRAGMENT_HEAD = {
    "//VTK::PositionVC::Dec": """//VTK::PositionVC::Dec
in vec3 worldPosition;
in vec3 worldNormal;
""",
    # The first mark after VTK's own declaration of the texture.
    "//VTK::Picking::Dec": """//VTK::Picking::Dec
// Share of the lamp that is seen from here: the mean over a square four depth pixels wide that slides
// smoothly over them, so that the edge of a shadow is soft and has no steps however near the camera comes.
float shadow(vec3 where, vec3 normal)
{
  // Start off the surface, or it would shade itself: part of the square is nearer to the lamp.
  float lean = length(cross(normal, normalize(lamp)));
  vec3 p = (lampMatrix * vec4(where + normal * lampTexel * (1.0 + 3.0 * lean), 1.0)).xyz;
  if (any(lessThan(p.xy, vec2(0.0))) || any(greaterThan(p.xy, vec2(1.0)))) return 1.0;
  vec2 texel = p.xy * lampPixels - 0.5;
  ivec2 corner = ivec2(floor(texel));
  vec2 part = texel - floor(texel);
  float lit = 0.0;
  for (int j = -1; j <= 3; j++) {
    float row = j == -1 ? 1.0 - part.y : j == 3 ? part.y : 1.0;
    for (int i = -1; i <= 3; i++) {
      float column = i == -1 ? 1.0 - part.x : i == 3 ? part.x : 1.0;
      ivec2 pixel = clamp(corner + ivec2(i - 1, j - 1), ivec2(0), ivec2(lampPixels) - 1);
      float depth = texelFetch(lampDepth, pixel, 0).r;
      lit += row * column * ((depth >= 1.0 || depth >= p.z - lampBias) ? 1.0 : 0.0);
    }
  }
  return lit / 16.0;
}

vec3 linear(vec3 c) { return c * c; }
""",
}

# `diffuseColor` is VTK's name for the colour of the surface here.
FRAGMENT_SOLID = """//VTK::Light::Impl
{
  vec3 n = normalize(worldNormal);
  vec3 toEye = normalize(eye - worldPosition);
  vec3 toLamp = normalize(lamp);
  float facing = max(dot(n, toLamp), 0.0);
  float lit = facing > 0.0 ? shadow(worldPosition, n) : 0.0;
  vec3 base = linear(diffuseColor);
  // Light from the sky above, a little thrown back from the floor below, and from behind the watcher.
  vec3 sky = mix(vec3(0.20, 0.19, 0.18), vec3(0.50, 0.54, 0.60), 0.5 + 0.5 * n.z);
  float fill = 0.16 * max(dot(n, toEye), 0.0);
  vec3 color = base * (sky + fill + vec3(0.86, 0.83, 0.78) * facing * lit);
  vec3 halfway = normalize(toLamp + toEye);
  color += vec3(0.10) * lit * pow(max(dot(n, halfway), 0.0), 40.0);
  fragOutput0 = vec4(sqrt(min(color, vec3(1.0))), 1.0);
}
"""

FRAGMENT_FLOOR = """//VTK::Light::Impl
{
  float lit = shadow(worldPosition, vec3(0.0, 0.0, 1.0));
  // Lines as wide as a pixel and a half, whatever the distance; they fade where they would crowd.
  vec2 fine = worldPosition.xy / gridSpacing;
  vec2 coarse = fine / 5.0;
  vec2 w = fwidth(fine);
  vec2 f = abs(fract(fine - 0.5) - 0.5) / w;
  vec2 c = abs(fract(coarse - 0.5) - 0.5) / (w / 5.0);
  float thin = (1.0 - smoothstep(0.3, 1.2, min(f.x, f.y))) * (1.0 - smoothstep(0.1, 0.4, max(w.x, w.y)));
  float bold = (1.0 - smoothstep(0.5, 1.5, min(c.x, c.y))) * (1.0 - smoothstep(0.5, 2.0, max(w.x, w.y)));
  vec3 color = floorColor * mix(vec3(0.58, 0.62, 0.68), vec3(1.0), lit);
  color = mix(color, gridColor, max(0.22 * thin, 0.55 * bold));
  float away = length(worldPosition.xy - floorCentre.xy) / floorCentre.z;
  vec3 behind = mix(lowColor, highColor, clamp(gl_FragCoord.y / pictureHeight, 0.0, 1.0));
  fragOutput0 = vec4(mix(color, behind, smoothstep(0.25, 1.0, away)), 1.0);
}
"""
