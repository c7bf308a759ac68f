// SPDX-License-Identifier: GPL-2.0-only
// Puts the parts together: what is heard, what is seen, what is pressed.
import { offerEditing } from "./edit.js";
import { Hand } from "./hands.js";
import { ADDED, STRAIN, PARTICLES, cameraLine, nearlyMost, number, ownersAt } from "./message.js";
import { Energies, Height, KEYS, byId, element, executorColor, offer, roundStrain, say, showCost, showExpects, showLegend, showObject, strainColor, table, typing } from "./panel.js";
import { Cache, Player, SPEEDS } from "./player.js";
import { Embedded, Socket } from "./source.js";
import { pointer } from "./pointer.js";
import { ofMotion } from "./quantities.js";
import { Saving } from "./saving.js";
import { Second } from "./second.js";
import { Shows } from "./shows.js";
import { COARSEST, Stage } from "./stage.js";

const SLOW = 60, REST = 350; // milliseconds: of a picture that is too slow, and without motion before one in full
const TOLD = 200; // milliseconds between two lots of numbers beside pictures that are eased: to draw these takes as long as a picture
const GROW_SHARE = 2; // time between two questions for lines that grow, over that which the answers took
const LIVE = ["preparing", "running", "paused"];
const run = { file: null, count: 0, total: 0, executors: 1, state: "", message: "", seconds: 0, cost: {}, facts: {}, owners: [] };
const energies = new Energies(), height = new Height(), cache = new Cache();
const report = byId("replay"); // in a report: the block of data
let source, scene, stage, player, shows, saving, second = null, hand = null, shown = null, shownKey = "", picked = null, ease = 0, slow = 0, drawnAt = 0, rested = true, failedAt = 0, range = 0.002, lastTick = 0, toldKey = "", toldAt = 0, asked = "", growAt = 0;

async function start() {
  byId("speed").append(...SPEEDS.map((x) => element("option", { value: x, textContent: `${x} ×`, selected: x === 1 })));
  byId("keys").querySelector("table").append(...table(KEYS).children);
  source = report ? new Embedded(report.textContent) : new Socket();
  const opening = source.open(); // which reads the address
  if (!report) history.replaceState(null, "", "/");
  await opening;
  source.refused = (message) => { asked = ""; run.message = message; refresh(); };
  source.lost = () => say("lost", "The server has ended: frames that are not here yet cannot be shown. View the folder again with: mdanim-lammps view DIR");
  source.listen(hear);
  while (!(scene = await source.scene().catch(() => null))) await new Promise((done) => setTimeout(done, 200)); // until the run has made its folder
  document.title = byId("title").textContent = scene.title || "mdanim-lammps";
  document.body.classList.toggle("dark", scene.dark);
  document.body.style.setProperty("--low-sky", `rgb(${scene.background[0]})`);
  document.body.style.setProperty("--high-sky", `rgb(${scene.background[1]})`);
  const width = { grid: scene.grid, checker: 5 * scene.grid }[scene.floor === null ? "" : scene.pattern];
  if (width) byId("scale").textContent = `${scene.pattern} ${number(width)} m`;
  player = new Player(scene.frameTime);
  stage = new Stage(byId("stage"), scene);
  if (stage.slow) ease = COARSEST;
  for (const [id, on] of [["liquid", scene.liquid], ["walls", scene.walls], ["springs", scene.springs && !report], ["particles", !report]]) byId(`show-${id}`).parentElement.hidden = !on;
  if (!scene.objects.length) for (const id of ["object-panel", "arrows", "trail", "follow"]) byId(id).hidden = true;
  if (!scene.objects.length) for (const id of ["only", "show-surface", "show-particles", "show-springs", "show-boxes", "colour"]) byId(id).parentElement.hidden = true;
  offer("strain", !report && scene.springs, "by strain", report ? "in a view" : "where save all is asked for");
  shows = new Shows(scene, source, stage);
  saving = new Saving(player, () => [{ stage, overlay: shows.overlay, frame: shown, canvas: shows.canvas }, ...(second ? [{ ...second, frame: second.frame }] : [])], seen);
  controls();
  byId("hello").textContent = "drag to turn, wheel to zoom, click an object to know it";
  player.play(true);
  refresh();
  requestAnimationFrame(tick);
  await shows.begin().catch((error) => say(run.state, error.message));
}

