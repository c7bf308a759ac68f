// SPDX-License-Identifier: GPL-2.0-only
import assert from "node:assert/strict";
import test from "node:test";
import * as m from "../../python/mdanim_lammps/view/web/message.js";

const STATIC = { // a box of two triangles in z = 0 (object 0) and one triangle in z = 1 (object 1)
  objects: [{ first: 0, count: 4 }, { first: 4, count: 3 }],
  data: { triangle: Uint32Array.of(0, 1, 2, 0, 2, 3, 4, 5, 6), object: Uint32Array.of(0, 0, 0, 0, 1, 1, 1) },
};
const FRAME = {
  object: Float32Array.of(0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0),
  position: Uint16Array.from([0, 0, 0, 65535, 0, 0, 65535, 65535, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0, 0, 65535, 0]),
};
const placed = () => {
  const at = new Float32Array(21);
  m.placeVertices(STATIC.objects, FRAME, at);
  return at;
};

function message(kind, head, parts) {
  const bytes = new Uint8Array(head.length + parts.reduce((sum, p) => sum + Math.ceil(p.byteLength / 4) * 4, 4));
  bytes.set(new TextEncoder().encode(kind));
  bytes.set(head, 4);
  let at = 4 + head.length;
  for (const part of parts) {
    bytes.set(new Uint8Array(part.buffer), at);
    at += Math.ceil(part.byteLength / 4) * 4;
  }
  return bytes.buffer;
}

test("a scene has its arrays", () => {
  const head = JSON.stringify({ title: "ü", buffers: { a: ["u1", 0, 3], b: ["f4", 4, 2] } }), text = new TextEncoder().encode(head);
  const padded = new Uint8Array(Math.ceil(text.length / 4) * 4).fill(32);
  padded.set(text);
  const scene = m.readScene(message("MDS1", new Uint8Array([...new Uint8Array(Uint32Array.of(padded.length).buffer), ...padded]), [Uint8Array.of(1, 2, 3), Float32Array.of(0.5, -2)]));
  assert.equal(scene.title, "ü");
  assert.deepEqual([...scene.data.a], [1, 2, 3]);
  assert.deepEqual([...scene.data.b], [0.5, -2]);
  assert.throws(() => m.readScene(message("MDF1", new Uint8Array(8), [])), /not a scene/);
});

test("a frame has all layers at their places", () => {
  const head = new DataView(new ArrayBuffer(32));
  [5, , , m.STRAIN | m.PARTICLES, 3, 1, 2, 2].forEach((value, k) => value !== undefined && head.setUint32(4 * k, value, true));
  head.setFloat64(4, 1.25, true);
  const parts = [new Float32Array(12).fill(7), Uint16Array.from({ length: 9 }, (_, k) => k), Uint16Array.of(1000, 2000), Uint8Array.of(0, 2), Float32Array.of(1, 2, 3, 0.5, 4, 5, 6, 0.25), Uint8Array.of(9, 8, 7), Float32Array.of(1, 2, 3)];
  const f = m.readFrame(message("MDF1", new Uint8Array(head.buffer), parts));
  assert.deepEqual([f.frame, f.time, f.layers], [5, 1.25, 3]);
  assert.deepEqual([f.object, f.position, f.liquid, f.columns, f.drops, f.strain, f.particles].map((a) => [...a]), parts.map((a) => [...a]));
});

test("a column has a state and foam", () => {
  for (const [byte, state, foam] of [[0, 0, 0], [m.DRY, m.DRY, 0], [252, 0, 1], [85, 1, 1 / 3]]) {
    assert.equal(m.stateOf(byte), state);
    assert.equal(m.foamOf(byte), foam);
  }
});

test("vertices lie within the box of their object", () => {
  assert.deepEqual([...placed()], [0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0, 1, 0, 1, 2, 0, 1, 1, 1, 1]);
});

test("normals are sums of area vectors", () => {
  const normal = new Float32Array(21).fill(9);
  m.sumNormals(STATIC.data.triangle, placed(), normal);
  assert.deepEqual([...normal.slice(0, 3)], [0, 0, 4]); // two triangles, each twice its area of 1
  assert.deepEqual([...normal.slice(3, 6)], [0, 0, 2]);
  assert.deepEqual([...normal.slice(12, 15)], [0, 0, 1]);
});

