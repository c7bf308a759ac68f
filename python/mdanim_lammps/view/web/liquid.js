// SPDX-License-Identifier: GPL-2.0-only
// The liquid: a translucent body with a wavy top, and its colour on what is seen through it.
import {
  BackSide, BufferAttribute, BufferGeometry, DynamicDrawUsage, FrontSide, LineBasicMaterial, LineLoop, Mesh, MeshLambertMaterial,
  MeshPhongMaterial, PlaneGeometry, Vector2, Vector3,
} from "./vendor.js";
import { Drops } from "./drops.js";
import { box } from "./extras.js";
import { DRY, foamOf, stateOf } from "./message.js";

// Light of the liquid's own colour goes farther than other light (Beer and Lambert); the top is taken as level.
const SEEN = `
  vec3 ray = cameraPosition - place + vec3(1e-9);
  vec3 a = (basinLow - place) / ray, b = (basinHigh - place) / ray;
  vec3 enter = min(a, b), leave = max(a, b);
  float from = max(max(enter.x, enter.y), max(enter.z, 0.0)), to = min(min(leave.x, leave.y), min(leave.z, 1.0));
  float way = max(0.0, to - from) * length(ray) / clear;
  gl_FragColor.rgb = gl_FragColor.rgb * exp(-way * (1.25 - liquidColor)) + liquidColor * (1.0 - exp(-0.8 * way));
  #include <colorspace_fragment>`;

// Foam lies in specks, which are the fewer the less of it there is; on a steep face they are drawn out downward.
const SPECKS = `
  float chance(ivec2 at) {
    uint h = uint(at.x) * 73856093u ^ uint(at.y) * 19349663u;
    h = (h ^ (h >> 13)) * 1274126177u;
    return float((h ^ (h >> 16)) & 0xffffu) / 65535.0;
  }
  float uneven(vec2 p) {
    ivec2 at = ivec2(floor(p));
    vec2 t = smoothstep(0.0, 1.0, fract(p));
    return mix(mix(chance(at), chance(at + ivec2(1, 0)), t.x), mix(chance(at + ivec2(0, 1)), chance(at + ivec2(1, 1)), t.x), t.y);
  }
  float specks(vec2 p) { return 0.55 * uneven(p) + 0.3 * uneven(2.3 * p + 17.0) + 0.15 * uneven(5.1 * p + 5.0); }
  float foam(out float bright) {
    bright = 1.0;
    if (whitened <= 0.0) return 0.0;
    float upright = specks(vec2(plan.x + plan.y, 0.25 * plan.z) / speck.x), flat_ = specks(plan.xy / speck);
    float some = mix(upright, flat_, smoothstep(0.35, 0.75, level));
    bright = smoothstep(0.2, 0.7, some);
    return smoothstep(0.85, 1.22, some + 0.8 * whitened) * smoothstep(0.0, 0.15, whitened);
  }
`;

export class Liquid {
  constructor(world, scene) {
    const { low, high, shape, color } = (this.basin = scene.liquid), [nx, ny] = shape;
    const tint = color.map((c) => (c / 255) ** 2.2), hex = (color[0] << 16) | (color[1] << 8) | color[2];
    const clear = 0.5 * Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    this.top = new Vector3(...high);
    this.uniforms = {
      basinLow: { value: new Vector3(...low) }, basinHigh: { value: this.top }, clear: { value: clear }, liquidColor: { value: new Vector3(...tint) },
    };
    const middles = (axis, n) => [low[axis], ...Array.from({ length: n }, (_, i) => low[axis] + ((i + 0.5) * (high[axis] - low[axis])) / n), high[axis]];
    [this.x, this.y] = [middles(0, nx), middles(1, ny)];
    const W = nx + 2, H = ny + 2, row = (n, place) => Array.from({ length: n }, (_, i) => place(i));
    this.sides = [
      [row(W, (i) => i), [0, -1, 0]], [row(H, (j) => j * W + W - 1), [1, 0, 0]],
      [row(W, (i) => (H - 1) * W + W - 1 - i), [0, 1, 0]], [row(H, (j) => (H - 1 - j) * W), [-1, 0, 0]],
    ];
    const V = W * H + 4 * (W + H), geometry = (this.geometry = new BufferGeometry());
    [this.at, this.normal] = [new Float32Array(3 * V), new Float32Array(3 * V)];
    this.cover = new Float32Array(V).fill(1);
    this.white = new Float32Array(V);
    for (const [name, array, size] of [["position", this.at, 3], ["normal", this.normal, 3], ["cover", this.cover, 1], ["white", this.white, 1]]) {
      geometry.setAttribute(name, new BufferAttribute(array, size).setUsage(DynamicDrawUsage));
    }
    geometry.setIndex(new BufferAttribute(scene.data.sheet, 1));
    this.parts = [[BackSide, 0.1], [FrontSide, 0.3]].map(([side, opacity], order) => {
      const skin = new MeshPhongMaterial({ color: hex, transparent: true, opacity, depthWrite: false, side, specular: 0x99aab4, shininess: 120 });
      holesAndFoam(skin, this.basin);
      const part = new Mesh(geometry, skin);
      part.renderOrder = order + 1;
      part.frustumCulled = false;
      part.receiveShadow = order === 1;
      return part;
    });
    this.rim = scene.data.rim;
    this.edge = new Float32Array(3 * this.rim.length);
    const line = new LineLoop(new BufferGeometry().setAttribute("position", new BufferAttribute(this.edge, 3)), new LineBasicMaterial({ color: 0xffffff, transparent: true, opacity: 0.7 }));
    line.renderOrder = 3;
    line.frustumCulled = false;
    this.parts.push(line);
    const plate = new Mesh(new PlaneGeometry(high[0] - low[0], high[1] - low[1]), new MeshLambertMaterial({ color: scene.dark ? 0x48545e : 0xbcc7cf }));
    plate.position.set((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]);
    plate.receiveShadow = true;
    this.colourThrough(plate.material);
    this.drops = this.basin.drops ? new Drops(world, { most: this.basin.drops, color: hex }) : null;
    if (this.drops) this.parts.push(this.drops.points);
    world.add(plate, box([low, high], scene.dark ? 0xaebac2 : 0x7f93a3), ...this.parts);
  }

