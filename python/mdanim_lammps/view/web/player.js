// SPDX-License-Identifier: GPL-2.0-only
// Which frame is to be seen now, and which frames are worth asking for; nothing here touches the page.

export const PAUSE = 1; // [s] for which the last frame is seen before the film begins again
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];

export class Player {
  constructor(frameTime) {
    this.frameTime = frameTime; // [s] of film
    this.count = 0; // frames that there are
    this.clock = 0; // frames, with a fraction
    this.speed = 1;
    this.playing = false;
    this.newest = false; // whether always the newest frame is shown
    this.live = false; // whether frames are still to come
    this.ended = 0; // [s] for which the last frame has been seen
  }

  get last() {
    return Math.max(0, this.count - 1);
  }

  get frame() {
    return Math.min(this.last, Math.floor(this.clock + 1e-6));
  }

  // Advance by this number of seconds. At the newest frame of a run that goes on the film waits; at the end it begins again.
  tick(seconds) {
    if (this.newest) this.clock = this.last;
    else if (this.playing) {
      const over = this.clock >= this.last && !this.live && this.count;
      this.ended = over ? this.ended + seconds : 0;
      if (this.ended > PAUSE) this.clock = this.ended = 0;
      else this.clock = Math.min(this.last, this.clock + (seconds * this.speed) / this.frameTime);
    }
  }

  play(on = !this.playing) {
    if (on && !this.live && this.clock >= this.last) this.clock = 0;
    this.playing = on;
    this.newest = false;
  }

  go(frame) {
    this.clock = Math.max(0, Math.min(this.last, Math.round(frame)));
    this.playing = this.newest = false;
  }

  follow(on = !this.newest) {
    this.newest = on;
    this.playing = on && this.live;
  }

  // The frame to be seen, then some that will be.
  wanted(ahead = 3) {
    if (!this.count) return [];
    const frames = [this.frame];
    for (let k = 1; this.playing && !this.newest && k <= ahead && this.frame + k <= this.last; k++) frames.push(this.frame + k);
    return frames;
  }
}

// Frames that were asked for and have come, by a key; the oldest go when there are too many, or they are too large.
export class Cache {
  constructor(most = 400, bytes = 256e6) {
    Object.assign(this, { most, bytes, held: 0, frames: new Map(), asked: new Set() });
  }

  get(key) {
    return this.frames.get(key);
  }

  // Ask "fetch" for what is neither here nor on its way, while less than "credits" answers are outstanding.
  ask(key, fetch, credits = 4) {
    if (this.frames.has(key) || this.asked.has(key) || this.asked.size >= credits) return;
    const { asked } = this;
    asked.add(key);
    fetch().then((frame) => { asked.delete(key); if (asked === this.asked) this.put(key, frame); }, () => asked.delete(key));
  }

  put(key, frame) {
    this.frames.set(key, frame);
    this.held += frame.bytes;
    for (const [old, { bytes }] of this.frames) {
      if ((this.frames.size <= this.most && this.held <= this.bytes) || old === key) break;
      this.frames.delete(old);
      this.held -= bytes;
    }
  }

  clear() {
    this.frames.clear();
    this.asked = new Set();
    this.held = 0;
  }
}