// --- what is heard ----------------------------------------------------------------------------------------------------

function hear({ columns, keep, rows, owners, ...news }) {
  if (run.file !== null && news.file > run.file) { shows?.keep(); return location.reload(); } // another run in the same folder
  Object.assign(run, news);
  if (columns) {
    energies.begin(columns, news.energies ?? 0, keep);
    run.owners = [];
    cache.clear();
  }
  if (rows) energies.add(rows);
  if (owners) run.owners.push(...owners);
  refresh();
}

function refresh() {
  const live = LIVE.includes(run.state), share = run.total ? run.count / run.total : 0;
  say(run.state, run.message);
  if (run.edit) offerEditing(source, run.edit);
  if (player) Object.assign(player, { count: run.count, live });
  if (player && run.hands && live && !hand) offerHand();
  byId("slider").max = Math.max(run.total, 1) - 1;
  byId("ready").style.width = `${100 * share}%`;
  byId("pause").hidden = byId("stop").hidden = byId("newest").hidden = !live;
  if (asked !== run.state) asked = "";
  byId("pause").textContent = asked ? "after this frame …" : run.state === "paused" ? "go on" : "pause run";
  byId("pause").disabled = byId("stop").disabled = run.state === "preparing" || asked !== "";
  const words = live && run.total ? [`${Math.floor(100 * share)} %`] : [];
  if (live && run.seconds && scene && !run.hands) words.push(`${number((run.count * scene.frameTime) / run.seconds, 2)} s of film per second`, `${number(run.seconds * (1 / share - 1), 2)} s left`);
  if (energies.names.length && energies.rows.length) words.push(`energy residual ${number(energies.residual, 2)}`);
  byId("progress").textContent = words.join("   ");
  offer("executor", run.executors > 1, "by executor", "of a run with -n");
  if (live && shows) shows.quantities.live = true;
  if (live && performance.now() > growAt) grow();
  if (shows && !live) shows.ended();
  if (!report) showCost(run.cost, run.facts); // a report has a table of it
  showExpects(run.facts);
}

function offerHand() {
  hand = new Hand(byId("stage"), stage, scene, source, () => LIVE.includes(run.state));
  byId("hello").textContent = "press “go on”, then drag an object to pull at it; drag beside it to turn";
  player.follow(true);
}

// Tell the run, and that it was told: it obeys when it has finished its frame.
function order(what) {
  source.tell(what);
  asked = run.state;
  refresh();
}

// --- what is seen -----------------------------------------------------------------------------------------------------

const checked = (id) => byId(`show-${id}`).checked;
const layers = () => (byId("colour").value === "strain" ? STRAIN : 0) | (checked("particles") || checked("springs") ? PARTICLES : 0) | (scene.added ? ADDED : 0);

function tick(now) {
  requestAnimationFrame(tick);
  player.tick(Math.min(0.25, (now - lastTick) / 1000));
  lastTick = now;
  const bits = layers(), credits = player.newest ? 1 : 4;
  if (now - failedAt > 500) {
    for (const n of player.wanted()) {
      cache.ask(`${n}/${bits}`, () => source.frame(n, bits).catch((error) => { failedAt = performance.now(); say(run.state, error.message); throw error; }), credits);
    }
  }
  const key = `${player.frame}/${bits}`, frame = cache.get(key);
  if (frame && key !== shownKey) show(frame, key);
  byId("play").classList.toggle("on", player.playing && !player.newest);
  byId("newest").setAttribute("aria-pressed", String(player.newest));
  if (shown && toldKey !== shownKey && (!ease || !player.playing || now - toldAt > TOLD)) tell(now);
  if ((stage.changed || second?.stage.changed) && shown) draw(now, 0);
  else if (!rested && !player.playing && now - drawnAt > REST) draw(now, 1);
}

function show(frame, key) {
  [shown, shownKey] = [frame, key];
  stage.show(frame);
  second?.show(frame.time);
  hand?.draw();
  if (frame.strain) paintStrain(frame.strain);
  else if (byId("colour").value === "executor") stage.paint([...ownersAt(run.owners, frame.frame, scene.objects.length)].map(executorColor));
}

