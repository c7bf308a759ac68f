// SPDX-License-Identifier: GPL-2.0-only
// Where scene and frames come from: the server of a run, or the block of data in a report.
import { inOwnBoxes, readFrame, readScene, undoDifferences } from "./message.js";
import { ofVector } from "./quantities.js";

// The token that admits this page: from its address, or from the tab when it is loaded again. No other port gets it.
function token() {
  const given = new URLSearchParams(location.search).get("t");
  try {
    if (given) sessionStorage.setItem("token", given);
    return given ?? sessionStorage.getItem("token") ?? "";
  } catch {
    return given ?? ""; // a browser that keeps nothing
  }
}

// Answers come in the order in which they were asked for. What is told without being asked for says what it is.
export class Socket {
  constructor() {
    this.waiting = [];
    this.heard = () => {};
    this.lost = () => {};
    this.refused = () => {};
  }

  open() {
    return new Promise((done, failed) => {
      this.socket = new WebSocket(`ws://${location.host}/socket?t=${token()}`);
      this.socket.binaryType = "arraybuffer";
      this.socket.onopen = () => done(this);
      this.socket.onmessage = ({ data }) => this.take(data);
      this.socket.onclose = () => {
        this.waiting.splice(0).forEach(({ failed: give_up }) => give_up(new Error("the server has ended")));
        this.lost();
        failed(new Error("the server does not admit it, or has ended; open the address that 'mdanim-lammps view' has printed"));
      };
    });
  }

  take(data) {
    if (typeof data !== "string") return this.waiting.shift().done(data);
    const said = JSON.parse(data);
    if (said.news) return this.heard(said.news);
    if (said.refused) return this.refused(said.refused);
    if (said.error) return this.waiting.shift().failed(new Error(said.error));
    return this.waiting.shift().done(said);
  }

  ask(what) {
    return new Promise((done, failed) => {
      if (this.socket.readyState !== WebSocket.OPEN) return; // no answer comes any more
      this.waiting.push({ done, failed });
      this.socket.send(JSON.stringify(what));
    });
  }

  listen(heard) {
    this.heard = heard;
  }

  async scene() {
    const scene = readScene(await this.ask({ scene: 1 }));
    this.added = scene.added;
    return scene;
  }

  async springs() {
    return readScene(await this.ask({ springs: 1 })).data.bond;
  }

  // Times, places and velocities of an object's centre.
  async track(k) {
    return readScene(await this.ask({ track: k })).data;
  }

  told() {
    return this.ask({ told: 1 });
  }

  async curve(named) {
    const { data, ...head } = readScene(await this.ask({ curve: named }));
    return { ...head, ...data };
  }

  async arrows(word) {
    return readScene(await this.ask({ arrows: word })).data.vector;
  }

  async frame(frame, layers) {
    return readFrame(await this.ask({ get: frame, layers }), this.added);
  }

  // Without a text: the text that is there. Else its problems, and whether a run of it has begun.
  edit(text = null, run = false) {
    return this.ask({ edit: text, run });
  }

  // The hand on an object: three of its vertices, their weights in the point, and where the hand is; null lets go.
  pull(hand) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ hand }));
  }

  tell(what) {
    this.socket.send(JSON.stringify({ do: what }));
  }
}

// A block of gzip in base64 that export.py has made.
export class Embedded {
  constructor(text) {
    this.text = text;
  }

  async open() {
    const packed = Uint8Array.from(atob(this.text.trim()), (sign) => sign.charCodeAt(0));
    const plain = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
    const size = new DataView(plain).getUint32(0, true);
    this.head = readScene(plain.slice(4, 4 + size));
    const { vertices: V, columns: C } = this.head.replay, F = this.head.frames, O = this.head.objects.length;
    let at = 4 + size;
    const next = (bytes) => plain.slice(at, (at += bytes));
    this.times = new Float64Array(next(8 * F));
    this.moving = new Float32Array(next(24 * O * F));
    this.places = undoDifferences(new Uint8Array(next(6 * V * F)), 3 * V, F);
    if (C) [this.heights, this.states] = [undoDifferences(new Uint8Array(next(2 * C * F)), C, F), new Uint8Array(next(C * F))];
    this.drops = Array.from(this.head.replay.drops, (D) => new Float32Array(next(16 * D)));
    this.added = new Float32Array(next(12 * this.head.added * F));
    Object.assign(this, { O, V, C });
    return this;
  }

  listen(heard) {
    heard(this.head.replay.news);
  }

  async scene() {
    return this.head;
  }

  async track(k) {
    const { moving, O } = this, rows = (first) => Float32Array.from({ length: 3 * this.times.length }, (_, i) => moving[6 * (O * Math.floor(i / 3) + k) + first + (i % 3)]);
    return { time: Float32Array.from(this.times), centre: rows(0), velocity: rows(3) };
  }

  async told() {
    const { curves, words, arrows, ...told } = this.head.replay.told, known = (word) => arrows.some((name) => word === name || word.startsWith(`${name}.`));
    return { ...told, arrows, globals: {}, words: Object.fromEntries(Object.entries(words).filter(([word]) => known(word))) };
  }

  async curve(named) {
    const { told } = this.head.replay, { data, objects } = this.head, n = told.curves.findIndex(({ what }) => what === named);
    if (n >= 0) return { ...told.curves[n], time: data[`time ${n}`], value: data[`value ${n}`] };
    const [subject, word] = named, k = objects.findIndex(({ name }) => name === subject);
    for (const name of told.arrows) {
      const value = ofVector(word, name, data[`arrows ${name}`], k, this.O);
      if (value) return { what: named.join("."), unit: told.words[word], mean: told.means.includes(name), time: Float32Array.from(this.times), value };
    }
    throw new Error("it is not in this report: a record line of the scene brings it there");
  }

  async arrows(word) {
    return this.head.data[`arrows ${word}`];
  }

  async frame(frame) {
    const { O, V, C, head } = this, part = (array, size) => array.subarray(size * frame, size * (frame + 1));
    const solids = inOwnBoxes(head.objects, part(this.places, 3 * V), head.replay.steps, head.data.boxes, part(this.moving, 6 * O));
    const found = { frame, time: this.times[frame], layers: 0, bytes: 0, added: part(this.added, 3 * head.added), ...solids };
    return C ? { ...found, liquid: part(this.heights, C), columns: part(this.states, C), drops: this.drops[frame] } : found;
  }
}
