// The player: the picture of the frame, play, step, scrub, speed and loop; every frame is shown whole.

import { announce, find, make, makeDrawing } from "./elements.js";
import { cueAt, frameAt, labelsAt, proposalsAt } from "./media.js";
import { changed, goTo, model, nameOf, on, result } from "./model.js";
import { drawLabels, drawNames, readColours } from "./overlay.js";

const AHEAD = 12; // frames that are fetched before they are due
const SPEEDS = [0.1, 0.25, 0.5, 1, 2];
const REJECTED_COLOUR = "#b8b8b8";

const canvas = find("picture");
const scene = document.createElement("canvas");
let composed = ""; // what the scene shows
let timer = 0;
let speed = 1;
let isLooping = true;
let isDrawing = false;
let isStale = false;
let controls = null;

export const isPlaying = () => timer !== 0;

// The picture's size on the canvas, and that of the video.
export const scale = () => {
  const { grid, width, height } = result();
  return { x: width / grid.width, y: height / grid.height };
};

const names = (shown) => new Map(shown.objects.map(({ identity }) => [identity, nameOf(identity)]));

// Everything of one frame, so that picture and labels never differ in time.
const gather = async (shown, frame) => {
  const wantsRejected = model.hasRejected && shown.rejected.length > 0;
  return Promise.all([
    model.cue < 0 ? frameAt(frame) : cueAt(model.cue, frame),
    model.hasOverlay || model.hasNames ? labelsAt(shown.key, frame) : null,
    wantsRejected ? proposalsAt(frame) : null,
  ]);
};

const describeFrame = (shown, frame, picture, labels) => {
  const cue = model.cue < 0 ? "video" : shown.cues[model.cue].name;
  const seen = labels ? shown.objects.filter(({ identity }) => labels.includes(identity)) : [];
  const what = seen.length ? `objects ${seen.map(({ identity }) => nameOf(identity)).join(", ")}` : "no object";
  return `${cue}, frame ${frame}: ${what}${picture ? "" : "; no picture of this frame"}`;
};

const above = [];

// Has `draw(context, shown)` draw above the frame whenever it is painted, such as a brush, which moves without it.
export const drawAbove = (draw) => above.push(draw);

// Draws all but what is above.
const compose = (shown, [picture, labels, proposals]) => {
  const { width, height } = shown.grid;
  scene.width = width;
  scene.height = height;
  const context = scene.getContext("2d");
  if (picture) context.drawImage(picture, 0, 0, width, height);
  const options = { selected: model.selected, opacity: model.opacity };
  if (proposals) {
    const colours = readColours(shown.rejected.map(({ identity }) => ({ identity, colour: REJECTED_COLOUR })));
    drawLabels(context, proposals, width, height, colours, { ...options, lineOnly: true });
  }
  if (labels && model.hasOverlay) drawLabels(context, labels, width, height, readColours(shown.objects), options);
  if (labels && model.hasNames) drawNames(context, labels, width, names(shown));
};

const paintFrame = (shown, frame, content) => {
  const { cue, opacity, hasOverlay, hasNames, hasRejected, selected } = model;
  const wanted = JSON.stringify([shown.key, frame, cue, opacity, hasOverlay, hasNames, hasRejected, [...selected]]);
  if (composed !== wanted) {
    compose(shown, content);
    composed = wanted;
    canvas.setAttribute("aria-label", describeFrame(shown, frame, ...content));
  }
  if (canvas.width !== scene.width || canvas.height !== scene.height) {
    canvas.width = scene.width;
    canvas.height = scene.height;
  }
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.drawImage(scene, 0, 0);
  for (const draw of above) draw(context, shown);
  canvas.dataset.frame = frame;
  canvas.dataset.key = shown.key;
};

// The frame may change while one is fetched: only the last one is drawn next.
export const draw = async () => {
  isStale = isDrawing;
  const shown = result();
  if (isDrawing || !shown) return;
  isDrawing = true;
  const { frame } = model;
  try {
    const content = await gather(shown, frame);
    if (shown === result()) paintFrame(shown, frame, content);
    else isStale = true;
    setFault("");
  } catch (error) {
    // Of a result that another one has replaced, the pictures may be gone.
    if (shown === result()) blankFrame(shown, frame, error.message);
    else isStale = true;
  } finally {
    isDrawing = false;
  }
  if (isStale || frame !== model.frame) draw();
  else {
    changed("drawn");
    if (!model.isBusy) prefetch(shown, frame);
  }
};

const setFault = (text) => {
  if (model.fault === text) return;
  model.fault = text;
  changed("fault");
};

// A frame that cannot be shown is not the one before it.
const blankFrame = (shown, frame, why) => {
  canvas.getContext("2d").clearRect(0, 0, canvas.width, canvas.height);
  composed = "";
  canvas.setAttribute("aria-label", `frame ${frame} cannot be shown`);
  canvas.dataset.frame = frame;
  canvas.dataset.key = shown.key;
  setFault(`Frame ${frame} cannot be shown: ${why}`);
};