test("a ray picks the nearest object that faces it", () => {
  const pick = (x, y, z, dz) => m.pick([x, y, z], [1e-9, 0, dz], STATIC, FRAME, placed());
  const seen = (found) => found && { object: found.object, away: found.away };
  assert.deepEqual(seen(pick(1.2, 0.2, 3, -1)), { object: 1, away: 2 });
  assert.deepEqual(seen(pick(0.5, 0.5, 3, -1)), { object: 0, away: 3 });
  assert.equal(pick(5, 0.5, 3, -1), null); // beside everything
  assert.equal(pick(0.5, 0.5, 3, 1), null); // away from everything
  assert.equal(pick(0.5, 0.5, -3, 1), null); // from behind
  assert.deepEqual(seen(pick(1.9, 0.9, 3, -1)), { object: 0, away: 3 }); // in the box of object 1, beside its triangle
});

test("owners follow their changes", () => {
  const changes = [[0, 0, 1], [0, 1, 0], [4, 0, 0]];
  assert.deepEqual([...m.ownersAt(changes, 3, 3)], [1, 0, -1]);
  assert.deepEqual([...m.ownersAt(changes, 4, 3)], [0, 0, -1]);
});

test("differences are undone, also across 16 bits", () => {
  const rows = [[5, 65535], [4, 2], [4, 300]], count = 6, bytes = new Uint8Array(2 * count);
  rows.forEach((row, f) => row.forEach((value, k) => {
    const d = (value - (f ? rows[f - 1][k] : 0)) & 0xffff;
    bytes[2 * f + k] = d & 255;
    bytes[count + 2 * f + k] = d >> 8;
  }));
  assert.deepEqual([...m.undoDifferences(bytes, 2, 3)], rows.flat());
});

test("places in a box that goes with the object become those in the box of the frame", () => {
  const objects = [{ first: 0, count: 2 }, { first: 2, count: 1 }], boxes = Float32Array.of(-1, -1, 0, 2, 4, 0, 0, 0, 0, 1, 1, 1);
  const places = Uint16Array.of(1000, 0, 0, 3000, 2000, 0, 4000, 4000, 4000), moving = Float32Array.of(10, 20, 30, 1, 2, 3, 0, 0, 5, 0, 0, 0);
  const found = m.inOwnBoxes(objects, places, 4000, boxes, moving);
  assert.deepEqual([...found.object.slice(0, 12)], [9.5, 19, 30, 1, 2, 0, 10, 20, 30, 1, 2, 3]);
  assert.deepEqual([...found.object.slice(12, 18)], [1, 1, 6, 0, 0, 0]);
  assert.deepEqual([...found.position], [0, 0, 0, 65535, 65535, 0, 0, 0, 0]);
});

test("a few outliers do not set a scale", () => {
  assert.equal(m.nearlyMost(Uint8Array.from({ length: 100 }, (_, k) => (k < 2 ? 250 : k < 5 ? 90 : 10))), 90);
  assert.equal(m.nearlyMost(new Uint8Array(50)), 0);
});

test("numbers are for people", () => {
  assert.deepEqual([0, 1234.5, 0.01234, 1.5e-7, 3e8, null, NaN].map((x) => m.number(x)), ["0", "1230", "0.0123", "1.50e-7", "3.00e+8", "–", "–"]);
});

test("the camera is a line of the scene language", () => {
  assert.equal(m.cameraLine(1.43333, [1, -2.00001, 0.5], [0, 0, 1]), "camera 1.4333 s from (1, -2, 0.5) m look (0, 0, 1) m");
  assert.equal(m.cameraLine(0, [1, 2, 3], "ball"), "camera 0 s from (1, 2, 3) m look ball");
});

test("energies whose zero is arbitrary are drawn as their change, others as they are", () => {
  const rows = [[0, 1e6, 2, 0], [0.1, 1e6 - 3, 5, 0]];
  assert.deepEqual(m.drawn(["gravity", "kinetic"], rows), [[0, 0.1], [0, -3], [2, 5]]);
  assert.deepEqual(m.drawn(["gravity"], []), [[], []]);
});
