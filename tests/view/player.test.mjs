// SPDX-License-Identifier: GPL-2.0-only
import assert from "node:assert/strict";
import test from "node:test";
import { Cache, Player } from "../../python/mdanim_lammps/view/web/player.js";

const player = (values) => Object.assign(new Player(0.04), { count: 100, ...values });
const settled = () => new Promise((done) => setTimeout(done, 0));

test("the film goes at its own speed, whatever the pictures per second", () => {
  for (const step of [0.01, 0.1]) {
    const p = player({ playing: true });
    for (let t = 0; t < 1 - 1e-9; t += step) p.tick(step);
    assert.equal(p.frame, 25);
  }
  const slow = player({ playing: true, speed: 0.25 });
  slow.tick(1);
  assert.equal(slow.frame, 6);
});

test("at the end it waits for a second and begins again, or at once when it is played", () => {
  const p = player({ playing: true });
  p.tick(1000);
  assert.deepEqual([p.frame, p.playing], [99, true]);
  p.tick(0.9);
  assert.equal(p.frame, 99);
  p.tick(0.2);
  assert.deepEqual([p.frame, p.playing], [0, true]);
  p.tick(0.04);
  assert.equal(p.frame, 1);
  p.go(99);
  assert.deepEqual([p.frame, p.playing], [99, false]);
  p.tick(10);
  assert.equal(p.frame, 99); // a film that is halted stays
  p.play();
  assert.deepEqual([p.frame, p.playing], [0, true]);
});

test("of a run that goes on it waits at the newest frame", () => {
  const p = player({ playing: true, live: true, count: 3 });
  p.tick(10);
  assert.deepEqual([p.frame, p.playing], [2, true]);
  p.count = 10;
  p.tick(0.08);
  assert.equal(p.frame, 4); // and does not jump
});

test("the newest frame is always shown when that is asked for", () => {
  const p = player({ live: true, count: 3 });
  p.follow();
  p.tick(0.01);
  p.count = 50;
  p.tick(0.01);
  assert.deepEqual([p.frame, p.wanted()], [49, [49]]);
  p.go(7);
  p.tick(1);
  assert.deepEqual([p.frame, p.newest], [7, false]);
});

test("frames ahead are wanted while it plays", () => {
  const p = player({ playing: true, clock: 97.5 });
  assert.deepEqual(p.wanted(), [97, 98, 99]);
  p.playing = false;
  assert.deepEqual(p.wanted(), [97]);
  assert.deepEqual(player({ count: 0 }).wanted(), []);
});

test("no frame is asked for twice, nor more than the credits at once", async () => {
  const cache = new Cache(), asked = [], answers = [];
  const fetch = (key) => () => { asked.push(key); return new Promise((done) => answers.push(() => done({ bytes: 1, key }))); };
  for (const key of ["a", "a", "b", "c"]) cache.ask(key, fetch(key), 2);
  assert.deepEqual(asked, ["a", "b"]);
  answers[0]();
  await settled();
  assert.equal(cache.get("a").key, "a");
  cache.ask("a", fetch("a"), 2);
  cache.ask("c", fetch("c"), 2);
  assert.deepEqual(asked, ["a", "b", "c"]);
});

test("a frame that does not come can be asked for again", async () => {
  const cache = new Cache();
  cache.ask("a", () => Promise.reject(new Error("no")));
  await settled();
  cache.ask("a", () => Promise.resolve({ bytes: 1 }));
  await settled();
  assert.ok(cache.get("a"));
});

test("memory is bounded by number and by bytes; the newest frame always stays", () => {
  const many = new Cache(3, 1e9), large = new Cache(1e9, 100);
  for (let k = 0; k < 10; k++) { many.put(`${k}`, { bytes: 1 }); large.put(`${k}`, { bytes: 40 }); }
  assert.deepEqual([...many.frames.keys()], ["7", "8", "9"]);
  assert.deepEqual([...large.frames.keys()], ["8", "9"]);
  assert.equal(large.held, 80);
  large.put("x", { bytes: 500 });
  assert.deepEqual([...large.frames.keys()], ["x"]);
});

test("what was asked for before the cache was cleared does not come in", async () => {
  const cache = new Cache();
  let answer;
  cache.ask("a", () => new Promise((done) => (answer = done)));
  cache.clear();
  answer({ bytes: 1 });
  await settled();
  assert.equal(cache.get("a"), undefined);
});
