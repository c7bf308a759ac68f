// SPDX-License-Identifier: GPL-2.0-only
// The panels beside the picture. Text from scenes is set as text, never as HTML.
import { Plot } from "./vendor.js";
import { RELATIVE, drawn, number } from "./message.js";
import { spanOf } from "./quantities.js";

export const INK = ["#e8743b", "#3b8fc4", "#4fae7b", "#d99a1c", "#d3557a", "#7a6fc9", "#2fa39d", "#b5654f", "#7f9c2e",
  "#5b6b7a", "#a13f8f", "#1f6f5c", "#c2b23a", "#3f4fa8"];
export const byId = (id) => document.getElementById(id);

// An element with properties and children.
export function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

export function table(rows) {
  return element("table", {}, ...rows.map((cells) => element("tr", {}, ...cells.map((cell) => element("td", { textContent: cell })))));
}

// A way to colour objects; one that this run does not have says where it is.
export function offer(value, there, words, where) {
  const choice = byId("colour").querySelector(`[value="${value}"]`);
  choice.disabled = !there;
  choice.textContent = there ? words : `${words} (${where})`;
}

// Show the state of the run, and a message.
export function say(state, message) {
  byId("state").textContent = state || "connecting";
  byId("state").className = `pill ${state}`;
  const more = { killed: "The run was killed; what it has written can be seen. It goes on from its last checkpoint with: mdanim-lammps resume DIR" }[state];
  byId("message").hidden = !(message || more);
  byId("message").textContent = message || more || "";
  byId("message").classList.toggle("bad", ["failed", "lost", "killed"].includes(state));
}

// Show the values of the picked object at a frame.
export function showObject(scene, frame, k, owner) {
  const place = byId("object");
  place.classList.toggle("faint", k === null);
  if (k === null) return place.replaceChildren("click an object in the picture");
  const { name, mass, still } = scene.objects[k], at = frame.object.subarray(12 * k, 12 * k + 12), point = (p) => [...p].map((x) => number(x)).join(", ");
  const rows = [["name", name], ["mass", `${number(mass, 4)} kg`], ["centre", `${point(at.subarray(6, 9))} m`], ["velocity", `${point(at.subarray(9, 12))} m/s`],
    ["speed", `${number(Math.hypot(at[9], at[10], at[11]))} m/s`], ["box", `${point(at.subarray(3, 6))} m`]];
  if (still) rows.push(["", "is held and never moves"]);
  else if (owner !== null) rows.push(["executor", owner < 0 ? "none" : String(owner)]);
  return place.replaceChildren(table(rows));
}

// A mark of a colour with words, which shows and hides a line: a click calls "toggle" with whether it is shown now.
export function legendKey(words, color, toggle, shown = true) {
  const mark = element("i"), key = element("button", { className: "legend-key", title: "Show or hide this curve" }, mark, words);
  mark.style.background = color;
  const press = (on) => key.setAttribute("aria-pressed", String(on));
  press(shown);
  key.onclick = () => { shown = !shown; press(shown); toggle(shown); };
  return key;
}

// Lines over time, with a cursor at the frame that is seen.
export class Lines {
  constructor() {
    this.line = document.createElement("div");
    this.time = 0;
  }

  clear() {
    this.plot?.destroy();
    this.plot = null;
  }

  // Times and one array of values for each name, and their unit, with looks that are not the usual ones.
  set(place, names, data, height, unit, looks = []) {
    if (this.plot) return this.plot.setData(data);
    const ink = getComputedStyle(document.body).getPropertyValue("--faint"), axis = { stroke: ink, font: "10px sans-serif", grid: { stroke: ink + "30" }, ticks: { show: false } };
    const series = [{}, ...names.map((label, k) => ({ label, stroke: INK[k % INK.length], width: 1.5, pxAlign: 0, ...looks[k] }))];
    const values = (_, ticks) => ticks.map((x) => number(x, 4));
    this.plot = new Plot({ width: Math.max(160, Math.min(640, (place.closest("aside")?.clientWidth || 300) - 28)), height, scales: { x: { time: false }, y: { range: (_, low, high) => spanOf(low, high, unit) } }, legend: { show: false }, cursor: { show: false }, padding: [6, 16, 0, 0],
      axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((x) => `${number(x)} s`) }, { ...axis, size: 46, values }], series,
      hooks: { draw: [() => this.at(this.time)] } }, data, place);
    this.line = element("div", { className: "now" });
    this.plot.over.append(this.line);
    Object.assign(this.line.style, { position: "absolute", top: "0", bottom: "0", width: "1px", background: ink });
  }

  at(time) {
    this.time = time;
    if (this.plot && this.line.parentElement) this.line.style.left = `${this.plot.valToPos(time, "x")}px`;
  }
}

// How high the centre of the picked object is.
export class Height extends Lines {
  show(points) {
    byId("height").hidden = points === null;
    if (points === null) return this.clear();
    return this.set(byId("height-line"), ["height"], points, 110, "m");
  }
}

// The ledger.
export class Energies extends Lines {
  constructor() {
    super();
    this.rows = [];
  }

