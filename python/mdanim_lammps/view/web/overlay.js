// SPDX-License-Identifier: GPL-2.0-only
// Things that are laid over the picture: arrows with their legend, trails, labels, captions; looks are those of picture/overlay.py.
import { Vector3 } from "./vendor.js";
import { number } from "./message.js";
import { ARROW_UNITS, median, roundValue, rowsOf, usualScale } from "./quantities.js";

const COLORS = { velocity: "#1c66bf", force: "#333333", contact: "#cc1f24", weight: "#1f8533", spin: "#7d47ad" };
const ON_DARK = { velocity: "#63a8ff", force: "#d8d8d8", contact: "#ff6b6b", weight: "#5fd67b", spin: "#c39bf0" };
const LETTERS = 0.028, SMALLEST = 11, LARGEST = 20; // height of letters over that of the picture, and its limits [pixels]
const SEEN = 2; // length of the longest arrow of a word at which it is seen [pixels]
const WIDTH = 0.65; // of a bold letter, over the height of letters
const APART = 1.2; // distance of words one above the other, at least, over the height of letters
const FARTHEST = 3; // way of words from the height of their object, at most, over that distance
const LEGEND = 4.5, HEAD = 3.2, HALF = 0.42; // length of an arrow of the legend over that of letters; of a head over the width of a shaft; half of its width over its length

// The height nearest to y at which words from `begin` to `end` are `apart` from others, each from a begin to an end at a height; y where all are too far. Words that were placed first stay, so that none jump to and fro.
export function freeHeight(y, begin, end, placed, apart) {
  const met = placed.filter(([low, high]) => low < end && begin < high).map(([, , height]) => height).sort((a, b) => a - b);
  const away = (way) => (at, height) => (Math.abs(at - height) < (1 - 1e-9) * apart ? height + way * apart : at);
  const above = met.reduce(away(1), y), below = met.reduceRight(away(-1), y);
  const found = above - y < y - below ? above : below;
  return Math.abs(found - y) <= FARTHEST * apart ? found : y;
}

export class Overlay {
  constructor(scene) {
    Object.assign(this, { scene, words: true, only: null, trails: new Map(), ways: new Map(), arrows: [], reach: [], placed: [], fastest: 0 });
    this.ink = scene.dark ? "#f2f5f7" : "#212933";
    this.paper = scene.dark ? "#1f242b" : "#ffffff";
    this.middle = new Vector3(...scene.bounds[0]).add(new Vector3(...scene.bounds[1])).multiplyScalar(0.5);
  }

  // Whether there is anything to draw.
  get busy() {
    const { labels, captions } = this.scene.shown;
    return this.arrows.length + this.trails.size + (this.words ? labels.length + captions.length : 0) > 0;
  }

  // Arrows of words: their vectors by frame (null: velocities of each frame), the objects that have one (null: all that move) and a scale (null: one that shows well).
  show(arrows) {
    const units = (word) => ARROW_UNITS[word] ?? "N";
    const lines = arrows.map((one) => ({ ...one, unit: units(one.word), shown: one.vectors && rowsOf(one.vectors, this.having(one), this.scene.objects.length) }));
    this.arrows = lines.map(({ shown, ...one }) => {
      const alike = lines.filter((other) => other.unit === one.unit && other.scale === null && other.shown);
      const most = shown ? shown.reduce((most, x) => Math.max(most, Math.abs(x) || 0), 0) : Infinity;
      return { ...one, most, scale: one.scale ?? (shown ? usualScale(alike.map((other) => other.shown), this.scene.size) : null) };
    });
  }

  // The objects that have an arrow of a line.
  having({ objects }) {
    return objects ?? [...this.scene.objects.keys()].filter((k) => !this.scene.objects[k].still);
  }

