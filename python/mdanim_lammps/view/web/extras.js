// SPDX-License-Identifier: GPL-2.0-only
// Drawings beside the objects: boxes of objects and walls, particles, springs, and what features add, as joints and strings.
import {
  Box3, BufferAttribute, BufferGeometry, DynamicDrawUsage, LineBasicMaterial, LineSegments, Mesh, MeshPhongMaterial, Points,
  PointsMaterial, Vector3,
} from "./vendor.js";
import { sumNormals } from "./message.js";

const EDGES = [0, 1, 1, 3, 3, 2, 2, 0, 4, 5, 5, 7, 7, 6, 6, 4, 0, 4, 1, 5, 2, 6, 3, 7];

export class Extras {
  constructor(world, scene) {
    const ink = scene.dark ? 0xc8d2da : 0x44525e, soft = scene.dark ? 0x8fa0ad : 0x7f93a3, O = scene.objects.length;
    const index = Uint32Array.from({ length: 24 * O }, (_, i) => 8 * Math.floor(i / 24) + EDGES[i % 24]);
    this.boxes = lines(new Float32Array(24 * O), index, new LineBasicMaterial({ color: ink }));
    this.picked = null; // object whose box is drawn alone
    this.mark = lines(new Float32Array(24), new Uint32Array(EDGES), new LineBasicMaterial({ color: ink }));
    this.spots = new Float32Array(3 * scene.particles);
    this.springs = lines(this.spots, new Uint32Array(0), new LineBasicMaterial({ color: ink, transparent: true, opacity: 0.35 }));
    const cloud = new BufferGeometry().setAttribute("position", this.springs.geometry.attributes.position);
    this.particles = new Points(cloud, new PointsMaterial({ size: 4, sizeAttenuation: false, color: scene.dark ? 0xe8eef2 : 0x20384a }));
    for (const part of [this.boxes, this.mark, this.springs, this.particles]) {
      part.visible = part.frustumCulled = false;
      world.add(part);
    }
    const thread = { color: 0xd9480f, depthTest: false, transparent: true };
    this.hand = lines(new Float32Array(6), new Uint32Array([0, 1]), new LineBasicMaterial(thread));
    const ends = new BufferGeometry().setAttribute("position", this.hand.geometry.attributes.position);
    this.hand.add(new Points(ends, new PointsMaterial({ ...thread, size: 8, sizeAttenuation: false })));
    for (const part of [this.hand, ...this.hand.children]) Object.assign(part, { frustumCulled: false, renderOrder: 1 });
    this.hand.visible = false;
    world.add(this.hand);
    if (scene.added) this.add(world, scene);
    this.walls = box(scene.walls, soft);
    if (this.walls) world.add(this.walls);
  }

  add(world, { data, added }) {
    const geometry = (index) => new BufferGeometry().setAttribute("position", this.place).setAttribute("color", color).setIndex(new BufferAttribute(index, 1));
    this.place = new BufferAttribute(new Float32Array(3 * added), 3).setUsage(DynamicDrawUsage);
    const color = new BufferAttribute(Float32Array.from(data["added color"], (c) => (c / 255) ** 2.2), 3);
    this.added = new Mesh(geometry(data["added triangle"]).setAttribute("normal", new BufferAttribute(new Float32Array(3 * added), 3).setUsage(DynamicDrawUsage)), new MeshPhongMaterial({ vertexColors: true }));
    this.added.castShadow = this.added.receiveShadow = true;
    for (const part of [this.added, new LineSegments(geometry(data["added line"]), new LineBasicMaterial({ vertexColors: true }))]) {
      part.frustumCulled = false;
      world.add(part);
    }
  }

  show(frame) {
    if (frame.added && this.added) {
      this.place.array.set(frame.added);
      const { normal } = this.added.geometry.attributes;
      sumNormals(this.added.geometry.index.array, this.place.array, normal.array);
      this.place.needsUpdate = normal.needsUpdate = true;
    }
    if (this.boxes.visible) placeBoxes(this.boxes, frame.object);
    this.mark.visible = this.picked !== null;
    if (this.picked !== null) placeBoxes(this.mark, frame.object.subarray(12 * this.picked, 12 * this.picked + 12));
    if (frame.particles) {
      this.spots.set(frame.particles);
      this.springs.geometry.attributes.position.needsUpdate = true;
    }
  }

  // A line between two points, or none.
  pull(from, to) {
    this.hand.visible = Boolean(from);
    if (!from) return;
    this.hand.geometry.attributes.position.array.set([...from, ...to]);
    this.hand.geometry.attributes.position.needsUpdate = true;
  }

  join(bond) {
    this.springs.geometry.setIndex(new BufferAttribute(bond, 1));
  }
}

// Move the edges of boxes to those of objects (corner and size).
function placeBoxes(part, object) {
  const { position } = part.geometry.attributes;
  for (let k = 0, at = 0; k < object.length; k += 12) {
    for (let c = 0; c < 8; c++) for (let d = 0; d < 3; d++) position.array[at++] = object[k + d] + ((c >> d) & 1) * object[k + 3 + d];
  }
  position.needsUpdate = true;
}

function lines(points, index, material) {
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(points, 3).setUsage(DynamicDrawUsage));
  return new LineSegments(geometry.setIndex(new BufferAttribute(index, 1)), material);
}

// The edges of a box, or null where there is none.
export function box(corners, color) {
  if (!corners) return null;
  const { min, max } = new Box3(new Vector3(...corners[0]), new Vector3(...corners[1]));
  const points = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((c) => [c & 1 ? max.x : min.x, c & 2 ? max.y : min.y, c & 4 ? max.z : min.z]);
  return lines(new Float32Array(points), new Uint32Array(EDGES), new LineBasicMaterial({ color }));
}
