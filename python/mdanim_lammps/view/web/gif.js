// SPDX-License-Identifier: GPL-2.0-only
// An animated GIF of pictures, as bytes; nothing here touches the page.

const COLORS = 255; // the last one of 256 is clear: what stays as it was
const short = (x) => [x & 255, x >> 8];
const bin = (r, g, b) => ((r >> 3) << 10) | ((g >> 3) << 5) | (b >> 3);

// Red, green, blue of at most COLORS colours that are near those of some pictures (RGBA), by median cut.
export function paletteOf(pictures) {
  const count = new Uint32Array(32768), mean = new Float64Array(3 * 32768);
  for (const picture of pictures) {
    for (let i = 0; i < picture.length; i += 4) {
      const k = bin(picture[i], picture[i + 1], picture[i + 2]);
      count[k]++;
      for (let d = 0; d < 3; d++) mean[3 * k + d] += picture[i + d];
    }
  }
  const points = [...count.keys()].filter((k) => count[k]).map((k) => ({ n: count[k], at: [0, 1, 2].map((d) => mean[3 * k + d] / count[k]) }));
  let boxes = [points];
  while (boxes.length < COLORS) {
    const spread = boxes.map((box) => (box.length < 2 ? 0 : Math.max(...spans(box)) * Math.cbrt(box.reduce((sum, { n }) => sum + n, 0))));
    const widest = spread.indexOf(Math.max(...spread));
    if (!spread[widest]) break;
    const box = boxes[widest], span = spans(box), d = span.indexOf(Math.max(...span)), sorted = box.sort((a, b) => a.at[d] - b.at[d]);
    const half = sorted.reduce((sum, { n }) => sum + n, 0) / 2;
    let cut = 0, sum = 0;
    while (cut < sorted.length - 1 && (sum += sorted[cut].n) < half) cut++;
    cut = Math.max(1, cut);
    boxes.splice(widest, 1, sorted.slice(0, cut), sorted.slice(cut));
  }
  boxes = boxes.filter((box) => box.length);
  return Uint8Array.from(boxes.flatMap((box) => [0, 1, 2].map((d) => Math.round(box.reduce((sum, { n, at }) => sum + n * at[d], 0) / box.reduce((sum, { n }) => sum + n, 0)))));
}

function spans(box) {
  return [0, 1, 2].map((d) => { let low = Infinity, high = -Infinity; for (const { at } of box) { low = Math.min(low, at[d]); high = Math.max(high, at[d]); } return high - low; });
}

export class Gif {
  constructor(width, height, palette) {
    Object.assign(this, { width, height, palette, near: new Int16Array(32768).fill(-1), before: null, parts: [] });
    const table = new Uint8Array(768);
    table.set(palette);
    this.put([...new TextEncoder().encode("GIF89a"), ...short(width), ...short(height), 0xf7, 0, 0], table);
    this.put([0x21, 0xff, 11, ...new TextEncoder().encode("NETSCAPE2.0"), 3, 1, 0, 0, 0]); // for ever
  }

  put(...parts) {
    this.parts.push(...parts.map((part) => Uint8Array.from(part)));
  }

  // Add a picture (RGBA) that is seen for some hundredths of a second.
  add(picture, delay) {
    const { width, height, before } = this, now = new Uint8Array(width * height), sent = new Uint8Array(width * height);
    for (let p = 0, i = 0; p < now.length; p++, i += 4) {
      now[p] = this.nearest(picture[i], picture[i + 1], picture[i + 2]);
      sent[p] = before && before[p] === now[p] ? COLORS : now[p];
    }
    this.put([0x21, 0xf9, 4, 0x05, ...short(delay), COLORS, 0], [0x2c, 0, 0, 0, 0, ...short(width), ...short(height), 0, 8], packed(sent), [0]);
    this.before = now;
  }

  nearest(r, g, b) {
    const k = bin(r, g, b), { near, palette } = this;
    if (near[k] < 0) {
      let least = Infinity;
      for (let c = 0; c < palette.length; c += 3) {
        const away = 2 * (palette[c] - r) ** 2 + 4 * (palette[c + 1] - g) ** 2 + (palette[c + 2] - b) ** 2;
        if (away < least) [least, near[k]] = [away, c / 3];
      }
    }
    return near[k];
  }

  // All of it; nothing can be added any more.
  get bytes() {
    this.put([0x3b]);
    const whole = new Uint8Array(this.parts.reduce((sum, { length }) => sum + length, 0));
    let at = 0;
    for (const part of this.parts) { whole.set(part, at); at += part.length; }
    return whole;
  }
}

// Numbers of 8 bits by LZW, in blocks of at most 255 bytes that are preceded by their length.
export function packed(numbers) {
  const CLEAR = 256, END = 257, table = new Int16Array(4096 * 256), out = [];
  let next = 258, bits = 9, held = 0, filled = 0, block = [];
  const byte = (x) => { block.push(x); if (block.length === 255) { out.push(255, ...block); block = []; } };
  const code = (x) => { held |= x << filled; filled += bits; while (filled >= 8) { byte(held & 255); held >>>= 8; filled -= 8; } };
  code(CLEAR);
  let prefix = numbers[0];
  for (let i = 1; i < numbers.length; i++) {
    const at = (prefix << 8) | numbers[i];
    if (table[at]) { prefix = table[at]; continue; }
    code(prefix);
    if (next < 4096) {
      table[at] = next;
      if (next === 1 << bits) bits++;
      next++;
    } else {
      code(CLEAR);
      table.fill(0);
      [next, bits] = [258, 9];
    }
    prefix = numbers[i];
  }
  code(prefix);
  code(END);
  if (filled) byte(held & 255);
  if (block.length) out.push(block.length, ...block);
  return Uint8Array.from(out);
}
