// The first page: a video is dropped in, or a finished run of the store is opened. Then the progress of the work.

import { post, upload } from "./api.js";
import { announce, find, make, showMessage } from "./elements.js";
import { model, on } from "./model.js";

const PHASES = { empty: "start", working: "working", failed: "working", ready: "editor" };

const send = async (file) => {
  const bar = find("upload");
  bar.hidden = false;
  showMessage("");
  try {
    await upload(file, (share) => {
      bar.value = share;
    });
    announce(`${file.name} is copied`);
  } catch (error) {
    showMessage(error.message);
  } finally {
    bar.hidden = true;
  }
};

const open = async (run) => {
  try {
    await post("open", { run });
  } catch (error) {
    showMessage(error.message);
  }
};

const drawRuns = (runs) => {
  find("runs").hidden = !runs.length;
  find("run-list").replaceChildren(
    ...runs.map(({ run, name, frames }) =>
      make("li", {}, make("button", { type: "button", onclick: () => open(run) }, make("b", {}, name), make("span", { class: "muted" }, ` ${frames} frames · ${run}`))),
    ),
  );
};

const drawPhase = () => {
  const { phase, message, runs } = model.state;
  document.body.dataset.phase = phase;
  for (const id of new Set(Object.values(PHASES))) find(id).hidden = PHASES[phase] !== id;
  find("bar-buttons").hidden = phase !== "ready";
  find("retry").hidden = phase !== "failed";
  find("progress").hidden = phase === "failed";
  find("working-heading").textContent = phase === "failed" ? "The work has stopped" : "Looking for what moves";
  if (phase === "empty") drawRuns(runs);
  if (message && !model.state.result) showMessage(message);
  const shown = model.state.result;
  find("title").textContent = shown ? shown.name : model.state.name;
  document.title = shown || model.state.name ? `${shown ? shown.name : model.state.name} – moseg view` : "moseg view";
  find("facts").textContent = shown ? `${shown.width} × ${shown.height} px · ${shown.numFrames} frames · ${Number(shown.fps.toFixed(2))} fps` : "";
};

let lastSaid = 0;

export const showProgress = ({ what, stage, done, total, secondsLeft }) => {
  const bar = find("progress");
  bar.value = total ? done / total : 0;
  const left = secondsLeft === null ? "" : `, about ${secondsLeft} s left`;
  const text = total ? `${what}: ${stage.replaceAll("_", " ")}, ${done} of ${total}${left}` : "";
  find("progress-text").textContent = text;
  if (text && Date.now() - lastSaid > 10000) {
    lastSaid = Date.now();
    announce(text);
  }
};

export const startStart = () => {
  const drop = find("drop");
  const stop = (event) => event.preventDefault();
  // A file that is dropped beside the box must not replace the page.
  addEventListener("dragover", stop);
  addEventListener("drop", stop);
  drop.addEventListener("dragover", () => drop.classList.add("is-over"));
  drop.addEventListener("dragleave", () => drop.classList.remove("is-over"));
  drop.addEventListener("drop", (event) => {
    drop.classList.remove("is-over");
    const [file] = event.dataTransfer.files;
    if (file && model.state?.phase === "empty") send(file);
  });
  find("file").addEventListener("change", (event) => {
    const [file] = event.target.files;
    if (file) send(file);
  });
  find("retry").addEventListener("click", async () => {
    try {
      showMessage("");
      await post("retry", {});
    } catch (error) {
      showMessage(error.message);
    }
  });
  on("state", drawPhase);
};