const prefetch = (shown, frame) => {
  for (let next = frame + 1; next <= Math.min(frame + (isPlaying() ? AHEAD : 2), shown.numFrames - 1); next += 1) {
    gather(shown, next).catch(() => {});
  }
};

export const step = (by) => {
  play(false);
  goTo(model.frame + by);
  announce(`frame ${model.frame}`);
};

const advance = () => {
  const shown = result();
  // A frame that is not drawn yet is waited for: none is skipped.
  if (isDrawing) return;
  if (model.frame + 1 < shown.numFrames) goTo(model.frame + 1);
  else if (isLooping) goTo(0);
  else play(false);
};

export const play = (isWanted) => {
  clearInterval(timer);
  const shown = result();
  timer = isWanted && shown && shown.numFrames > 1 ? setInterval(advance, 1000 / (shown.fps * speed)) : 0;
  if (isWanted && shown && !isLooping && model.frame + 1 === shown.numFrames) goTo(0);
  if (!controls) return;
  controls.play.setAttribute("aria-pressed", String(isPlaying()));
  controls.play.setAttribute("aria-label", isPlaying() ? "pause" : "play");
};

const SHAPES = {
  first: ["M3 3h2v10H3zM13 3 6.5 8l6.5 5z"],
  previous: ["M11 3 4.5 8l6.5 5z"],
  play: ["M4 2.5v11L13.5 8z", "M4 3h3v10H4zM9 3h3v10H9z"],
  next: ["M5 3l6.5 5L5 13z"],
  last: ["M11 3h2v10h-2zM3 3l6.5 5L3 13z"],
};

const button = (shape, label, keys, onclick) => {
  const [path, other] = SHAPES[shape];
  const paths = [makeDrawing("path", { class: "play", d: path }), other && makeDrawing("path", { class: "pause", d: other })];
  const drawing = makeDrawing("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }, ...paths);
  const made = make("button", { type: "button", class: "icon", "aria-label": label, title: `${label} (${keys})`, onclick }, drawing);
  if (other) made.dataset.play = "";
  return made;
};

const buildTransport = () => {
  const last = () => result().numFrames - 1;
  controls = {
    play: button("play", "play", "space", () => play(!isPlaying())),
    slider: make("input", {
      type: "range", id: "frame", min: 0, value: 0, step: 1, "aria-label": "frame",
      oninput: () => { play(false); goTo(Number(controls.slider.value)); },
    }),
    number: make("input", {
      type: "number", id: "frame-number", min: 0, value: 0, "aria-label": "frame number",
      onchange: () => { play(false); goTo(Number(controls.number.value)); },
    }),
    total: make("span", { class: "muted" }),
    time: make("span", { class: "muted time" }),
    speed: make(
      "select", { id: "speed", "aria-label": "speed", onchange: () => { speed = Number(controls.speed.value); if (isPlaying()) play(true); } },
      ...SPEEDS.map((value) => make("option", { value }, `${value}×`)),
    ),
    loop: make("input", { type: "checkbox", id: "loop", checked: true, onchange: () => { isLooping = controls.loop.checked; } }),
  };
  controls.speed.value = "1";
  controls.play.setAttribute("aria-pressed", "false");
  find("transport").append(
    button("first", "first frame", "Home", () => step(-last())),
    button("previous", "previous frame", "←", () => step(-1)),
    controls.play,
    button("next", "next frame", "→", () => step(1)),
    button("last", "last frame", "End", () => step(last())),
    controls.slider,
    make("span", { class: "frame-number" }, controls.number, controls.total),
    controls.time,
    make("label", {}, make("span", { class: "hidden-text" }, "speed"), controls.speed),
    make("label", { class: "check", title: "loop (L)" }, controls.loop, "loop"),
  );
};

export const toggleLoop = () => controls.loop.click();

export const startPlayer = () => {
  buildTransport();
  on("state", () => {
    const shown = result();
    if (!shown) return;
    controls.slider.max = shown.numFrames - 1;
    controls.number.max = shown.numFrames - 1;
    controls.total.textContent = ` of 0–${shown.numFrames - 1}`;
    find("stage").style.setProperty("--ratio", String(shown.grid.width / shown.grid.height));
  });
  on("state frame", () => {
    const shown = result();
    if (!shown) return;
    controls.slider.value = model.frame;
    controls.slider.setAttribute("aria-valuetext", `frame ${model.frame}`);
    if (document.activeElement !== controls.number) controls.number.value = model.frame;
    controls.time.textContent = `${(model.frame / shown.fps).toFixed(2)} s`;
  });
  on("state frame selection view tool", draw);
};
