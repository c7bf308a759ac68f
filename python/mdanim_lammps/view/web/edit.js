// SPDX-License-Identifier: GPL-2.0-only
// The scene's text with its problems, sliders for its numbers, and running it again; only where the server offers it.
import { letsOf, withLet } from "./lets.js";
import { byId, element } from "./panel.js";

const QUIET = 400; // milliseconds without typing before a text is checked

// `most`: bytes of a text below which the server takes it.
export async function offerEditing(source, most) {
  if (byId("editor")) return;
  const text = element("textarea", { spellcheck: false, rows: 12, ariaLabel: "text of the scene" }), problems = element("div", { id: "problems" });
  const again = element("button", { id: "again", textContent: "run again", title: "Run this text into a folder of its own (Ctrl+Enter)" });
  const sliders = element("div", { id: "lets", className: "lets" });
  const panel = element("details", { id: "editor", open: true }, element("summary", { textContent: "Scene" }), sliders, text, problems, again);
  document.querySelector("aside").prepend(panel);
  let due;
  const show = ({ problems: found, started }) => {
    again.disabled = found.some(({ severity }) => severity === "error");
    problems.replaceChildren(...found.map((problem) => line(problem, text)));
    if (started) again.textContent = "starting …";
  };
  const failed = ({ message }) => show({ problems: [{ line: 0, message, severity: "error" }] });
  const send = (run) => {
    if (new Blob([text.value]).size >= most) return failed({ message: `the text is too long for a page: run it in a terminal` });
    return source.edit(text.value, run).then(show, failed);
  };
  const run = () => send(true);
  const changed = () => {
    clearTimeout(due);
    due = setTimeout(() => send(false), QUIET);
  };
  text.oninput = () => {
    offerLets(sliders, text, changed, run);
    changed();
  };
  text.onkeydown = (event) => { if (event.key === "Enter" && event.ctrlKey && !again.disabled) run(); };
  again.onclick = run;
  text.value = (await source.edit()).text;
  offerLets(sliders, text, changed, run);
}

// A slider for each number that has a name: it changes the text while it is moved, and runs it when it is let go.
function offerLets(place, text, changed, run) {
  place.replaceChildren(...letsOf(text.value).flatMap(({ line, name, value, unit, low, high, step }) => {
    const slider = element("input", { type: "range", min: low, max: high, step, value, ariaLabel: name }), told = element("output", { textContent: `${value} ${unit}` });
    slider.oninput = () => {
      text.value = withLet(text.value, line, slider.valueAsNumber);
      told.textContent = `${slider.valueAsNumber} ${unit}`;
      changed();
    };
    slider.onchange = run;
    return [element("span", { textContent: name }), slider, told];
  }));
}

// One problem; a click leads to its line.
function line({ line: number, message, hint, severity }, text) {
  const place = element("button", { textContent: number ? `line ${number}` : "scene", disabled: !number });
  place.onclick = () => {
    const rows = text.value.split("\n"), start = rows.slice(0, number - 1).reduce((sum, row) => sum + row.length + 1, 0);
    text.focus();
    text.setSelectionRange(start, start + rows[number - 1].length);
    text.scrollTop = (number - 4) * (text.scrollHeight / rows.length);
  };
  return element("p", { className: severity }, place, ` ${message}`, ...(hint ? [element("br"), element("em", { textContent: hint })] : []));
}
