// SPDX-License-Identifier: GPL-2.0-only
// The panel of arrows, trails and curves, and what it lays over the picture.
import { Curves } from "./curves.js";
import { Overlay } from "./overlay.js";
import { byId, element } from "./panel.js";
import { Quantities } from "./quantities.js";

const DESK = "desk"; // what is shown is kept in the tab under this name, for a page that is loaded again
const MOST_LISTED = 500; // objects in the list of those that curves can be of

export class Shows {
  constructor(scene, source, stage) {
    Object.assign(this, { scene, source, stage, picked: null, on: new Set(), looked: 0 });
    this.quantities = new Quantities(source, scene);
    this.overlay = new Overlay(scene);
    this.curves = new Curves(byId("curves"), scene, this.quantities, (words) => (byId("telling").textContent = words));
    this.canvas = byId("overlay");
    byId("words").parentElement.hidden = !(scene.shown.labels.length + scene.shown.captions.length);
    byId("words").onchange = ({ target }) => { this.overlay.words = target.checked; stage.changed = true; };
    byId("only").onchange = () => this.pick(this.picked);
    byId("trail").onclick = () => this.toggleTrail();
    byId("add-curve").onclick = () => {
      const [of, what] = [byId("curve-of").value, byId("curve-what").value];
      if (what) this.curves.add(of === "" ? what : `${of}.${what}`);
    };
    byId("curve-of").onchange = () => this.listWords();
  }

  // Offer what there is, and show what the scene shows, or what was shown before the page was loaded again.
  async begin() {
    const { shown } = this.scene, desk = this.desk();
    this.on = new Set(desk?.arrows ?? shown.arrows.map(([word]) => word));
    this.first = desk?.curves ?? shown.plots;
    if (desk?.camera) this.stage.stand(desk.camera);
    for (const [k, seconds] of desk?.trails ?? shown.trails) await this.trail(k, seconds ?? Infinity);
    await this.offer();
  }

  // Once more when the run has ended: all its frames are there, and what only its end tells.
  async ended() {
    if (!this.first || !this.quantities.live) return;
    this.quantities.live = false;
    await this.refresh(true);
  }

  async offer() {
    await this.look();
    await this.setArrows();
    for (const what of this.first) await this.curves.add(what);
  }

  async look() {
    const { quantities } = this;
    await quantities.look();
    byId("arrows").replaceChildren(...quantities.arrows.map((word) => {
      const box = element("input", { type: "checkbox", id: `arrows-${word}`, checked: this.on.has(word) });
      box.onchange = () => { this.on[box.checked ? "add" : "delete"](word); return this.setArrows(); };
      const why = quantities.untold[word];
      box.disabled = Boolean(why);
      return element("label", why ? { className: "faint", title: why } : {}, box, ` ${word}`);
    }));
    const movers = this.scene.objects.filter(({ still }) => !still), others = this.scene.objects.filter(({ still }) => still);
    const names = [...movers, ...others].slice(0, MOST_LISTED).map(({ name }) => name), rest = [...Object.keys(quantities.own), ...Object.keys(quantities.globals)];
    const chosen = byId("curve-of").value;
    byId("curve-of").replaceChildren(...names.map((name) => element("option", { value: name, textContent: name })), ...(rest.length ? [element("option", { value: "", textContent: "of the scene" })] : []));
    if (names.includes(chosen)) byId("curve-of").value = chosen;
    this.listWords();
  }

  listWords() {
    const { words, own, globals } = this.quantities, chosen = byId("curve-what").value, list = byId("curve-of").value === "" ? { ...own, ...globals } : words;
    byId("curve-what").replaceChildren(...Object.keys(list).map((word) => element("option", { value: word, textContent: list[word] ? `${word} [${list[word]}]` : word })));
    if (chosen in list) byId("curve-what").value = chosen;
  }

  async setArrows() {
    const { shown } = this.scene, lines = [];
    for (const word of this.quantities.arrows.filter((one) => this.on.has(one) && !this.quantities.untold[one])) {
      const vectors = this.quantities.known && !(this.quantities.live && word === "velocity") ? await this.quantities.vectorsOf(word) : null, asked = shown.arrows.filter(([one]) => one === word);
      if (vectors && !this.quantities.live && !vectors.some(Number.isFinite)) {
        this.on.delete(word);
        byId("telling").textContent = `${word}: the run does not tell it of any object`;
        continue;
      }
      if (vectors || word === "velocity") for (const [, objects, scale] of asked.length ? asked : [[word, null, null]]) lines.push({ word, vectors, objects, scale });
    }
    for (const word of this.quantities.arrows) byId(`arrows-${word}`).checked = this.on.has(word);
    this.overlay.show(lines);
    this.stage.changed = true;
  }

  async trail(k, seconds = Infinity) {
    if (!this.scene.objects[k]) return;
    this.overlay.ways.set(k, await this.source.track(k));
    this.overlay.trails.set(k, seconds);
    this.stage.changed = true;
  }

  async toggleTrail() {
    const { picked, overlay: { trails } } = this;
    if (picked === null) byId("telling").textContent = "pick an object first: its trail is the way of its centre";
    else if (trails.has(picked)) trails.delete(picked);
    else await this.trail(picked);
    this.pick(picked);
  }

  pick(k) {
    this.picked = k;
    this.overlay.only = byId("only").checked ? k : null;
    byId("trail").setAttribute("aria-pressed", String(k !== null && this.overlay.trails.has(k)));
    if (k !== null && k < MOST_LISTED) { byId("curve-of").value = this.scene.objects[k].name; this.listWords(); }
    this.stage.changed = true;
  }

  // Ask again for what grows while the run goes on; "anew" also what there is to choose from.
  async refresh(anew = !this.quantities.known) {
    if (!this.first) return; // it has not begun
    this.quantities.forget();
    if (anew) await this.offer();
    else if ([...this.on].some((word) => word !== "velocity")) await this.setArrows();
    for (const k of this.overlay.trails.keys()) this.overlay.ways.set(k, await this.source.track(k));
    await this.curves.refresh();
    this.stage.changed = true;
  }

  draw(frame) {
    const { canvas, overlay } = this, { clientWidth: w, clientHeight: h } = canvas, finer = Math.min(2, devicePixelRatio), pen = canvas.getContext("2d");
    if (canvas.width !== Math.round(w * finer)) canvas.width = Math.round(w * finer);
    if (canvas.height !== Math.round(h * finer)) canvas.height = Math.round(h * finer);
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.scale(finer, finer);
    if (overlay.busy) overlay.paint(pen, w, h, this.stage.camera, frame);
  }

  // Keep what is shown, for a page that is loaded again because the scene was run again.
  keep() {
    const { overlay, stage, curves } = this;
    const desk = { arrows: [...this.on], trails: [...overlay.trails].map(([k, seconds]) => [k, Number.isFinite(seconds) ? seconds : null]), curves: curves.names, camera: stage.moved ? stage.standpoint() : null };
    try { sessionStorage.setItem(DESK, JSON.stringify(desk)); } catch { /* a browser that keeps nothing */ }
  }

  desk() {
    try {
      const kept = JSON.parse(sessionStorage.getItem(DESK));
      sessionStorage.removeItem(DESK);
      return kept;
    } catch {
      return null;
    }
  }
}
