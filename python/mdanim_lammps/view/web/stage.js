// SPDX-License-Identifier: GPL-2.0-only
// The 3-D picture: objects, floor, lamp and camera.
import {
  BufferAttribute, BufferGeometry, Color, DirectionalLight, DynamicDrawUsage, HemisphereLight, Mesh, MeshLambertMaterial,
  MeshPhongMaterial, OrbitControls, PCFShadowMap, PerspectiveCamera, PlaneGeometry, Scene, Vector2, Vector3, WebGLRenderer,
} from "./vendor.js";
import { Extras } from "./extras.js";
import { Liquid } from "./liquid.js";
import { pick, placeVertices, sumNormals } from "./message.js";

const SHADOWS = [2048, 1024, 512], PIXELS = [1, 0.7, 0.5]; // by level of quality
export const COARSEST = SHADOWS.length - 1;
const MOST_PIXELS = 4e6; // of a picture at rest that a processor draws
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
const FLOOR_COLOR = `
  gl_FragColor.rgb = mix(gl_FragColor.rgb, gridColor, marked);
  gl_FragColor.a = 1.0 - smoothstep(0.25, 1.0, distance(place.xy, gridMiddle) / gridReach);
  gl_FragColor.rgb *= gl_FragColor.a;`;

// Whether a processor draws, not a graphics card.
function drawnByProcessor() {
  const gl = document.createElement("canvas").getContext("webgl2"), info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = gl?.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER) ?? "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|basic render/i.test(name);
}

const ABOVE_FLOOR = 0.495 * Math.PI; // angle from above at which a drag stops: nothing stands on a floor that is seen from below