  // Lay it over a picture of a frame: into a pen whose unit is a pixel of the page.
  paint(pen, width, height, camera, frame) {
    const letters = Math.max(SMALLEST, Math.min(LARGEST, LETTERS * height));
    Object.assign(this, { pen, width, height, camera, letters });
    pen.font = `${letters}px system-ui, "DejaVu Sans", sans-serif`;
    pen.lineJoin = "round";
    pen.textBaseline = "middle";
    this.eye = camera.position;
    this.ahead = camera.getWorldDirection(new Vector3());
    for (const [k, seconds] of this.trails) this.trail(k, seconds, frame);
    for (const one of this.arrows) this.vectors(one, frame);
    this.legend();
    if (!this.words) return;
    this.placed = [];
    this.scene.shown.labels.forEach(([group, text], n) => this.label(n, group, text, frame));
    const spoken = this.scene.shown.captions.filter(([, begin, end]) => frame.time >= (begin ?? 0) - 1e-9 && frame.time <= (end ?? Infinity) + 1e-9).reverse();
    spoken.forEach(([text], n) => this.write(text, width / 2, height * (0.9 - 0.06 * n), { size: 1.25, bold: true, align: "center" }));
  }

  // Where a point is seen, or null behind the camera.
  at(x, y, z) {
    const place = new Vector3(x, y, z);
    if (place.clone().sub(this.eye).dot(this.ahead) < this.camera.near) return null;
    place.project(this.camera);
    return [((1 + place.x) / 2) * this.width, ((1 - place.y) / 2) * this.height];
  }

  trail(k, seconds, { frame, time, object }) {
    const way = this.ways.get(k), points = [];
    if (!way) return;
    for (let n = 0; n < way.time.length && way.time[n] < time; n++) if (way.time[n] >= time - seconds - 1e-9) points.push(this.at(...way.centre.subarray(3 * n, 3 * n + 3)));
    points.push(this.at(...object.subarray(12 * k + 6, 12 * k + 9)));
    const { pen } = this, color = this.scene.objects[k].color.map((c) => Math.round(0.8 * c));
    pen.lineWidth = 0.2 * this.letters;
    pen.lineCap = "butt";
    for (let n = 1; n < points.length; n++) {
      if (!points[n - 1] || !points[n]) continue;
      const strength = Number.isFinite(seconds) ? 0.25 + (0.65 * n) / points.length : 0.9;
      pen.strokeStyle = `rgba(${color}, ${strength})`;
      this.line([points[n - 1], points[n]]);
    }
  }

  line(points) {
    this.pen.beginPath();
    points.forEach(([x, y], n) => (n ? this.pen.lineTo(x, y) : this.pen.moveTo(x, y)));
    this.pen.stroke();
  }

  vectors({ word, vectors, objects, scale }, { frame, object }) {
    const O = this.scene.objects.length, chosen = this.having({ objects });
    const of = (k) => (vectors ? vectors.subarray(3 * (O * frame + k), 3 * (O * frame + k) + 3) : object.subarray(12 * k + 9, 12 * k + 12));
    if (!vectors) for (const k of chosen) this.fastest = Math.max(this.fastest, Math.hypot(...of(k)));
    const length = scale ?? this.usual();
    for (const k of chosen) {
      if (this.only !== null && k !== this.only) continue;
      const begin = object.subarray(12 * k + 6, 12 * k + 9), v = of(k);
      if (v.length < 3 || ![...v].every(Number.isFinite)) continue; // no value, or none yet
      const ends = [this.at(...begin), this.at(...begin.map((x, d) => x + length * v[d]))];
      if (ends[0] && ends[1]) this.arrow(...ends, this.color(word));
    }
  }

  // The scale of velocities while the run goes on: by the largest so far.
  usual() {
    return this.fastest ? (0.14 * this.scene.size) / this.fastest : 1;
  }

  color(word) {
    return (this.scene.dark ? ON_DARK : COLORS)[word] ?? this.ink;
  }

