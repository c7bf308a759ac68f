// SPDX-License-Identifier: GPL-2.0-only
// Quantities of a run: what can be asked for, curves over time, vectors for arrows. Nothing here touches the page.

const AXES = ["x", "y", "z"];
// Quantities that the way of an object's centre tells, also while the run goes on; units by word.
export const MOTION = { speed: "m/s", ...Object.fromEntries(AXES.flatMap((a) => [[`position.${a}`, "m"], [`velocity.${a}`, "m/s"]])) };
export const ARROW_UNITS = { velocity: "m/s", spin: "rad/s" }; // of all other arrows: N
const USUAL = 0.14, AMONG = 0.95; // length of an arrow over the size of the scene, that of the value that this share of all values does not exceed
const ROOM = 0.08, LEAST = 0.01; // room above and below curves over their span; span of an axis over the largest value at it, at least
const NOTHING = 1e-9; // values below this share of the largest have no part in that

export const median = (values) => { const some = [...values].sort((a, b) => a - b), half = some.length >> 1; return some.length % 2 ? some[half] : (some[half - 1] + some[half]) / 2; };
const norm = (v, at = 0) => Math.hypot(v[at], v[at + 1], v[at + 2]);

// Values of a word of MOTION from the places and velocities of a track.
export function ofMotion(word, { centre, velocity }) {
  const [name, axis] = word.split("."), rows = name === "position" ? centre : velocity;
  return Float64Array.from({ length: rows.length / 3 }, (_, n) => (axis ? rows[3 * n + AXES.indexOf(axis)] : norm(rows, 3 * n)));
}

// "contact", "contact.x" from the vectors of object k of O, by frame; null where the word is not of this vector.
export function ofVector(word, name, vectors, k, O) {
  if (word !== name && !AXES.some((axis) => word === `${name}.${axis}`)) return null;
  const axis = AXES.indexOf(word.slice(name.length + 1));
  return Float64Array.from({ length: vectors.length / (3 * O) }, (_, f) => (axis < 0 ? norm(vectors, 3 * (O * f + k)) : vectors[3 * (O * f + k) + axis]));
}

// The vectors of some of O objects, by frame.
export function rowsOf(vectors, objects, O) {
  const frames = vectors.length / (3 * O), rows = new Float32Array(3 * objects.length * frames);
  for (let f = 0; f < frames; f++) objects.forEach((k, n) => rows.set(vectors.subarray(3 * (O * f + k), 3 * (O * f + k) + 3), 3 * (objects.length * f + n)));
  return rows;
}

// The least value that a share of some values does not exceed; NaN and what is next to nothing are left out.
export function usual(sizes, share = AMONG) {
  const found = Float64Array.from(sizes).filter(Number.isFinite), most = found.reduce((a, b) => Math.max(a, b), 0);
  const some = found.filter((x) => x > NOTHING * most).sort();
  return some.length ? some[Math.min(some.length - 1, Math.floor(share * some.length))] : 0;
}

// Metres per unit that show vectors well: rows of three, several arrays of them.
export function usualScale(vectors, size) {
  const sizes = vectors.flatMap((rows) => Array.from({ length: rows.length / 3 }, (_, n) => norm(rows, 3 * n))), most = usual(sizes);
  return most ? (USUAL * size) / most : 1;
}

// The largest of 1, 2, 5 times a power of ten that is not above a value.
export function roundValue(value) {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [5, 2, 1].find((k) => k * power <= value * (1 + 1e-12));
}

// The ends of an axis for values of a unit, as picture/plot.py has them; without values from 0 to 1.
export function spanOf(low, high, unit) {
  let [least, most] = [low ?? 0, high ?? 1];
  if (unit !== "m") [least, most] = [Math.min(least, 0), Math.max(most, 0)];
  const span = LEAST * Math.max(Math.abs(least), Math.abs(most)) || 1, more = 0.5 * Math.max(0, span - (most - least)), room = ROOM * Math.max(most - least, span);
  return [least - more - room, most + more + room];
}

// Quantities that a page may show of a run; while it goes on ("live") those of the frames that there are.
export class Quantities {
  constructor(source, scene) {
    Object.assign(this, { source, scene, own: {}, words: {}, globals: {}, arrows: ["velocity"], untold: {}, known: false, live: false, why: "", vectors: new Map() });
  }

  // Ask what there is; tells whether anything was told: not before the first frame.
  async look() {
    const told = await this.source.told().catch((error) => { this.why = error.message; return null; });
    this.known = told !== null;
    if (told) Object.assign(this, told, { arrows: ["velocity", ...told.arrows.filter((word) => word !== "velocity")] });
    this.words = { ...MOTION, ...this.words };
    return this.known;
  }

  number(name) {
    return this.scene.objects.findIndex((object) => object.name === name);
  }

  // The parts of "ball.contact.z": a subject and a word, or null where it is the scene's own.
  parts(what) {
    const of = this.scene.objects.map(({ name }) => name).filter((name) => what.startsWith(`${name}.`)).sort((a, b) => b.length - a.length)[0];
    if (of) return [of, what.slice(of.length + 1)];
    return what in this.globals ? [what.slice(0, what.indexOf(".")), what.slice(what.indexOf(".") + 1)] : null;
  }

  // A curve by its name; rejects with a reason where there is none.
  async curve(what) {
    const parts = this.parts(what);
    if (parts && parts[1] in MOTION) {
      const track = await this.source.track(this.number(parts[0]));
      return { what, unit: MOTION[parts[1]], mean: false, time: track.time, value: ofMotion(parts[1], track) };
    }
    if (what in this.own) return this.source.curve(what);
    if (!this.known) throw new Error(this.why);
    if (!parts) throw new Error(`the run does not tell ${what}`);
    return this.source.curve(parts);
  }

  // Vectors are asked for again: there are more frames.
  forget() {
    this.vectors.clear();
  }

  // Vectors of all objects at all frames, or null: of velocity they are those of each frame.
  async vectorsOf(word) {
    if (!this.vectors.has(word)) this.vectors.set(word, await this.source.arrows(word).catch(() => null));
    return this.vectors.get(word);
  }
}
