// SPDX-License-Identifier: GPL-2.0-only
// A second run beside the first: from its report, of which only the block of data is read.
import { Overlay } from "./overlay.js";
import { byId, element } from "./panel.js";
import { Quantities } from "./quantities.js";
import { Embedded } from "./source.js";

const MOST_BYTES = 200e6; // of a report

// The block of data of a report's text, as text. Nothing of it is run or made part of the page.
export function blockOf(text) {
  const found = /<script type="text\/plain" id="replay">([A-Za-z0-9+/=\s]*)<\/script>/.exec(text);
  if (!found) throw new Error("this is not a report; write one: mdanim-lammps report DIR");
  return found[1];
}

export class Second {
  static async load(file, make, camera) {
    if (file.size > MOST_BYTES) throw new Error("this file is too large for a report");
    const source = await new Embedded(blockOf(await file.text())).open(), scene = await source.scene();
    if (scene.page !== camera.scene.page) throw new Error("this report is of another version: write it again with mdanim-lammps report DIR");
    return new Second(source, scene, make, camera);
  }

  // make(canvas, scene) gives a stage. Both cameras are one.
  constructor(source, scene, make, first) {
    Object.assign(this, { source, scene, shown: -1 });
    this.quantities = new Quantities(source, scene);
    const [canvas, overlay] = ["stage2", "overlay2"].map((id) => element("canvas", { id, className: "second" }));
    this.title = element("div", { id: "second-title", textContent: scene.title });
    byId("picture").classList.add("two");
    byId("hello").hidden = true;
    byId("picture").append(canvas, overlay, this.title);
    this.canvas = overlay;
    this.canvas.style.pointerEvents = "none";
    this.stage = make(canvas, scene);
    this.overlay = new Overlay(scene);
    this.together(first, this.stage);
  }

  together(first, second) {
    let busy = false;
    const follow = (one, other) => one.orbit.addEventListener("change", () => {
      if (busy) return;
      busy = true;
      other.stand(one.standpoint());
      other.changed = true;
      busy = false;
    });
    follow(first, second);
    follow(second, first);
    second.stand(first.standpoint());
  }

  async begin(time, arrows) {
    this.stage.resize();
    await this.show(time);
    await this.arrows(arrows);
  }

  // The frame that is seen at a time [s]: the last one that is not after it.
  async show(time) {
    const { times } = this.source;
    let frame = 0;
    while (frame + 1 < times.length && times[frame + 1] <= time + 1e-9) frame++;
    if (frame === this.shown) return;
    this.shown = frame;
    this.frame = await this.source.frame(frame);
    this.stage.show(this.frame);
  }

  // The same arrows, of the second run's own vectors, with the scales of the first.
  async arrows(lines) {
    await this.quantities.look();
    const found = [];
    for (const one of lines) {
      const vectors = await this.quantities.vectorsOf(one.word), objects = one.objects && one.objects.filter((k) => this.scene.objects[k]);
      if (vectors) found.push({ ...one, vectors, objects });
    }
    this.overlay.show(found);
    this.stage.changed = true;
  }

  draw() {
    const { canvas, overlay, stage, frame } = this, pen = canvas.getContext("2d"), { clientWidth: w, clientHeight: h } = canvas;
    [canvas.width, canvas.height] = [w, h];
    if (frame && overlay.busy) overlay.paint(pen, w, h, stage.camera, frame);
  }

  close() {
    for (const part of [this.stage.renderer.domElement, this.canvas, this.title]) part.remove();
    this.stage.renderer.dispose();
    byId("picture").classList.remove("two");
  }
}
