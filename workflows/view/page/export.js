// The export dialog: masks, overlay and all that `moseg export` writes, into the output folder.

import { post } from "./api.js";
import { announce, find, make, plural } from "./elements.js";
import { model, result } from "./model.js";

const dialog = find("export-dialog");
let form = null;

const checkBox = (name, value, text, isDisabled) =>
  make("label", { class: "check" }, make("input", { type: "checkbox", name, value, disabled: isDisabled, "aria-describedby": isDisabled && "why-disabled" }), make("span", {}, make("b", {}, value), ` ${text}`));

const field = (label, input, note) => make("label", { class: "field" }, label, input, note && make("span", { class: "muted" }, note));

const build = () => {
  const { exports, objects, out, hasVideo, exportCommand, viewCommand } = result();
  // Who names objects wants to see it.
  const hasNames = objects.some(({ name }) => name);
  const needs = (entry) => entry.needsFrames && !hasVideo;
  const status = make("p", { role: "status", id: "export-status" });
  const progress = make("progress", { id: "export-progress", "aria-label": "writing", hidden: true });
  form = make(
    "form",
    { method: "dialog", onsubmit: (event) => { event.preventDefault(); write(form, status, progress); } },
    make("h2", { id: "export-heading" }, "Export"),
    make("p", {}, "Writes masks/ and motion.json as corrected, and what is chosen here, into ", make("code", {}, out), "."),
    !hasVideo && make("p", { id: "why-disabled", class: "note" }, "Grey choices contain frames, and this page was opened without the video. Write here, then run ", make("code", {}, exportCommand), "; or open the page with the video: ", make("code", {}, viewCommand), "."),
    make(
      "fieldset",
      {},
      make("legend", {}, "Overlay"),
      field("style", make("select", { name: "overlay" }, ...exports.overlays.map((name) => make("option", { value: name }, name)))),
      field("size", make("select", { name: "overlaySize" }, make("option", { value: "analysed" }, "as analysed"), make("option", { value: "video", disabled: !hasVideo, "aria-describedby": !hasVideo && "why-disabled" }, "the video's own"))),
      make("label", { class: "check" }, make("input", { type: "checkbox", name: "sideBySide" }), "side by side"),
      make("label", { class: "check" }, make("input", { type: "checkbox", name: "identities", checked: hasNames }), "numbers and names of the objects"),
    ),
    make("fieldset", { class: "formats" }, make("legend", {}, "Formats"), ...exports.formats.map((entry) => checkBox("formats", entry.name, entry.about, needs(entry)))),
    make(
      "fieldset",
      { class: "formats" },
      make("legend", {}, "Frames and masks as one set"),
      ...exports.sets.map((entry) => checkBox("sets", entry.name, entry.about, needs(entry))),
      field("only each n-th frame, or one in so many seconds (0.5s)", make("input", { type: "text", name: "every", size: 6, placeholder: "all" })),
    ),
    field("widen what is to be ignored, px", make("input", { type: "number", name: "dilate", min: 0, max: 200, placeholder: "default" })),
    // Beside the button, where what was written is seen without scrolling.
    make("div", { class: "dialog-buttons" }, make("div", { class: "dialog-said" }, progress, status), make("button", { type: "submit", class: "is-main", id: "write" }, "Write"), make("button", { type: "button", onclick: () => dialog.close() }, "Close")),
  );
  dialog.replaceChildren(form);
};

const write = async (from, status, progress) => {
  const values = new FormData(from);
  const button = find("write");
  button.disabled = true;
  progress.hidden = false;
  progress.removeAttribute("value");
  status.className = "";
  status.textContent = "Writing …";
  try {
    const { written, numFrames } = await post("export", {
      revision: model.state.revision,
      overlay: values.get("overlay"),
      overlaySize: values.get("overlaySize"),
      sideBySide: values.has("sideBySide"),
      identities: values.has("identities"),
      formats: values.getAll("formats"),
      sets: values.getAll("sets"),
      every: values.get("every").trim() || null,
      dilate: values.get("dilate") === "" ? null : Number(values.get("dilate")),
    });
    status.replaceChildren(`${plural(numFrames, "frame")}: `, ...written.map((path) => make("code", {}, path, " ")));
    announce(`${plural(written.length, "file or folder")} written`);
  } catch (error) {
    status.className = "is-error";
    status.textContent = error.message;
    announce(error.message);
  } finally {
    button.disabled = false;
    progress.hidden = true;
  }
};

export const openExport = () => {
  if (!result() || dialog.open) return;
  build();
  dialog.showModal();
};

export const startExport = () => find("export").addEventListener("click", openExport);
