// SPDX-License-Identifier: GPL-2.0-only
// A hand that pulls at objects while the run goes on: where it is, and what the server is told of it.

const OFTEN = 30, AGAIN = 500; // milliseconds between two words on a hand that moves, and on one that does not

export class Hand {
  // free() tells whether there is something to pull at now.
  constructor(canvas, stage, scene, source, free) {
    Object.assign(this, { canvas, stage, scene, source, free, held: null, to: null, told: 0, moved: false });
    const at = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
    canvas.addEventListener("pointerdown", (event) => event.button === 0 && !event.shiftKey && this.take(event, ...at(event)), true);
    canvas.addEventListener("pointermove", (event) => this.held && event.pointerId === this.pointer && this.move(...at(event)), true);
    for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => event.pointerId === this.pointer && this.letGo());
    setInterval(() => this.held && this.tell(AGAIN), 100);
  }

  // Whether a point of the canvas shows something to pull at.
  finds(x, y) {
    const found = this.free() ? this.stage.pick(x, y) : null;
    return found && !this.scene.objects[found.object].still ? found : null;
  }

  take(event, x, y) {
    const found = this.finds(x, y);
    if (!found) return;
    this.stage.orbit.enabled = false;
    this.pointer = event.pointerId;
    this.canvas.setPointerCapture(event.pointerId);
    this.held = found;
    this.away = found.away;
    this.move(x, y);
  }

  // The hand stays as far from the camera's plane as the point was when it was taken.
  move(x, y) {
    const { origin, way, ahead } = this.stage.ray(x, y), taken = (this.depth ??= this.away * dot(way, ahead));
    this.to = origin.map((o, k) => o + (taken / dot(way, ahead)) * way[k]);
    this.moved = true;
    this.draw();
    this.tell(OFTEN);
  }

  tell(after) {
    const now = performance.now();
    if (now - this.told < (this.moved ? OFTEN : after)) return;
    [this.told, this.moved] = [now, false];
    const { object, vertex, weight } = this.held;
    this.source.pull({ object, vertex, weight, to: this.to });
  }

  letGo() {
    if (!this.held) return;
    this.held = this.to = this.depth = null;
    this.stage.orbit.enabled = true;
    this.source.pull(null);
    this.draw();
  }

  // The line from the point that is held to the hand.
  draw() {
    const { held, to, stage: { at, extras } } = this;
    extras.pull(held && [0, 1, 2].map((d) => held.vertex.reduce((sum, v, k) => sum + held.weight[k] * at[3 * v + d], 0)), to);
    this.stage.changed = true;
  }
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