// Update the values of the visible frame beside the picture.
function tell(now) {
  [toldKey, toldAt] = [shownKey, now];
  byId("slider").value = shown.frame;
  byId("clock").textContent = `frame ${shown.frame}/${Math.max(run.total, 1) - 1}   t = ${shown.time.toFixed(3)} s`;
  byId("camera").textContent = cameraWords();
  energies.at(shown.time);
  shows.curves.at(shown.time);
  height.at(shown.time);
  about();
}

function paintStrain(strain) {
  range = Math.max(range, roundStrain((nearlyMost(strain) / 255) * scene.mostStrain, scene.mostStrain));
  const colors = Array.from({ length: 256 }, (_, k) => strainColor(((k / 255) * scene.mostStrain) / range));
  stage.paint(null, (i) => colors[strain[i]]);
  showLegend("strain", range);
}

function about() {
  const owner = run.executors > 1 && shown && picked !== null ? ownersAt(run.owners, shown.frame, scene.objects.length)[picked] : null;
  showObject(scene, shown, picked, owner);
}

// Pictures that are slow are made with fewer pixels while something moves, and in full at rest.
function draw(now, full) {
  const gap = now - drawnAt;
  if (!full && gap < 1000 && (player.playing || stage.moving)) slow = 0.7 * slow + 0.3 * gap;
  if (slow > SLOW && ease < COARSEST && !full) [ease, slow] = [ease + 1, 0];
  for (const one of [stage, second?.stage].filter(Boolean)) { one.quality(full ? 0 : ease); one.draw(); }
  shows.draw(shown);
  second?.draw();
  saving.drawn();
  rested = full || !ease;
  drawnAt = now;
  if (!page.drawn++) performance.mark("first picture");
  if (stage.moving || full) byId("camera").textContent = cameraWords();
}

function cameraWords() {
  const name = picked !== null && shown && stage.looksAt(box(picked)) ? scene.objects[picked].name : "", there = /^[A-Za-z_][A-Za-z0-9_.\-]*(\[\d+\])*$/.test(name);
  return cameraLine(shown?.time ?? 0, stage.camera.position.toArray(), there ? name : stage.orbit.target.toArray());
}

// Corner and size of an object's box.
const box = (k) => shown.object.subarray(12 * k, 12 * k + 6);

// --- what is pressed --------------------------------------------------------------------------------------------------

function controls() {
  const press = (id, act) => (byId(id).onclick = (event) => { if (event.detail) byId(id).blur(); act(); }), step = (n) => player.go(player.frame + n);
  press("play", () => player.play());
  press("first", () => player.go(0));
  press("back", () => step(-1));
  press("next", () => step(1));
  press("newest", () => player.follow());
  press("pause", () => order(run.state === "paused" ? "go" : "pause"));
  press("stop", () => order("stop"));
  press("see", see);
  press("follow", () => byId("follow").setAttribute("aria-pressed", String(stage.follow(picked) !== null)));
  press("home", () => stage.seeStart());
  press("copy", copy);
  press("beside", () => (second ? compare(null) : byId("report-file").click()));
  byId("report-file").onchange = ({ target }) => { if (target.files[0]) compare(target.files[0]); target.value = ""; };
  press("help", () => byId("keys").showModal());
  byId("slider").oninput = (event) => player.go(Number(event.target.value));
  byId("speed").onchange = (event) => (player.speed = Number(event.target.value));
  byId("colour").onchange = () => { stage.paintOwn(); showLegend(byId("colour").value, range, run.executors); shownKey = ""; };
  const toggle = (id, act) => (byId(`show-${id}`).onchange = (event) => { act(event.target.checked); shownKey = ""; stage.changed = true; });
  toggle("surface", (on) => (stage.surface.visible = on));
  toggle("shadows", (on) => (stage.sun.castShadow = on));
  toggle("liquid", (on) => (stage.liquid.visible = on));
  toggle("particles", (on) => { stage.extras.particles.visible = on; stage.seeInside(on || checked("springs")); });
  toggle("springs", async (on) => { stage.extras.springs.visible = on; stage.seeInside(on || checked("particles")); if (on && !run.bond) stage.extras.join((run.bond = await source.springs())); stage.changed = true; });
  toggle("boxes", (on) => (stage.extras.boxes.visible = on));
  toggle("walls", (on) => (stage.extras.walls.visible = on));
  new ResizeObserver(() => stage.resize()).observe(byId("stage")); // also where a message takes some of its room
  stage.orbit.addEventListener("start", () => { stage.moving = true; byId("hello").hidden = true; });
  stage.orbit.addEventListener("end", () => (stage.moving = false));
  pointer(byId("stage"), scene, stage, choose, (x, y) => hand?.finds(x, y));
  addEventListener("keydown", keyboard);
}

