// SPDX-License-Identifier: GPL-2.0-only
import assert from "node:assert/strict";
import test from "node:test";
import { Gif, packed, paletteOf } from "../../python/mdanim_lammps/view/web/gif.js";
import { letsOf, withLet } from "../../python/mdanim_lammps/view/web/lets.js";
import { Overlay, freeHeight } from "../../python/mdanim_lammps/view/web/overlay.js";
import { Quantities, ofMotion, ofVector, roundValue, spanOf, usualScale } from "../../python/mdanim_lammps/view/web/quantities.js";

const TRACK = { time: Float32Array.of(0, 1), centre: Float32Array.of(1, 2, 3, 4, 5, 6), velocity: Float32Array.of(3, 0, 4, 0, 0, -2) };

test("a way tells places, velocities and speed", () => {
  assert.deepEqual([...ofMotion("position.y", TRACK)], [2, 5]);
  assert.deepEqual([...ofMotion("velocity.z", TRACK)], [4, -2]);
  assert.deepEqual([...ofMotion("speed", TRACK)], [5, 2]);
});

test("vectors of all objects tell those of one", () => {
  const rows = Float32Array.of(1, 2, 3, 3, 0, 4, 5, 6, 7, 0, 0, 1);
  assert.deepEqual([...ofVector("contact", "contact", rows, 1, 2)], [5, 1]);
  assert.deepEqual([...ofVector("contact.z", "contact", rows, 0, 2)], [3, 7]);
  assert.equal(ofVector("weight.z", "contact", rows, 0, 2), null);
});

test("arrows are as long as shows well", () => {
  const rows = Float32Array.from([...Array(99).fill([2, 0, 0]).flat(), 100, 0, 0, NaN, 0, 0, 1e-12, 0, 0]); // a blow, nothing known, rounding
  assert.ok(Math.abs(usualScale([rows], 10) - (0.14 * 10) / 2) < 1e-12);
  assert.equal(usualScale([new Float32Array(3)], 10), 1);
  assert.deepEqual([0.7, 2, 49.999, 50, 0].map(roundValue), [0.5, 2, 20, 50, 1]);
});

test("arrows of one object are as long as show its own well", () => {
  const vectors = Float32Array.of(0, 0, -5000, 0, 0, -10, 0, 0, -5000, 0, 0, -10), objects = [{ still: true }, { still: false }];
  const overlay = new Overlay({ objects, size: 10, bounds: [[0, 0, 0], [1, 1, 1]] });
  const scale = (objects) => { overlay.show([{ word: "weight", vectors, objects, scale: null }]); return overlay.arrows[0].scale; };
  for (const [objects, most] of [[[1], 10], [null, 10], [[0], 5000], [[0, 1], 5000]]) assert.ok(Math.abs(scale(objects) * most - 1.4) < 1e-9, `${objects}`);
  assert.equal(overlay.arrows[0].most, 5000);
});

test("an object in pieces has its words once, beside those near their middle", () => {
  const box = (x) => [x, 0, 0, 1, 1, 1, x + 0.5, 0.5, 0.5, 0, 0, 0], written = [];
  const overlay = Object.assign(new Overlay({ objects: [], bounds: [[0, 0, 0], [1, 1, 1]] }), { letters: 10, width: 999, at: (x, y, z) => [x, y + z], write: (...all) => written.push(all) });
  for (const places of [[0, 1, 2], [0, 1, 50]]) overlay.label(0, [0, 1, 2], "vase", { object: Float32Array.from(places.flatMap(box)) });
  assert.deepEqual(written.map(([text, x]) => [text, x]), [["vase", 3 + 4], ["vase", 2 + 4]]);
});

test("words that would cover others stand above or below them", () => {
  assert.equal(freeHeight(5, 0, 10, [[11, 20, 5]], 2), 5);
  assert.equal(freeHeight(5, 0, 10, [[4, 20, 6]], 2), 4);
  assert.equal(freeHeight(5, 0, 10, [[4, 20, 6], [0, 3, 4.5]], 2), 2.5);
  assert.equal(freeHeight(5, 0, 10, [...Array(9).keys()].map((k) => [0, 9, 2 * k]), 2), 5);
});

test("what is as good as constant is a straight line", () => {
  const near = (found, ends) => found.forEach((x, k) => assert.ok(Math.abs(x - ends[k]) < 1e-9, `${found} is not ${ends}`));
  near(spanOf(18.56469, 18.56471, "N"), [-0.08 * 18.56471, 1.08 * 18.56471]);
  near(spanOf(2, 2, "m"), [2 - 0.0116, 2 + 0.0116]);
  near(spanOf(1, 2, "m"), [0.92, 2.08]);
  near(spanOf(-2, -1, "J"), [-2.16, 0.16]);
  near(spanOf(null, null, "J"), [-0.08, 1.08]);
  near(spanOf(0, 0, "J"), [-0.58, 0.58]);
});