  // An arrow with an outline; one that is shorter than its head is a smaller head.
  arrow([x0, y0], [x1, y1], color) {
    const { pen } = this, width = 0.32 * this.letters, long = Math.hypot(x1 - x0, y1 - y0);
    if (!(long > 1)) return;
    const [ux, uy] = [(x1 - x0) / long, (y1 - y0) / long], head = Math.min(HEAD * width, long), half = 0.5 * width * Math.min(1, long / (HEAD * width)), wing = HALF * head;
    const to = (along, aside) => pen.lineTo(x0 + along * ux - aside * uy, y0 + along * uy + aside * ux);
    pen.beginPath();
    for (const [along, aside] of [[0, half], [long - head, half], [long - head, wing], [long, 0], [long - head, -wing], [long - head, -half], [0, -half]]) to(along, aside);
    pen.closePath();
    pen.strokeStyle = this.paper;
    pen.lineWidth = 0.3 * width;
    pen.fillStyle = color;
    pen.fill();
    pen.stroke();
  }

  // An arrow of a round value for each word, as long as it would be in the middle of the scene across the line of sight.
  legend() {
    const away = this.middle.clone().sub(this.eye).dot(this.ahead), pixels = this.height / (2 * Math.tan((this.camera.fov * Math.PI) / 360) * Math.max(away, this.camera.near));
    const rows = [...new Map(this.arrows.map((one) => [`${one.word} ${one.scale}`, one])).values()].map(({ word, unit, scale, most }) => {
      const long = scale ?? this.usual(), value = roundValue((LEGEND * this.letters) / (pixels * long));
      return most * long * pixels < SEEN ? { word, length: 0 } : { word, unit, value, length: value * long * pixels };
    });
    const widest = Math.max(0, ...rows.map(({ length }) => length)), left = 1.2 * this.letters;
    rows.forEach(({ word, unit, value, length }, n) => {
      const y = (1.4 + 1.5 * n) * this.letters;
      this.arrow([left, y], [left + length, y], this.color(word));
      this.write(length ? `${word}  ${number(value)} ${unit}` : `${word}: too small to be seen`, left + widest + 0.7 * this.letters, y, { color: this.color(word) });
    });
  }

  // Words beside the box of an object, or of those of its pieces that are as near their middle as any was so far.
  label(number, group, text, { object }) {
    const way = [0, 1, 2], at = (k, d) => object[12 * k + 6 + d], middle = way.map((d) => median(group.map((k) => at(k, d))));
    const away = group.map((k) => Math.hypot(...way.map((d) => at(k, d) - middle[d])));
    this.reach[number] = Math.min(this.reach[number] ?? Infinity, Math.max(...away));
    const near = group.filter((_, n) => away[n] <= Math.max(1.3 * this.reach[number], Math.min(...away)));
    const ends = way.map((d) => [Math.min(...near.map((k) => object[12 * k + d])), Math.max(...near.map((k) => object[12 * k + d] + object[12 * k + 3 + d]))]);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((n) => this.at(...way.map((d) => ends[d][(n >> d) & 1])));
    if (corners.includes(null)) return;
    const wide = WIDTH * this.letters * text.length, right = this.width - wide - 0.2 * this.letters;
    const x = Math.max(0.2 * this.letters, Math.min(Math.max(...corners.map((p) => p[0])) + 0.4 * this.letters, right));
    const y = freeHeight(corners.reduce((sum, p) => sum + p[1], 0) / 8, x, x + wide, this.placed, APART * this.letters);
    this.placed.push([x, x + wide, y]);
    this.write(text, x, y, { bold: true });
  }

  write(text, x, y, { size = 1, bold = false, align = "left", color = this.ink }) {
    const { pen } = this;
    pen.font = `${bold ? "bold " : ""}${size * this.letters}px system-ui, "DejaVu Sans", sans-serif`;
    pen.textAlign = align;
    pen.lineWidth = 0.25 * this.letters;
    pen.strokeStyle = this.paper;
    pen.fillStyle = color;
    pen.strokeText(text, x, y);
    pen.fillText(text, x, y);
  }
}
