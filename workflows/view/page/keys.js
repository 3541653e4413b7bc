// Keys of the whole page, and the overlay that lists them.

import { find, make } from "./elements.js";
import { redo, undo } from "./edits.js";
import { openExport } from "./export.js";
import { actions } from "./inspector.js";
import { goTo, model, result, select } from "./model.js";
import { isPlaying, play, step, toggleLoop } from "./player.js";
import { cancelStroke } from "./strokes.js";
import { changeRadius, chooseTool, toggleView } from "./tools.js";

const dialog = find("help-dialog");
const GROUPS = [
  ["Player", [["space", "play, pause"], ["← →", "one frame"], ["shift ← →", "ten frames"], ["Home End", "first, last frame"], ["L", "loop"]]],
  ["Show", [["O", "masks"], ["N", "names"], ["R", "rejected proposals"]]],
  ["Tools", [["V", "select"], ["B", "paint"], ["E", "erase"], ["A", "add by a click"], ["[ ]", "brush size"]]],
  ["On the picture", [["arrows", "move the cross (shift: 1 px)"], ["Enter", "click; brush down, brush up"], ["Esc", "drop the stroke"]]],
  ["Objects", [["1 … 9", "select the n-th row"], ["↑ ↓", "rows; with shift several"], ["Enter", "go to its first frame"], ["Esc", "select nothing"]]],
  ["Selected", [["D", "drop"], ["K", "keep, promote"], ["S", "static"], ["M", "moving"], ["G", "merge"], ["X", "split at this frame"], ["F2", "rename"]]],
  ["Corrections", [["ctrl Z", "undo"], ["ctrl Y", "redo (or ctrl shift Z)"], ["ctrl S", "export"], ["?", "these keys"]]],
];

export const openHelp = () => {
  if (dialog.open) return;
  const groups = GROUPS.map(([title, keys]) =>
    make("section", {}, make("h3", {}, title), make("dl", {}, ...keys.map(([key, text]) => make("div", {}, make("dt", {}, make("kbd", {}, key)), make("dd", {}, text))))),
  );
  dialog.replaceChildren(
    make("h2", { id: "help-heading", tabindex: -1, autofocus: true }, "Keys"),
    make("div", { class: "keys" }, ...groups),
    make("div", { class: "dialog-buttons" }, make("button", { type: "button", class: "is-main", onclick: () => dialog.close() }, "Close")),
  );
  dialog.showModal();
};

const chooseRow = (place) => {
  const object = result().objects[place];
  if (object) select([object.identity]);
};

const PLAIN = {
  " ": () => play(!isPlaying()),
  Home: () => goTo(0),
  End: () => goTo(result().numFrames - 1),
  l: toggleLoop,
  o: () => toggleView("hasOverlay"),
  n: () => toggleView("hasNames"),
  r: () => toggleView("hasRejected"),
  v: () => chooseTool("select"),
  b: () => chooseTool("paint"),
  e: () => chooseTool("erase"),
  a: () => chooseTool("add"),
  "[": () => changeRadius(1 / 1.25),
  "]": () => changeRadius(1.25),
  d: actions.drop,
  k: actions.keep,
  s: actions.static,
  m: actions.moving,
  g: actions.merge,
  x: actions.split,
  Delete: actions.drop,
  F2: actions.rename,
  "?": openHelp,
  Escape: () => cancelStroke() || select([]),
};

// Fields take keys themselves, and so do sliders with arrows, and buttons with space.
const isTaken = (event) => {
  const { target, key } = event;
  if (!(target instanceof Element)) return false;
  if (target.matches("input[type=text], input[type=number], textarea, select")) return true;
  if (target.matches("input[type=range]")) return key.startsWith("Arrow") || key === "Home" || key === "End" || key.startsWith("Page");
  if (target.matches("button, summary, input[type=checkbox], a")) return key === " " || key === "Enter";
  return false;
};

const onControl = (event) => {
  const key = event.key.toLowerCase();
  if (key === "z") return event.shiftKey ? redo : undo;
  if (key === "y") return redo;
  return key === "s" ? openExport : null;
};

const onKey = (event) => {
  if (!result() || event.defaultPrevented || find("export-dialog").open || dialog.open || event.altKey) return;
  const isControl = event.ctrlKey || event.metaKey;
  if (isTaken(event) && !(isControl && event.key.toLowerCase() === "s")) return;
  let action;
  if (isControl) action = onControl(event);
  else if (event.key === "ArrowLeft") action = () => step(event.shiftKey ? -10 : -1);
  else if (event.key === "ArrowRight") action = () => step(event.shiftKey ? 10 : 1);
  else if (/^[1-9]$/.test(event.key)) action = () => chooseRow(Number(event.key) - 1);
  else action = PLAIN[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!action) return;
  event.preventDefault();
  action();
};

export const startKeys = () => {
  find("help").addEventListener("click", openHelp);
  addEventListener("keydown", onKey);
};
