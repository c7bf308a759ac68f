// SPDX-License-Identifier: GPL-2.0-only
// The scene's text with its problems, and running it again; only where the server offers it.
import { byId, element } from "./panel.js";

const QUIET = 400; // milliseconds without typing before a text is checked

// `most`: bytes of a text below which the server takes it.
export async function offerEditing(source, most) {
  if (byId("editor")) return;
  const text = element("textarea", { spellcheck: false, rows: 18, ariaLabel: "text of the scene" }), problems = element("div", { id: "problems" });
  const again = element("button", { id: "again", textContent: "run again", title: "Run this text into a folder of its own (Ctrl+Enter)" });
  const panel = element("details", { id: "editor", open: true }, element("summary", { textContent: "Scene" }), text, problems, again);
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
  text.oninput = () => {
    clearTimeout(due);
    due = setTimeout(() => send(false), QUIET);
  };
  text.onkeydown = (event) => { if (event.key === "Enter" && event.ctrlKey && !again.disabled) run(); };
  again.onclick = run;
  text.value = (await source.edit()).text;
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