test("a quantity is the way's, the scene's, or what the run tells once it has frames", async () => {
  const asked = [], source = { track: async (k) => { asked.push(k); return TRACK; }, curve: async (named) => ({ what: named }), told: async () => { throw new Error("no frame yet"); } };
  const q = new Quantities(source, { objects: [{ name: "a" }, { name: "a.b" }] });
  assert.equal(await q.look(), false);
  assert.deepEqual([...(await q.curve("a.b.speed")).value], [5, 2]);
  assert.deepEqual(asked, [1]);
  await assert.rejects(q.curve("a.contact.z"), /no frame yet/);
  source.told = async () => ({ own: { "a.distance(a.b)": "m" }, words: { "contact.z": "N" }, globals: { "energy.work": "J" }, arrows: ["contact", "velocity"] });
  assert.equal(await q.look(), true);
  assert.deepEqual(q.arrows, ["velocity", "contact"]);
  assert.deepEqual((await q.curve("a.contact.z")).what, ["a", "contact.z"]);
  assert.deepEqual((await q.curve("energy.work")).what, ["energy", "work"]);
  assert.equal((await q.curve("a.distance(a.b)")).what, "a.distance(a.b)");
  await assert.rejects(q.curve("c.contact.z"), /does not tell/);
});

test("numbers with a name have sliders", () => {
  const text = "let a = 20 deg # 3\n let n=8\nlet up = (1, 2, 3)\nlet w = { density 3 }\nlet b = a*2\nlet k = -3.5 kPa\nlet z = 0\nlet g = 2 m/s^2\nlet t = 1.5 s + 2 s";
  assert.deepEqual(letsOf(text).map(({ line, name, value, unit, low, high, step }) => [line, name, value, unit, low, high, step]),
    [[0, "a", 20, "deg", 0, 40, 1], [1, "n", 8, "", 0, 16, 1], [5, "k", -3.5, "kPa", -7, 0, 0.01], [6, "z", 0, "", -1, 1, 0.01], [7, "g", 2, "m/s^2", 0, 4, 1]]);
  assert.equal(withLet(text, 5, -0.30000000000000004).split("\n")[5], "let k = -0.3 kPa");
  assert.equal(withLet(text, 0, 25).split("\n")[0], "let a = 25 deg # 3");
});

// The numbers of LZW as a decoder of GIFs reads them.
function unpacked(bytes) {
  const data = [], out = [];
  for (let at = 0; at < bytes.length; at += bytes[at] + 1) data.push(...bytes.subarray(at + 1, at + 1 + bytes[at]));
  let bits = 9, held = 0, filled = 0, at = 0, table = [], before = null;
  const clear = () => { table = Array.from({ length: 258 }, (_, k) => [k]); bits = 9; before = null; };
  for (;;) {
    while (filled < bits) { held |= data[at++] << filled; filled += 8; }
    const code = held & ((1 << bits) - 1);
    held >>>= bits;
    filled -= bits;
    if (code === 257) return out;
    if (code === 256) { clear(); continue; }
    const found = table[code] ?? [...before, before[0]];
    out.push(...found);
    if (before && table.length < 4096) table.push([...before, found[0]]);
    if (table.length === 1 << bits && bits < 12) bits++;
    before = found;
  }
}

test("what is packed can be read", () => {
  let seed = 1;
  const noise = Uint8Array.from({ length: 30000 }, () => ((seed = (seed * 48271) % 2147483647) >> 7) & 255), flat = new Uint8Array(20000).fill(7);
  for (const numbers of [noise, flat, Uint8Array.of(5)]) assert.deepEqual(unpacked(packed(numbers)), [...numbers]);
});

test("a GIF has the colours of its pictures, and only what changes", () => {
  const picture = (x) => Uint8ClampedArray.from([...Array(16).keys()].flatMap((k) => (k === x ? [250, 10, 10, 255] : [10, 200, 90, 255])));
  const pictures = [picture(3), picture(9)], palette = paletteOf(pictures), gif = new Gif(4, 4, palette);
  assert.deepEqual([...palette].sort((a, b) => a - b), [10, 10, 10, 90, 200, 250]);
  for (const one of pictures) gif.add(one, 5);
  const bytes = gif.bytes, data = (at) => unpacked(bytes.subarray(at, bytes.indexOf(0, at + bytes[at] + 1) + 1).subarray(0, bytes[at] + 1));
  assert.equal(new TextDecoder().decode(bytes.subarray(0, 6)), "GIF89a");
  const starts = [...bytes.keys()].filter((k) => bytes[k] === 0x2c && bytes[k + 9] === 0 && bytes[k + 10] === 8).map((k) => k + 11);
  assert.deepEqual(data(starts[1]).map((n) => n === 255), [...Array(16).keys()].map((k) => k !== 3 && k !== 9));
});