  set visible(on) {
    this.parts.forEach((part) => (part.visible = on));
    this.uniforms.clear.value = on ? 0.5 * new Vector3(...this.basin.high).distanceTo(this.uniforms.basinLow.value) : 1e30;
  }

  // Let what is lit take the liquid's colour where it is seen through liquid.
  colourThrough(material) {
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms);
      shader.vertexShader = "varying vec3 place;\n" + shader.vertexShader.replace("#include <begin_vertex>", "#include <begin_vertex>\nplace = (modelMatrix * vec4(position, 1.0)).xyz;");
      shader.fragmentShader = "varying vec3 place; uniform vec3 basinLow, basinHigh, liquidColor; uniform float clear;\n" +
        shader.fragmentShader.replace("#include <colorspace_fragment>", SEEN);
    };
  }

  // Heights of a frame; below a hull there is no surface.
  show({ liquid, columns, drops }) {
    this.drops?.show(drops ?? new Float32Array(0));
    const { low, high, shape: [nx, ny] } = this.basin, W = nx + 2, H = ny + 2, scale = (high[2] - low[2]) / 65535, { at, normal, cover, white, x, y } = this;
    const column = (j, i) => Math.min(ny - 1, Math.max(0, j - 1)) * nx + Math.min(nx - 1, Math.max(0, i - 1));
    const z = (j, i) => low[2] + scale * liquid[column(j, i)];
    for (let j = 0, v = 0; j < H; j++) {
      const [above, below] = [Math.max(0, j - 1), Math.min(H - 1, j + 1)];
      for (let i = 0; i < W; i++, v++) {
        const [left, right] = [Math.max(0, i - 1), Math.min(W - 1, i + 1)];
        at[3 * v] = x[i]; at[3 * v + 1] = y[j]; at[3 * v + 2] = z(j, i);
        normal[3 * v] = -(z(j, right) - z(j, left)) / (x[right] - x[left]);
        normal[3 * v + 1] = -(z(below, i) - z(above, i)) / (y[below] - y[above]);
        normal[3 * v + 2] = 1;
        const deep = liquid[column(j, i)] * scale > 0.3 * ((high[2] - low[2]) / this.basin.shape[2]);
        cover[v] = stateOf(columns[column(j, i)]) !== DRY && deep ? 1 : 0;
        white[v] = foamOf(columns[column(j, i)]);
      }
    }
    let v = W * H;
    for (const [side, out] of this.sides) {
      for (const bottom of [0, 1]) {
        for (const top of side) {
          for (let d = 0; d < 3; d++) { at[3 * v + d] = at[3 * top + d]; normal[3 * v + d] = out[d]; }
          if (bottom) at[3 * v + 2] = low[2];
          cover[v++] = 1;
        }
      }
    }
    for (const name of ["position", "normal", "cover", "white"]) this.geometry.attributes[name].needsUpdate = true;
    this.rim.forEach((vertex, k) => { for (let d = 0; d < 3; d++) this.edge[3 * k + d] = at[3 * vertex + d]; });
    this.parts[2].geometry.attributes.position.needsUpdate = true;
    this.top.z = low[2] + scale * (liquid.reduce((sum, h) => sum + h, 0) / liquid.length);
  }
}

// The sheet has holes where it is dry, and foam, in specks as in picture/shading.py.
function holesAndFoam(material, { low, high, shape: [nx, ny] }) {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.speck = { value: new Vector2((0.7 * (high[0] - low[0])) / nx, (0.7 * (high[1] - low[1])) / ny) };
    shader.vertexShader = "attribute float cover, white; varying float covered, whitened, level; varying vec3 plan;\n" +
      shader.vertexShader.replace("#include <begin_vertex>", "#include <begin_vertex>\ncovered = cover; whitened = white; plan = position; level = normalize(normal).z;");
    shader.fragmentShader = "varying float covered, whitened, level; varying vec3 plan; uniform vec2 speck;\n" + SPECKS + shader.fragmentShader
      .replace("#include <clipping_planes_fragment>", "#include <clipping_planes_fragment>\nif (covered < 0.5) discard;")
      .replace("#include <opaque_fragment>", "#include <opaque_fragment>\nfloat bright, white = foam(bright);\ngl_FragColor = mix(gl_FragColor, vec4(mix(vec3(0.62, 0.7, 0.76), vec3(0.9), bright), 0.95), white);");
  };
}
