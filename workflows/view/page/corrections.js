// The corrections in force, undo and redo, and the command that gives the same result without this page.

import { announce, find, make, plural, refill } from "./elements.js";
import { redo, undo } from "./edits.js";
import { model, on, result } from "./model.js";

const copy = async (text) => {
  try {
    await navigator.clipboard.writeText(text);
    announce("copied");
  } catch {
    announce("not copied: select the text and copy it");
  }
};

const draw = () => {
  const shown = result();
  if (!shown) return;
  const { corrections, command } = shown;
  refill(
    find("corrections"),
    make("h2", { id: "corrections-heading" }, `Corrections (${corrections.edits.length + corrections.settings.length})`),
    corrections.edits.length
      ? make("ol", { class: "edits" }, ...corrections.edits.map((text) => make("li", {}, text)))
      : !corrections.settings.length && make("p", { class: "muted" }, "None yet."),
    corrections.settings.length > 0 && make("ul", { class: "in-force", "aria-label": "settings" }, ...corrections.settings.map((text) => make("li", {}, text))),
    make("h3", {}, "The same without this page"),
    make("pre", { class: "command", tabindex: 0, id: "command", "aria-label": "command" }, command),
    make("button", { type: "button", "data-key": "copy", onclick: () => copy(command) }, "Copy"),
  );
  const list = find("corrections").querySelector("ol");
  if (list) list.scrollTop = list.scrollHeight;
};

// Most changes are done before a word of it could be read.
const SLOW_MS = 300;
let timer = 0;
let isSlow = false;

const followWork = () => {
  clearTimeout(timer);
  isSlow = false;
  if (model.isBusy) timer = setTimeout(() => { isSlow = true; drawBar(); announce("computing"); }, SLOW_MS);
  drawBar();
};

const drawBar = () => {
  const shown = result();
  const { canUndo = false, canRedo = false, edits = [], settings = [], file = "" } = shown?.corrections ?? {};
  find("undo").disabled = !canUndo;
  find("redo").disabled = !canRedo;
  find("export").disabled = !shown;
  const count = [plural(edits.length, "correction"), settings.length ? plural(settings.length, "setting") : ""].filter(Boolean).join(", ");
  find("saved").textContent = !shown ? "" : isSlow ? "computing …" : edits.length || settings.length ? `${count} saved in ${file}` : "no corrections";
};

export const startCorrections = () => {
  find("undo").addEventListener("click", undo);
  find("redo").addEventListener("click", redo);
  on("state", draw);
  on("state", drawBar);
  on("busy", followWork);
};
