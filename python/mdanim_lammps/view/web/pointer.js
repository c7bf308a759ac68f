// SPDX-License-Identifier: GPL-2.0-only
// The mouse in the picture: what it points at.
import { byId } from "./panel.js";

// "choose" is called with the object that is clicked, or null; grabs(x, y) tells whether there is something to pull at.
export function pointer(canvas, scene, stage, choose, grabs) {
  const at = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  let down = [0, 0], looked = 0;
  canvas.addEventListener("pointerdown", (event) => { down = at(event); byId("hello").hidden = true; });
  canvas.addEventListener("pointerup", (event) => {
    const [x, y] = at(event);
    if (event.button === 0 && Math.hypot(x - down[0], y - down[1]) < 4) choose(stage.pick(x, y)?.object ?? null);
  });
  canvas.addEventListener("pointermove", (event) => {
    const now = performance.now(), [x, y] = at(event);
    if (now - looked < 80) return;
    looked = now;
    const found = event.buttons ? null : stage.pick(x, y);
    canvas.style.cursor = found && grabs(x, y) ? "grab" : "";
    byId("hint").hidden = !found;
    if (found) Object.assign(byId("hint"), { textContent: scene.objects[found.object].name }).style.cssText = `left: ${x}px; top: ${y}px`;
  });
  canvas.addEventListener("pointerleave", () => (byId("hint").hidden = true));
}