export class Stage {
  constructor(canvas, scene) {
    this.scene = scene;
    this.changed = true; // whether a new picture is due
    this.followed = null; // object that the camera goes with
    this.level = 0;
    this.slow = drawnByProcessor();
    // A processor takes more pixels instead of more samples of each, and these at rest only.
    const renderer = (this.renderer = new WebGLRenderer({ canvas, antialias: !this.slow, alpha: true, powerPreference: "high-performance" }));
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.autoUpdate = false;
    renderer.shadowMap.type = PCFShadowMap;
    this.world = new Scene();
    this.camera = new PerspectiveCamera(scene.fieldOfView, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.enableDamping = false;
    this.orbit.addEventListener("change", () => (this.changed = true));
    this.lights();
    this.liquid = scene.liquid ? new Liquid(this.world, scene) : null;
    this.solids();
    if (scene.floor !== null) this.floor();
    this.extras = new Extras(this.world, scene);
    this.seeStart();
    if (scene.floor !== null) this.orbit.maxPolarAngle = Math.max(ABOVE_FLOOR, this.orbit.getPolarAngle());
    this.resize();
  }

  lights() {
    const { lamp, bounds, size } = this.scene, middle = new Vector3(...bounds[0]).add(new Vector3(...bounds[1])).multiplyScalar(0.5);
    this.middle = middle;
    this.world.add(new HemisphereLight(0xf4f8ff, 0xb9b0a4, 1.6));
    const sun = (this.sun = new DirectionalLight(0xfffaf0, 2.1)), reach = 0.62 * size;
    sun.position.copy(middle).addScaledVector(new Vector3(...lamp), 2 * size);
    sun.target.position.copy(middle);
    sun.castShadow = true;
    sun.shadow.intensity = this.scene.shadows;
    sun.shadow.mapSize.set(SHADOWS[0], SHADOWS[0]);
    sun.shadow.bias = -4e-4;
    sun.shadow.normalBias = 0.0015 * size;
    Object.assign(sun.shadow.camera, { left: -reach, bottom: -reach, right: reach, top: reach, near: 0.8 * size, far: 3.2 * size });
    this.world.add(sun, sun.target);
  }

  solids() {
    const { data, objects } = this.scene, V = data.object.length, geometry = (this.geometry = new BufferGeometry());
    [this.at, this.normal, this.tint] = [0, 1, 2].map(() => new Float32Array(3 * V));
    for (const [name, array] of [["position", this.at], ["normal", this.normal], ["color", this.tint]]) {
      geometry.setAttribute(name, new BufferAttribute(array, 3).setUsage(DynamicDrawUsage));
    }
    geometry.setIndex(new BufferAttribute(data.triangle, 1));
    const material = new MeshPhongMaterial({ vertexColors: true, specular: 0x282828, shininess: 30 });
    this.liquid?.colourThrough(material);
    this.surface = new Mesh(geometry, material);
    this.surface.castShadow = this.surface.receiveShadow = true;
    this.surface.frustumCulled = false;
    this.world.add(this.surface);
    this.paintOwn();
  }

  floor() {
    const { floor, size, grid, pattern, dark, background } = this.scene, reach = FLOOR * size;
    const base = new Color(...background[0].map((c) => (c / 255) ** 2.2));
    const material = new MeshLambertMaterial({ color: dark ? base.clone().multiplyScalar(2).addScalar(0.02) : base, transparent: true, premultipliedAlpha: true });
    material.customProgramCacheKey = () => "floor";
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, {
        gridStep: { value: grid }, gridReach: { value: reach }, gridMiddle: { value: new Vector2(this.middle.x, this.middle.y) },
        gridColor: { value: dark ? new Color(0.35, 0.38, 0.42) : new Color(0.42, 0.46, 0.5) },
      });
      shader.vertexShader = "varying vec3 place;\n" + shader.vertexShader.replace("#include <begin_vertex>", "#include <begin_vertex>\nplace = (modelMatrix * vec4(position, 1.0)).xyz;");
      shader.fragmentShader = "varying vec3 place; uniform float gridStep, gridReach; uniform vec2 gridMiddle; uniform vec3 gridColor;\n" +
        shader.fragmentShader.replace("#include <premultiplied_alpha_fragment>", PATTERN[pattern] + FLOOR_COLOR);
    };
    const plane = new Mesh(new PlaneGeometry(2 * reach, 2 * reach), material);
    plane.position.set(this.middle.x, this.middle.y, floor - 1e-4 * size);
    plane.receiveShadow = true;
    plane.renderOrder = -1;
    this.world.add(plane);
  }

  // The colours of the scene: of objects, or of vertices where a mesh file has them.
  paintOwn() {
    const { data: { tint }, objects } = this.scene;
    if (tint) this.paint(null, (i) => tint.subarray(3 * i, 3 * i + 3));
    else this.paint(objects.map(({ color }) => color));
  }

  // Colours [r, g, b] of 0 to 255, one per object; or of vertices, by a function of the vertex.
  paint(colors, ofVertex = null) {
    const { tint, scene } = this, put = (i, [r, g, b]) => {
      tint[3 * i] = (r / 255) ** 2.2; tint[3 * i + 1] = (g / 255) ** 2.2; tint[3 * i + 2] = (b / 255) ** 2.2;
    };
    if (ofVertex) for (let i = 0; i < tint.length / 3; i++) put(i, ofVertex(i));
    else scene.objects.forEach(({ first, count }, k) => { for (let i = first; i < first + count; i++) put(i, colors[k]); });
    this.geometry.attributes.color.needsUpdate = true;
    this.changed = true;
  }

  // Let what is inside of objects be seen through their surfaces.
  seeInside(on) {
    Object.assign(this.surface.material, { transparent: on, opacity: on ? 0.3 : 1, depthWrite: !on, needsUpdate: true });
  }

  show(frame) {
    if (this.followed !== null && this.frame) this.goWith(this.frame.object, frame.object);
    this.frame = frame;
    placeVertices(this.scene.objects, frame, this.at);
    sumNormals(this.scene.data.triangle, this.at, this.normal);
    this.geometry.attributes.position.needsUpdate = this.geometry.attributes.normal.needsUpdate = true;
    if (frame.liquid) this.liquid.show(frame);
    this.extras.show(frame);
    this.renderer.shadowMap.needsUpdate = this.changed = true;
  }

  // --- camera -----------------------------------------------------------------------------------------------------

  seeStart() {
    const { eye, look, up } = this.scene.view;
    this.camera.position.set(...eye);
    this.camera.up.set(...up);
    this.orbit.target.set(...look);
    this.look();
  }

  // Turn to boxes (corner and size) so that all of them are in the picture, from the side from which the camera looks now.
  see(boxes) {
    const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
    for (const [x, y, z, a, b, c] of boxes) { low.min(new Vector3(x, y, z)); high.max(new Vector3(x + a, y + b, z + c)); }
    const middle = low.clone().add(high).multiplyScalar(0.5), back = this.camera.position.clone().sub(this.orbit.target).normalize();
    const half = Math.tan((this.camera.fov * Math.PI) / 360), narrow = half * Math.min(1, this.camera.aspect);
    this.orbit.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(back, (1.1 * 0.5 * high.distanceTo(low)) / Math.sin(Math.atan(narrow)));
    this.look();
  }

  // Whether the camera is turned to a box.
  looksAt([x, y, z, a, b, c]) {
    const at = this.orbit.target;
    return at.x >= x && at.x <= x + a && at.y >= y && at.y <= y + b && at.z >= z && at.z <= z + c;
  }

  // Have the camera go with an object, or with none where it does already; tells which.
  follow(k) {
    return (this.followed = this.followed === null ? k : null);
  }

  goWith(before, now) {
    const [from, to] = [before, now].map((object) => new Vector3().fromArray(object, 12 * this.followed + 6)), way = to.sub(from);
    this.camera.position.add(way);
    this.orbit.target.add(way);
    this.look();
  }

  look() {
    const away = this.camera.position.distanceTo(this.orbit.target), far = 12 * this.scene.size;
    Object.assign(this.camera, { near: Math.max(away, this.scene.size) / 200, far: away + far });
    this.camera.updateProjectionMatrix();
    this.orbit.update();
    this.changed = true;
  }

  // The object below a point of the canvas, in CSS pixels from its upper left corner.
  pick(x, y) {
    if (!this.frame) return null;
    const { origin, way } = this.ray(x, y);
    return pick(origin, way, this.scene, this.frame, this.at);
  }

  // From the camera through a point of the canvas: its origin and direction, and the direction in which the camera looks.
  ray(x, y) {
    const { clientWidth: w, clientHeight: h } = this.renderer.domElement, to = new Vector3((2 * x) / w - 1, 1 - (2 * y) / h, 0.5);
    const way = to.unproject(this.camera).sub(this.camera.position).normalize();
    return { origin: this.camera.position.toArray(), way: way.toArray(), ahead: this.camera.getWorldDirection(new Vector3()).toArray() };
  }

  // --- pictures ---------------------------------------------------------------------------------------------------

  // 0: all there is; 1 and 2: fewer pixels and coarser shadows, for a machine that is slow.
  quality(level) {
    if (level === this.level) return;
    this.level = level;
    const { shadow } = this.sun;
    shadow.mapSize.set(SHADOWS[level], SHADOWS[level]);
    shadow.map?.dispose();
    shadow.map = null;
    this.renderer.shadowMap.needsUpdate = true;
    this.resize();
  }

  resize() {
    const { clientWidth: w, clientHeight: h } = this.renderer.domElement;
    const finer = this.slow && this.level === 0 ? Math.max(1, Math.min(2, Math.sqrt(MOST_PIXELS / (w * h)))) : Math.min(2, devicePixelRatio);
    this.renderer.setPixelRatio(PIXELS[this.level] * finer);
    this.renderer.setSize(w, h, false);
    this.camera.aspect = w / h;
    this.look();
  }

  draw() {
    this.renderer.render(this.world, this.camera);
    this.changed = false;
  }

  // A canvas with the picture in full on its background.
  paper() {
    this.quality(0);
    this.draw();
    const { width, height } = this.renderer.domElement, paper = Object.assign(document.createElement("canvas"), { width, height }), pen = paper.getContext("2d");
    const sky = pen.createLinearGradient(0, 0, 0, height);
    this.scene.background.forEach((color, k) => sky.addColorStop(1 - k, `rgb(${color})`));
    pen.fillStyle = sky;
    pen.fillRect(0, 0, width, height);
    pen.drawImage(this.renderer.domElement, 0, 0);
    return paper;
  }
}
