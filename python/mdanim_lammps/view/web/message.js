// SPDX-License-Identifier: GPL-2.0-only
// Messages of the server (feed.py) and what is computed from them; nothing here touches the page or WebGL.

export const STRAIN = 1, PARTICLES = 2, ADDED = 4; // layers of a frame
export const DRY = 2; // state of a column of liquid
export const stateOf = (column) => column & 3, foamOf = (column) => (column >> 2) / 63;
const ARRAYS = { u1: Uint8Array, u2: Uint16Array, u4: Uint32Array, f4: Float32Array, f8: Float64Array };
const padded = (bytes) => bytes + ((4 - (bytes % 4)) % 4);
const kind = (buffer) => String.fromCharCode(...new Uint8Array(buffer, 0, 4));

// The header of a scene, with its arrays under "data".
export function readScene(buffer) {
  if (kind(buffer) !== "MDS1") throw new Error("not a scene");
  const size = new DataView(buffer).getUint32(4, true), data = {};
  const { buffers, ...head } = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, size)));
  for (const [name, [type, at, count]] of Object.entries(buffers)) data[name] = new ARRAYS[type](buffer, 8 + size + at, count);
  return { ...head, data };
}

// "added": how many points features add to the scene.
export function readFrame(buffer, added = 0) {
  if (kind(buffer) !== "MDF1") throw new Error("not a frame");
  const head = new DataView(buffer), [layers, V, O, C, D] = [16, 20, 24, 28, 32].map((at) => head.getUint32(at, true));
  const frame = { frame: head.getUint32(4, true), time: head.getFloat64(8, true), layers, bytes: buffer.byteLength };
  let at = 36;
  const next = (type, count) => {
    const array = new type(buffer, at, count);
    at += padded(array.byteLength);
    return array;
  };
  frame.object = next(Float32Array, 12 * O);
  frame.position = next(Uint16Array, 3 * V);
  if (C) [frame.liquid, frame.columns] = [next(Uint16Array, C), next(Uint8Array, C)];
  if (D) frame.drops = next(Float32Array, 4 * D);
  if (layers & STRAIN) frame.strain = next(Uint8Array, V);
  if (layers & ADDED) frame.added = next(Float32Array, 3 * added);
  if (layers & PARTICLES) frame.particles = next(Float32Array, (buffer.byteLength - at) / 4);
  return frame;
}

// Vertices of all objects in metres, into "at".
export function placeVertices(objects, frame, at) {
  const q = frame.position, box = frame.object;
  objects.forEach(({ first, count }, k) => {
    const b = 12 * k, [x, y, z] = [box[b], box[b + 1], box[b + 2]];
    const sx = box[b + 3] / 65535, sy = box[b + 4] / 65535, sz = box[b + 5] / 65535;
    for (let i = 3 * first, end = i + 3 * count; i < end; i += 3) {
      at[i] = x + sx * q[i];
      at[i + 1] = y + sy * q[i + 1];
      at[i + 2] = z + sz * q[i + 2];
    }
  });
}

