// SPDX-License-Identifier: GPL-2.0-only
// Curves of quantities over time, a panel for each unit, beside the ones of a second run.
import { Plot } from "./vendor.js";
import { INK, Lines, element, legendKey } from "./panel.js";

const BRIGHTEST = 0.42; // luminance of curves at most on bright paper; on dark paper 1 less this is the least
const DASHES = [5, 4];
export const MOST = 12; // curves at most

export class Curves {
  // "told" is called with the reason where a quantity cannot be shown.
  constructor(place, scene, quantities, told) {
    Object.assign(this, { place, scene, quantities, told, chosen: new Map(), panels: [], time: 0, second: null });
  }

  get names() {
    return [...this.chosen.keys()];
  }

  async add(what) {
    if (this.chosen.has(what)) return;
    if (this.chosen.size >= MOST) return this.told(`${MOST} curves are the most that are shown: take one away first`);
    try {
      const curve = await this.quantities.curve(what);
      if (!this.quantities.live && ![...curve.value].some(Number.isFinite)) throw new Error("the run does not tell it at any frame");
      this.chosen.set(what, { curve, shown: true });
      await this.addSecond(what);
      this.draw();
      this.told("");
    } catch (error) {
      this.told(`${what}: ${error.message}`);
    }
  }

  remove(what) {
    this.chosen.delete(what);
    this.draw();
  }

  // The same quantities of another run, dashed; null for none.
  async compare(quantities) {
    this.second = quantities;
    await Promise.all(this.names.map((what) => this.addSecond(what)));
    this.draw();
  }

  async addSecond(what) {
    const one = this.chosen.get(what);
    one.other = this.second ? await this.second.curve(what).catch(() => null) : null;
  }

  // Ask again: there are more frames.
  async refresh() {
    for (const [what, one] of this.chosen) {
      const curve = await this.quantities.curve(what).catch(() => null);
      if (curve) one.curve = curve;
    }
    if (this.chosen.size) this.draw(true);
  }

  draw(again = false) {
    const units = new Map();
    for (const [what, one] of this.chosen) units.set(one.curve.unit, [...(units.get(one.curve.unit) ?? []), [what, one]]);
    if (again && units.size === this.panels.length) return [...units.values()].forEach((curves, n) => this.panels[n].set(null, [], this.data(curves)));
    this.panels.forEach((panel) => panel.clear());
    this.place.replaceChildren();
    this.panels = [...units].map(([unit, curves]) => this.panel(unit, curves));
    return this.at(this.time);
  }

  data(curves) {
    const lines = curves.flatMap(([, { curve, other }]) => [curve, other].filter(Boolean)), numbers = (values) => Array.from(values, (x) => (Number.isFinite(x) ? x : null));
    return Plot.join(lines.map(({ time, value }) => [Array.from(time), numbers(value)]));
  }

  panel(unit, curves) {
    const lines = new Lines(), figure = element("div"), colors = this.colors(curves.map(([what]) => what)), looks = [], names = [];
    const keys = curves.map(([what, one], k) => {
      const own = [one.curve, one.other].filter(Boolean).map((curve, second) => {
        names.push(what);
        return looks.push({ stroke: colors[k], show: one.shown, spanGaps: true, paths: curve.mean ? Plot.paths.stepped({ align: -1 }) : undefined, ...(second ? { dash: DASHES } : {}) });
      });
      const key = legendKey(what, colors[k], (show) => { one.shown = show; own.forEach((n) => lines.plot.setSeries(n, { show })); }, one.shown);
      const away = element("button", { className: "away", title: "Take this curve away", ariaLabel: `take ${what} away`, textContent: "×" });
      away.onclick = () => this.remove(what);
      return element("span", {}, key, away);
    });
    this.place.append(element("div", { className: "keys" }, ...keys, element("span", { className: "faint", textContent: unit ? `[${unit}]` : "" })), figure);
    lines.set(figure, names, this.data(curves), 120, unit, looks);
    return lines;
  }

  // Colours of the objects where no two are the same, else some that differ.
  colors(names) {
    const own = names.map((what) => this.scene.objects[this.quantities.number(this.quantities.parts(what)?.[0] ?? what.slice(0, what.indexOf(".")))]?.color);
    const differ = own.every(Boolean) && new Set(own.map(String)).size === own.length;
    return names.map((_, k) => (differ ? `rgb(${legible(own[k], this.scene.dark)})` : INK[k % INK.length]));
  }

  at(time) {
    this.time = time;
    this.panels.forEach((panel) => panel.at(time));
  }
}

// A colour of 0 to 255 that stands out from bright or dark paper.
export function legible(color, dark) {
  const bright = color.reduce((sum, c, k) => sum + [0.2126, 0.7152, 0.0722][k] * (c / 255), 0);
  if (dark) return color.map((c) => Math.round(c + (255 - c) * Math.max(0, (1 - BRIGHTEST - bright) / Math.max(1 - bright, 1e-9))));
  return color.map((c) => Math.round(c * Math.min(1, BRIGHTEST / Math.max(bright, 1e-9))));
}
