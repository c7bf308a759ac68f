// SPDX-License-Identifier: GPL-2.0-only
// The 3-D picture: objects, floor, lamp and camera.
import {
  BufferAttribute, BufferGeometry, DirectionalLight, DynamicDrawUsage, HemisphereLight, Mesh, MeshPhongMaterial, OrbitControls,
  PCFShadowMap, PerspectiveCamera, Scene, Vector3, WebGLRenderer,
} from "./vendor.js";
import { Extras } from "./extras.js";
import { Liquid } from "./liquid.js";
import { floorOf, liftLayers, texture } from "./looks.js";
import { pick, placeVertices, sumNormals } from "./message.js";

const SHADOWS = [2048, 1024, 512], PIXELS = [1, 0.7, 0.5]; // by level of quality
export const COARSEST = SHADOWS.length - 1;
const MOST_PIXELS = 4e6; // of a picture at rest that a processor draws

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
    this.orbit.addEventListener("start", () => { this.onPath = false; this.moved = true; });
    this.lights();
    this.liquid = scene.liquid ? new Liquid(this.world, scene) : null;
    this.solids();
    if (scene.floor !== null) this.world.add(floorOf(scene, this.middle));
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
    if (data.material) {
      geometry.setAttribute("material", new BufferAttribute(data.material, 4));
      this.textures = { value: 1 };
      texture(material, this.textures);
    }
    if (data.lift) {
      geometry.setAttribute("lift", new BufferAttribute(data.lift, 1));
      liftLayers(material);
    }
    this.surface = new Mesh(geometry, material);
    this.surface.castShadow = this.surface.receiveShadow = true;
    this.surface.frustumCulled = false;
    this.world.add(this.surface);
    this.paintOwn();
  }

  // The colours of the scene: of objects, or of vertices where a mesh file has them.
  paintOwn() {
    const { data: { tint }, objects } = this.scene;
    if (tint) this.paint(null, (i) => tint.subarray(3 * i, 3 * i + 3), true);
    else this.paint(objects.map(({ color }) => color), null, true);
  }

  // Colours [r, g, b] of 0 to 255, one per object; or of vertices, by a function of the vertex.
  paint(colors, ofVertex = null, own = false) {
    if (this.textures) this.textures.value = Number(own);
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
    if (this.onPath) this.goAlong(frame.frame);
    placeVertices(this.scene.objects, frame, this.at);
    sumNormals(this.scene.data.triangle, this.at, this.normal);
    this.geometry.attributes.position.needsUpdate = this.geometry.attributes.normal.needsUpdate = true;
    if (frame.liquid) this.liquid.show(frame);
    if (this.scene.data.walls) this.extras.walls.position.fromArray(this.scene.data.walls, 3 * frame.frame);
    this.extras.show(frame);
    this.renderer.shadowMap.needsUpdate = this.changed = true;
  }

  // --- camera -----------------------------------------------------------------------------------------------------

  seeStart() {
    const { eye, look, up } = this.scene.view;
    this.camera.position.set(...eye);
    this.camera.up.set(...up);
    this.orbit.target.set(...look);
    this.moved = false; // whether somebody has turned the picture
    this.onPath = Boolean(this.scene.data.path); // whether the camera goes as in the movie
    if (this.onPath && this.frame) this.goAlong(this.frame.frame);
    this.look();
  }

  // The camera of the movie at a frame.
  goAlong(frame) {
    const part = (n) => this.scene.data.path.subarray(9 * frame + 3 * n, 9 * frame + 3 * n + 3);
    this.camera.position.fromArray(part(0));
    this.orbit.target.fromArray(part(1));
    this.camera.up.fromArray(part(2));
    this.look();
  }

  // Where the camera stands: eye, aim and up.
  standpoint() {
    return [this.camera.position, this.orbit.target, this.camera.up].map((point) => point.toArray());
  }

  stand([eye, look, up]) {
    this.camera.position.set(...eye);
    this.orbit.target.set(...look);
    this.camera.up.set(...up);
    this.onPath = false;
    this.moved = true;
    this.look();
  }

  // Turn to boxes (corner and size) so that all of them are in the picture, from the side from which the camera looks now.
  see(boxes) {
    this.onPath = false;
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
    this.onPath = false;
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
    // A picture that is narrower than the movie shows as much from side to side.
    const { fieldOfView, aspect } = this.scene, half = Math.tan((fieldOfView * Math.PI) / 360) * Math.max(1, (aspect * h) / w);
    this.camera.fov = (360 / Math.PI) * Math.atan(half);
    this.liquid?.drops?.seenBy(half);
    this.look();
  }

  draw() {
    this.renderer.render(this.world, this.camera);
    this.changed = false;
  }

  // A canvas with the picture in full on its background, or of a width in pixels.
  paper(width = null) {
    this.quality(0);
    if (width) {
      const { clientWidth: w, clientHeight: h } = this.renderer.domElement;
      this.renderer.setPixelRatio(width / w);
      this.renderer.setSize(w, h, false);
    }
    this.draw();
    const size = { width: this.renderer.domElement.width, height: this.renderer.domElement.height }, paper = Object.assign(document.createElement("canvas"), size), pen = paper.getContext("2d");
    this.sky(pen, 0, size.width, size.height);
    pen.drawImage(this.renderer.domElement, 0, 0);
    return paper;
  }

  // Fill a part of a canvas with the background.
  sky(pen, left, width, height) {
    const sky = pen.createLinearGradient(0, 0, 0, height);
    this.scene.background.forEach((color, k) => sky.addColorStop(1 - k, `rgb(${color})`));
    pen.fillStyle = sky;
    pen.fillRect(left, 0, width, height);
  }
}