  begin(columns, energies, keep) {
    this.names = columns.slice(1, 1 + energies);
    if (!keep) this.rows = []; // else rows of frames that are computed again go when these come
    this.clear();
  }

  add(rows) {
    while (this.rows.length && this.rows.at(-1)[0] >= rows[0][0]) this.rows.pop();
    this.rows.push(...rows);
    if (this.rows.length > 8000) this.rows = this.rows.filter((_, k) => k % 2 === 0);
    if (this.names.length) this.due ??= setTimeout(() => this.draw(), 200);
  }

  // The largest so far: its column follows those of the energies.
  get residual() {
    return this.rows.reduce((most, row) => Math.max(most, Math.abs(row[1 + this.names.length])), 0);
  }

  draw() {
    this.due = undefined;
    const data = drawn(this.names, this.rows);
    if (!this.plot) {
      const keys = element("div", { className: "keys" }, ...this.names.map((name, k) => {
        return legendKey(name.replaceAll("_", " ") + (RELATIVE.includes(name) ? ", change" : ""), INK[k % INK.length], (show) => this.plot?.setSeries(k + 1, { show }));
      }));
      this.figure = element("div");
      byId("energies").replaceChildren(keys, this.figure);
    }
    this.set(this.figure, this.names, data, 150, "J");
  }
}

// Seconds of each effect as bars; with the line of the scene that called for it, where that is known.
export function showCost(cost, facts) {
  const parts = Object.entries(cost).sort((a, b) => b[1] - a[1]).slice(0, 7).filter(([, seconds], _, [[, most]]) => seconds > 0.01 * most), most = parts[0]?.[1];
  byId("cost-panel").hidden = !parts.length;
  byId("cost").replaceChildren(...parts.map(([name, seconds]) => {
    const bar = element("b"), place = facts?.cost?.effects?.[name]?.place;
    bar.style.width = `${(100 * seconds) / most}%`;
    return element("div", { className: "bar", title: place ? `${name}: asked for at ${place}` : name }, element("span", { textContent: name }), bar, element("em", { textContent: `${number(seconds, 2)} s` }));
  }));
}

// Expected against found.
export function showExpects(facts) {
  const expects = facts?.summary?.expect ?? [], old = byId("expects");
  old?.remove();
  if (!expects.length) return;
  const rows = expects.map((e) => [e.met ? "met" : "MISSED", `${e.what} = ${number(e.found, 5)}`]);
  byId("more").prepend(element("details", { id: "expects", open: true }, element("summary", { textContent: "Expected" }), table(rows)));
}

// Colours of strain, from none to the most: dark blue, green, yellow, red.
const RAMP = [[38, 70, 140], [40, 150, 160], [110, 190, 90], [245, 205, 60], [215, 50, 40]];

export function strainColor(share) {
  const x = Math.max(0, Math.min(0.999999, share)) * (RAMP.length - 1), k = Math.floor(x);
  return RAMP[k].map((c, d) => c + (x - k) * (RAMP[k + 1][d] - c));
}

// The next of 1, 2, 5, 10, ... per cent above a strain.
export function roundStrain(strain, most) {
  return [0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2].find((edge) => strain <= edge && edge <= most) ?? most;
}

export const executorColor = (executor) => {
  const hex = executor < 0 ? 0xa3a9b0 : parseInt(INK[executor % INK.length].slice(1), 16);
  return [hex >> 16, (hex >> 8) & 255, hex & 255];
};

export function showLegend(kind, range, executors) {
  const place = byId("legend"), swatch = (color) => {
    const mark = element("i", { className: "key" });
    mark.style.background = `rgb(${color.map(Math.round)})`;
    return mark;
  };
  place.hidden = kind === "object";
  if (kind === "strain") {
    const ramp = element("i");
    ramp.style.background = `linear-gradient(90deg, ${RAMP.map((c) => `rgb(${c})`)})`;
    place.replaceChildren("strain 0", ramp, `${number(100 * range)} %`);
  } else if (kind === "executor") {
    const keys = Array.from({ length: Math.min(executors, INK.length) }, (_, e) => element("span", {}, swatch(executorColor(e)), ` ${e}`));
    place.replaceChildren("executor", ...keys, element("span", {}, swatch(executorColor(-1)), " none"));
  }
}

export const KEYS = [
  ["drag, wheel, right drag", "turn, zoom, move"], ["click", "pick an object; Esc lets it go"], ["drag an object", "pull at it, in a run with --hands"], ["Space", "play or hold the film"], ["Shift+Space", "pause the run, or let it go on"],
  ["← →", "a frame, with Shift ten"], ["Home, End", "first frame, newest frame"], ["1 … 7", "what is shown"], ["V", "arrows of velocity"], ["T", "the trail of the picked object"], ["F", "see all, or the picked object"],
  ["C", "copy the camera line"], ["P, G", "save a screenshot, a GIF"], ["?", "this list"],
];

// Whether a key belongs to what has the focus.
export function typing({ target, key }) {
  if (target.matches("textarea, select, input:not([type=range], [type=checkbox])")) return true;
  return target.matches("button, summary, input[type=checkbox]") && [" ", "Enter"].includes(key);
}
