// SPDX-License-Identifier: GPL-2.0-only
// Looks of the floor, and of objects with textures.
import { Color, Mesh, MeshLambertMaterial, PlaneGeometry, Vector2 } from "./vendor.js";
import { FLOORS, NOISE, OBJECTS } from "./patterns.js";

const FLOOR = 5; // half side of the floor, in sizes of the scene

const PATTERN = { // of `render { floor ... }`: how much of the colour of the lines is seen
  plain: "float marked = 0.0;",
  grid: `
  vec2 fine = place.xy / gridStep, coarse = fine / 5.0, w = fwidth(fine);
  vec2 f = abs(fract(fine - 0.5) - 0.5) / w, c = abs(fract(coarse - 0.5) - 0.5) / (w / 5.0);
  float thin = (1.0 - smoothstep(0.3, 1.2, min(f.x, f.y))) * (1.0 - smoothstep(0.1, 0.4, max(w.x, w.y)));
  float bold = (1.0 - smoothstep(0.5, 1.5, min(c.x, c.y))) * (1.0 - smoothstep(0.5, 2.0, max(w.x, w.y)));
  float marked = max(0.22 * thin, 0.5 * bold);`,
  checker: `
  vec2 square = place.xy / (5.0 * gridStep), w = max(fwidth(square), vec2(1e-6));
  vec2 edge = 2.0 * (abs(fract((square - 0.5 * w) * 0.5) - 0.5) - abs(fract((square + 0.5 * w) * 0.5) - 0.5)) / w;
  float marked = 0.3 * (0.5 - 0.5 * edge.x * edge.y);`,
};
// Floors that are painted, and objects with textures: shaders of picture/textures.py, whose colours are those of a screen.
const ON_SCREEN = "vec3 toScreen(vec3 c) { return pow(c, vec3(1.0 / 2.2)); } vec3 toLight(vec3 c) { return pow(c, vec3(2.2)); }\n";
const painted = (pattern) => `
  vec3 worldPosition = place, floorColor = toScreen(diffuseColor.rgb);
  float gridSpacing = gridStep;
  ${FLOORS[pattern]}
  diffuseColor.rgb = toLight(painted);`;
const FLOOR_COLOR = `
  gl_FragColor.rgb = mix(gl_FragColor.rgb, gridColor, marked);
  gl_FragColor.a = 1.0 - smoothstep(0.25, 1.0, distance(place.xy, gridMiddle) / gridReach);
  gl_FragColor.rgb *= gl_FragColor.a;`;

// The floor of a scene, which fades far from the middle.
export function floorOf({ floor, size, grid, pattern, dark, background }, middle) {
  const reach = FLOOR * size;
  const base = new Color(...background[0].map((c) => (c / 255) ** 2.2));
  const material = new MeshLambertMaterial({ color: dark ? base.clone().multiplyScalar(2).addScalar(0.02) : base, transparent: true, premultipliedAlpha: true,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 16 }); // behind the bottom of a liquid at the same height
  material.customProgramCacheKey = () => "floor";
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, {
      gridStep: { value: grid }, gridReach: { value: reach }, gridMiddle: { value: new Vector2(middle.x, middle.y) },
      gridColor: { value: dark ? new Color(0.35, 0.38, 0.42) : new Color(0.42, 0.46, 0.5) },
    });
    shader.vertexShader = "varying vec3 place;\n" + shader.vertexShader.replace("#include <begin_vertex>", "#include <begin_vertex>\nplace = (modelMatrix * vec4(position, 1.0)).xyz;");
    shader.fragmentShader = "varying vec3 place; uniform float gridStep, gridReach; uniform vec2 gridMiddle; uniform vec3 gridColor;\n" +
      (FLOORS[pattern] ? ON_SCREEN + NOISE : "") + shader.fragmentShader
        .replace("#include <color_fragment>", FLOORS[pattern] ? painted(pattern) : "")
        .replace("#include <premultiplied_alpha_fragment>", (PATTERN[pattern] ?? PATTERN.plain) + FLOOR_COLOR);
  };
  const plane = new Mesh(new PlaneGeometry(2 * reach, 2 * reach), material);
  plane.position.set(middle.x, middle.y, floor - 1e-4 * size);
  plane.receiveShadow = true;
  plane.renderOrder = -1;
  return plane;
}

// Let a material have the patterns of the objects' textures, where "on" is 1.
export function texture(material, on) {
  const before = material.onBeforeCompile;
  material.customProgramCacheKey = () => `textures ${before}`;
  material.onBeforeCompile = (shader, renderer) => {
    before?.call(material, shader, renderer);
    shader.uniforms.patterned = on;
    shader.vertexShader = "attribute vec4 material; varying vec4 materialThere;\n" + shader.vertexShader.replace("#include <begin_vertex>", "#include <begin_vertex>\nmaterialThere = material;");
    const functions = OBJECTS.replace("in vec4 materialThere;", "varying vec4 materialThere; uniform float patterned;");
    shader.fragmentShader = ON_SCREEN + functions + shader.fragmentShader
      .replace("#include <color_fragment>", "#include <color_fragment>\nif (patterned > 0.5) diffuseColor.rgb = toLight(textured(toScreen(diffuseColor.rgb)));");
  };
}

// Draw layers nearer to the eye along lines of sight, as in the movie: edges under them come through between particles.
export function liftLayers(material) {
  const before = material.onBeforeCompile, key = material.customProgramCacheKey();
  material.customProgramCacheKey = () => `lifted ${key}`;
  material.onBeforeCompile = (shader, renderer) => {
    before?.call(material, shader, renderer);
    shader.vertexShader = "attribute float lift;\n" + shader.vertexShader.replace("#include <project_vertex>",
      "#include <project_vertex>\ngl_Position = projectionMatrix * vec4(mvPosition.xyz * max(0.0, 1.0 - lift / max(length(mvPosition.xyz), 1e-30)), 1.0);");
  };
}
