// SPDX-License-Identifier: GPL-2.0-only
// The numbers that a scene's text gives names: where they stand, and the text with another one. Nothing here touches the page.

const LINE = /^(\s*let\s+([A-Za-z_]\w*)\s*=\s*)([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)((?:[ \t]*[A-Za-z%°µΩ][\w%°µΩ^*/.-]*)?)[ \t]*(?:#.*)?$/;
const STEPS = 100; // of a slider

// A `let` of a number with a unit, for each line that is one: its line from 0, name, value, unit and the least and most that a slider gives.
export function letsOf(text) {
  return text.split("\n").flatMap((row, line) => {
    const found = LINE.exec(row.replace(/\r$/, ""));
    return found ? [{ line, name: found[2], value: Number(found[3]), unit: found[4].trim(), ...rangeOf(found[3]) }] : [];
  });
}

// From nothing to twice the value, in steps of whole digits; a whole number stays one.
export function rangeOf(written) {
  const value = Number(written), whole = /^[+-]?\d+$/.test(written), most = Math.abs(value) || 1, ends = value === 0 ? [-1, 1] : [Math.min(0, 2 * value), Math.max(0, 2 * value)];
  const fine = 10 ** Math.floor(Math.log10((2 * most) / STEPS)), step = whole && value !== 0 ? Math.max(1, Math.round((2 * most) / STEPS)) : fine;
  return { low: ends[0], high: ends[1], step };
}

// The text with another value on a line of letsOf.
export function withLet(text, line, value) {
  const rows = text.split("\n");
  rows[line] = rows[line].replace(LINE, (row, before, _, old) => before + written(value) + row.slice(before.length + old.length));
  return rows.join("\n");
}

// A number in the digits that a slider gives, without those that are of binary fractions.
const written = (value) => String(Number(value.toPrecision(12)));
