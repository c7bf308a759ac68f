# SPDX-License-Identifier: GPL-2.0-only
"""The light of the pictures as GLSL: one key light with soft shadows, light from the sky, a floor with a grid.

VTK builds its shaders from a template; the pieces below replace marks in it. VTK's own shadow maps leave the light
of a parallel lamp in stripes and have hard edges, so the shadow is looked up here, in a depth picture taken from
the lamp (render.py).
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
// Samples on a disc, turned by the golden angle: even cover with few of them.
float shadow(vec3 where, vec3 normal)
{
  // Start a little off the surface, or it would shade itself where light grazes it.
  vec3 p = (lampMatrix * vec4(where + normal * lampTexel, 1.0)).xyz;
  if (any(lessThan(p.xy, vec2(0.0))) || any(greaterThan(p.xy, vec2(1.0)))) return 1.0;
  float lit = 0.0;
  for (int i = 0; i < SAMPLES; i++) {
    float angle = 2.39996 * float(i);
    float r = lampBlur * sqrt((float(i) + 0.5) / float(SAMPLES));
    float depth = texture(lampDepth, p.xy + r * vec2(cos(angle), sin(angle))).r;
    lit += (depth >= 1.0 || depth >= p.z - lampBias) ? 1.0 : 0.0;
  }
  return lit / float(SAMPLES);
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