function choose(k) {
  picked = stage.extras.picked = k;
  shownKey = "";
  byId("see").textContent = k === null ? "see all" : "see it";
  byId("camera").textContent = cameraWords();
  about();
  shows.pick(k);
  height.show(null);
  if (k !== null) showHeight();
}

// Ask again for lines that grow while the run goes on: each second, and less often where the answers take long.
async function grow() {
  const begun = performance.now();
  growAt = Infinity;
  if (picked !== null) showHeight();
  await shows?.refresh().catch(() => {});
  growAt = performance.now() + Math.max(1000, GROW_SHARE * (performance.now() - begun));
}

async function showHeight() {
  const k = picked, track = await source.track(k).catch(() => null);
  if (k !== picked || !track) return;
  height.show([[...track.time], [...ofMotion("position.z", track)]]);
  if (shown) height.at(shown.time);
}

// Show a frame and wait until it is drawn.
async function seen(n) {
  player.go(n);
  while (shown.frame !== n || (second && second.stage.frame !== second.frame)) await new Promise(requestAnimationFrame);
  await second?.show(shown.time);
}

function see() {
  if (shown) stage.see(picked === null ? scene.objects.map((_, k) => box(k)) : [box(picked)]);
}

async function copy() {
  await navigator.clipboard.writeText(cameraWords()).then(() => (byId("copy").textContent = "copied"), () => getSelection().selectAllChildren(byId("camera")));
  setTimeout(() => (byId("copy").textContent = "copy line"), 1500);
}

// Show the run of a report beside this one, or this one alone.
async function compare(file) {
  second?.close();
  second = null;
  if (file) second = await Second.load(file, (canvas, of) => new Stage(canvas, of), stage).catch((error) => { say(run.state, `${file.name}: ${error.message}`); return null; });
  byId("beside").textContent = second ? "one run" : "second run";
  stage.resize();
  await second?.begin(shown.time, shows.overlay.arrows);
  await shows.curves.compare(second?.quantities ?? null);
}

const SWITCHES = ["surface", "shadows", "liquid", "particles", "springs", "boxes", "walls"];

function keyboard(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || byId("keys").open || typing(event)) return;
  const many = event.shiftKey ? 10 : 1, act = {
    " ": () => (event.shiftKey ? !byId("pause").hidden && byId("pause").click() : player.play()),
    ArrowRight: () => player.go(player.frame + many), ArrowLeft: () => player.go(player.frame - many), Home: () => player.go(0),
    End: () => (player.live ? player.follow(true) : player.go(player.last)), f: see, c: copy, p: () => byId("shot").click(), g: () => byId("gif").click(), v: () => byId("arrows-velocity").click(), t: () => byId("trail").click(), Escape: () => choose(null), "?": () => byId("keys").showModal(),
  }[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  const number_ = SWITCHES[Number(event.key) - 1], box = number_ && byId(`show-${number_}`);
  if (!act && (!box || box.parentElement.hidden)) return;
  event.preventDefault();
  act ? act() : box.click();
}

// For tests: what the page knows.
const page = (window.mdanim = { run, drawn: 0, get shown() { return shown; }, get player() { return player; }, get stage() { return stage; }, get scene() { return scene; }, get ease() { return ease; }, get source() { return source; }, get hand() { return hand; }, get shows() { return shows; }, get second() { return second; }, cache });

start().catch((error) => say("lost", `The page cannot be shown: ${error.message}`));
