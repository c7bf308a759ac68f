// SPDX-License-Identifier: GPL-2.0-only
// Pictures, clips and GIFs of what is seen, saved as files.
import { Gif, paletteOf } from "./gif.js";
import { byId, element } from "./panel.js";

const WIDE = 640, LEAST = 0.04; // pixels across, and seconds for which a picture is seen at least, of a GIF
const SAMPLES = 6; // pictures from which its colours are taken
const CLIP = 1280; // pixels across of a clip at most

export class Saving {
  // "views" gives the pictures beside each other: a stage, its frame, what is laid over it and the canvas of that; "seen(n)" shows a frame and waits until it is drawn.
  constructor(player, views, seen) {
    Object.assign(this, { player, views, seen, recorder: null, making: false });
    byId("shot").onclick = () => this.shot();
    byId("gif").onclick = () => (this.making ? (this.making = false) : this.gif());
    byId("clip").onclick = () => (this.recorder ? this.recorder.stop() : this.record());
    byId("clip").hidden = typeof MediaRecorder === "undefined";
  }

  // A canvas with all that is seen: as wide as told, or with all pixels that there are.
  paper(width = null) {
    const sheets = this.views().map(({ stage, overlay, frame }) => {
      const sheet = stage.paper(width && width / this.views().length), pen = sheet.getContext("2d"), { clientWidth, clientHeight } = stage.renderer.domElement;
      pen.scale(sheet.width / clientWidth, sheet.height / clientHeight);
      if (overlay.busy) overlay.paint(pen, clientWidth, clientHeight, stage.camera, frame);
      return sheet;
    });
    if (sheets.length === 1) return sheets[0];
    const both = element("canvas", { width: sheets.reduce((sum, one) => sum + one.width, 0), height: sheets[0].height }), pen = both.getContext("2d");
    sheets.forEach((one, n) => pen.drawImage(one, n * sheets[0].width, 0));
    return both;
  }

  shot() {
    const { frame } = this.views()[0];
    this.paper().toBlob((file) => save(file, `frame-${frame.frame}.png`));
    this.refresh();
  }

  // The film from the first frame to the last, each frame in full, in a GIF that plays at the film's speed.
  async gif() {
    const { player } = this, before = player.frame, step = Math.max(1, Math.round((LEAST * player.speed) / player.frameTime)), frames = [];
    for (let n = 0; n < player.count; n += step) frames.push(n);
    this.making = true;
    const read = element("canvas").getContext("2d", { willReadFrequently: true });
    const look = async (n) => {
      await this.seen(n);
      const sheet = this.paper(WIDE), { width, height } = sheet;
      if (read.canvas.width !== width || read.canvas.height !== height) Object.assign(read.canvas, { width, height });
      read.drawImage(sheet, 0, 0);
      return [sheet, read.getImageData(0, 0, width, height).data];
    };
    const some = [], every = Math.max(1, Math.ceil(frames.length / SAMPLES));
    for (let k = 0; k < frames.length && this.making; k += every) some.push((await look(frames[k]))[1]);
    const palette = paletteOf(some), hundredths = (n) => Math.round((100 * n * player.frameTime) / player.speed);
    let gif = null;
    for (const n of frames) {
      if (!this.making) break;
      byId("gif").textContent = `GIF ${n + 1}/${player.count}`;
      const [sheet, data] = await look(n);
      gif ??= new Gif(sheet.width, sheet.height, palette);
      gif.add(data, Math.max(2, n === frames.at(-1) ? 100 : hundredths(n + step) - hundredths(n)));
    }
    if (this.making && gif) save(new Blob([gif.bytes], { type: "image/gif" }), "film.gif");
    byId("gif").textContent = "GIF";
    this.making = false;
    player.go(before);
    this.refresh();
  }

  // Record what is seen, as it is seen, until the button is pressed again.
  record() {
    const { clientWidth, clientHeight } = byId("picture"), share = Math.min(1, CLIP / clientWidth), even = (x) => 2 * Math.round((x * share) / 2), chunks = [];
    this.tape = element("canvas", { width: even(clientWidth), height: even(clientHeight) });
    const recorder = (this.recorder = new MediaRecorder(this.tape.captureStream(), { mimeType: "video/webm", videoBitsPerSecond: 8e6 }));
    recorder.ondataavailable = ({ data }) => chunks.push(data);
    recorder.onstop = () => {
      save(new Blob(chunks, { type: "video/webm" }), "clip.webm");
      this.recorder = this.tape = null;
      byId("clip").textContent = "record clip";
      byId("clip").setAttribute("aria-pressed", "false");
    };
    byId("clip").textContent = "end the clip";
    byId("clip").setAttribute("aria-pressed", "true");
    recorder.start();
    this.views().forEach(({ stage }) => (stage.changed = true));
  }

  // A picture was drawn: a clip gets it, too, with what is laid over it.
  drawn() {
    if (!this.tape) return;
    const { tape } = this, pen = tape.getContext("2d"), views = this.views(), wide = tape.width / views.length;
    views.forEach(({ stage, canvas }, n) => {
      stage.sky(pen, n * wide, wide, tape.height);
      for (const layer of [stage.renderer.domElement, canvas]) pen.drawImage(layer, n * wide, 0, wide, tape.height);
    });
  }

  refresh() {
    for (const { stage } of this.views()) { stage.resize(); stage.changed = true; }
  }
}

function save(file, name) {
  const link = element("a", { href: URL.createObjectURL(file), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