// Sums of the area vectors of the triangles at each vertex, into "normal": their length does not matter.
export function sumNormals(triangle, at, normal) {
  normal.fill(0);
  for (let t = 0; t < triangle.length; t += 3) {
    const a = 3 * triangle[t], b = 3 * triangle[t + 1], c = 3 * triangle[t + 2];
    const ux = at[b] - at[a], uy = at[b + 1] - at[a + 1], uz = at[b + 2] - at[a + 2];
    const vx = at[c] - at[a], vy = at[c + 1] - at[a + 1], vz = at[c + 2] - at[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    normal[a] += x; normal[a + 1] += y; normal[a + 2] += z;
    normal[b] += x; normal[b + 1] += y; normal[b + 2] += z;
    normal[c] += x; normal[c + 1] += y; normal[c + 2] += z;
  }
}

// The first object that a ray meets, how far away, and three vertices with weights whose mean is the point; or null. Only triangles of objects whose box it meets are looked at.
export function pick(origin, direction, scene, frame, at) {
  const [ox, oy, oz] = origin, [dx, dy, dz] = direction, { triangle, object } = scene.data;
  const met = scene.objects.map((_, k) => meetsBox(origin, direction, frame.object, 12 * k));
  let nearest = Infinity, found = null;
  if (!met.includes(true)) return null;
  for (let t = 0; t < triangle.length; t += 3) {
    if (!met[object[triangle[t]]]) continue;
    const a = 3 * triangle[t], b = 3 * triangle[t + 1], c = 3 * triangle[t + 2];
    const ux = at[b] - at[a], uy = at[b + 1] - at[a + 1], uz = at[b + 2] - at[a + 2];
    const vx = at[c] - at[a], vy = at[c + 1] - at[a + 1], vz = at[c + 2] - at[a + 2];
    const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
    const det = ux * px + uy * py + uz * pz;
    if (det <= 0) continue; // seen from inside, or edge on
    const sx = ox - at[a], sy = oy - at[a + 1], sz = oz - at[a + 2], u = (sx * px + sy * py + sz * pz) / det;
    if (u < 0 || u > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux, v = (dx * qx + dy * qy + dz * qz) / det;
    const away = (vx * qx + vy * qy + vz * qz) / det;
    if (v >= 0 && u + v <= 1 && away > 0 && away < nearest) [nearest, found] = [away, { t, weight: [1 - u - v, u, v] }];
  }
  if (found === null) return null;
  const vertex = [...triangle.subarray(found.t, found.t + 3)];
  return { object: object[vertex[0]], away: nearest, vertex, weight: found.weight };
}

function meetsBox(origin, direction, box, b) {
  let enter = 0, leave = Infinity;
  for (let k = 0; k < 3; k++) {
    const low = (box[b + k] - origin[k]) / direction[k], high = (box[b + k] + box[b + 3 + k] - origin[k]) / direction[k];
    if (Number.isNaN(low) || Number.isNaN(high)) continue; // along a face
    enter = Math.max(enter, Math.min(low, high));
    leave = Math.min(leave, Math.max(low, high));
  }
  return enter <= leave;
}

// Executor of each object at a frame, -1 for none, from changes [frame, object, executor] in order.
export function ownersAt(changes, frame, objects) {
  const owner = new Int32Array(objects).fill(-1);
  for (const [when, object, executor] of changes) {
    if (when > frame) break;
    owner[object] = executor;
  }
  return owner;
}

// The reverse of export.py for whole numbers: rows of differences to the row before, low bytes first, then high ones.
export function undoDifferences(bytes, row, rows) {
  const count = row * rows, out = new Uint16Array(count);
  for (let i = 0; i < count; i++) out[i] = (bytes[i] | (bytes[count + i] << 8)) + (i >= row ? out[i - row] : 0);
  return out;
}

// A frame of a report as the server would send it: places are whole numbers up to "steps" in one box of each object, which goes
// with its centre of mass ("boxes": corner and size, "moving": centre and velocity); they become those within the box of this frame.
export function inOwnBoxes(objects, places, steps, boxes, moving) {
  const object = new Float32Array(12 * objects.length), position = new Uint16Array(places.length);
  objects.forEach(({ first, count }, k) => {
    for (let d = 0; d < 3; d++) {
      let low = steps, high = 0;
      const from = 3 * first + d, end = 3 * (first + count);
      for (let i = from; i < end; i += 3) { low = Math.min(low, places[i]); high = Math.max(high, places[i]); }
      const scale = high > low ? 65535 / (high - low) : 0, unit = boxes[6 * k + 3 + d] / steps;
      for (let i = from; i < end; i += 3) position[i] = Math.round((places[i] - low) * scale);
      object[12 * k + d] = moving[6 * k + d] + boxes[6 * k + d] + low * unit;
      object[12 * k + 3 + d] = (high - low) * unit;
    }
    object.set(moving.subarray(6 * k, 6 * k + 6), 12 * k + 6);
  });
  return { object, position };
}

// The value that all but two per cent of some bytes do not exceed: a few corners do not set the scale of a picture.
export function nearlyMost(bytes) {
  const count = new Uint32Array(256);
  for (const value of bytes) count[value]++;
  let value = 255;
  for (let above = count[255]; above <= 0.02 * bytes.length && value > 0; above += count[value]) value--;
  return value;
}

// A number for people: so many digits that count, no exponent where it can be helped.
export function number(value, digits = 3) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size < 1e-3 || size >= 1e6 ? value.toExponential(digits - 1) : String(+value.toPrecision(digits));
}

// The camera in the language of scenes.
export function cameraLine(time, eye, look) {
  const point = (p) => `(${[...p].map((x) => +x.toFixed(4)).join(", ")}) m`;
  return `camera ${+time.toFixed(4)} s from ${point(eye)} look ${typeof look === "string" ? look : point(look)}`;
}

// Energies whose zero is arbitrary are drawn as their change: the weight of held bodies would flatten all other curves.
export const RELATIVE = ["gravity", "buoyancy"];
export function drawn(names, rows) {
  const zero = names.map((name, k) => (rows.length && RELATIVE.includes(name) ? rows[0][k + 1] : 0));
  return [rows.map((row) => row[0]), ...names.map((_, k) => rows.map((row) => row[k + 1] - zero[k]))];
}
