// Brush strokes and clicks on the picture, by pointer or by keys, in px of the video's own frames.

import { announce, find } from "./elements.js";
import { labelsAt, proposalsAt } from "./media.js";
import { changed, freeIdentity, model, nameOf, on, only, result, select } from "./model.js";
import { sendEdit } from "./edits.js";

const BRUSHES = new Set(["paint", "erase"]);
const FAR = 8; // px of a step by arrows, without the shift key
const canvas = find("picture");
let stroke = null; // points of the stroke that is being made
let cursor = null; // place of the pointer or of the keys' cross

// Canvas pixels and the video's: pixel centres are at integers in both.
const toVideo = ({ x, y }, { grid, width, height }) => [
  Number((((x + 0.5) * width) / grid.width - 0.5).toFixed(1)),
  Number((((y + 0.5) * height) / grid.height - 0.5).toFixed(1)),
];

const placeOf = (event) => {
  const box = canvas.getBoundingClientRect();
  return {
    x: ((event.clientX - box.left) / box.width) * canvas.width - 0.5,
    y: ((event.clientY - box.top) / box.height) * canvas.height - 0.5,
  };
};

const radiusOnCanvas = ({ grid, width }) => (model.radius * grid.width) / width;

// The brush, its stroke so far, and the cross of the keys.
export const drawBrush = (context, shown) => {
  if (BRUSHES.has(model.tool) && stroke?.length) {
    context.save();
    context.lineCap = "round";
    context.lineJoin = "round";
    context.lineWidth = 2 * radiusOnCanvas(shown);
    context.strokeStyle = model.tool === "paint" ? "rgb(80 200 255 / 55%)" : "rgb(255 90 60 / 55%)";
    context.beginPath();
    context.moveTo(stroke[0].x, stroke[0].y);
    for (const { x, y } of stroke) context.lineTo(x, y + (stroke.length === 1 ? 0.01 : 0));
    context.stroke();
    context.restore();
  }
  if (!cursor || model.tool === "select") return;
  context.save();
  context.beginPath();
  context.arc(cursor.x, cursor.y, BRUSHES.has(model.tool) ? radiusOnCanvas(shown) : 5, 0, 2 * Math.PI);
  context.lineWidth = 3;
  context.strokeStyle = "rgb(0 0 0 / 70%)";
  context.stroke();
  context.lineWidth = 1.2;
  context.strokeStyle = "#fff";
  context.stroke();
  context.restore();
};

// What lies under a place: an object of the result, else a rejected proposal, else 0.
const identityAt = async ({ x, y }) => {
  const shown = result();
  const column = Math.min(Math.max(Math.round(x), 0), shown.grid.width - 1);
  const row = Math.min(Math.max(Math.round(y), 0), shown.grid.height - 1);
  const at = row * shown.grid.width + column;
  const found = (await labelsAt(shown.key, model.frame))[at];
  if (found || !model.hasRejected) return found;
  const proposed = (await proposalsAt(model.frame))[at];
  return shown.rejected.some(({ identity }) => identity === proposed) ? proposed : 0;
};

const choose = async (place, isMore) => {
  const identity = await identityAt(place);
  const chosen = new Set(isMore ? model.selected : []);
  if (identity) {
    if (chosen.has(identity)) chosen.delete(identity);
    else chosen.add(identity);
  }
  select(chosen);
  announce(identity ? `object ${nameOf(identity)} ${chosen.has(identity) ? "selected" : "not selected"}` : "no object here");
};

const finish = async () => {
  const shown = result();
  const points = (stroke ?? []).map((place) => toVideo(place, shown));
  stroke = null;
  if (!points.length) return;
  const strokes = [{ radius: model.radius, points }];
  const target = only();
  if (model.tool === "paint") {
    const object = target ?? freeIdentity();
    await sendEdit({ paint: { object, frame: model.frame, strokes } }, `painted object ${object} in frame ${model.frame}`);
    select([object]);
  } else {
    const which = target === null ? {} : { object: target };
    await sendEdit({ erase: { ...which, frame: model.frame, strokes } }, `erased in frame ${model.frame}`);
  }
};

const add = async (place) => {
  const shown = result();
  const object = freeIdentity();
  const edit = { add: { object, frame: model.frame, points: [toVideo(place, shown)], by: model.growing } };
  if (await sendEdit(edit, `object ${object} added`)) select([object]);
};

const extend = (place) => {
  const before = stroke.at(-1);
  // Nearer points change nothing that can be seen.
  if (Math.hypot(place.x - before.x, place.y - before.y) >= 1.5) stroke.push(place);
};

// One dab, or one click, at the cross of the keys; the brush stays down until the key is pressed again.
const pressKey = async () => {
  if (model.tool === "select") await choose(cursor, false);
  else if (model.tool === "add") await add(cursor);
  else if (stroke === null) {
    stroke = [cursor];
    announce("brush down: arrows draw, Enter lifts it, Escape drops the stroke");
  } else await finish();
  changed("tool");
};

export const cancelStroke = () => {
  if (stroke === null) return false;
  stroke = null;
  changed("tool");
  return true;
};

const onKey = (event) => {
  const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
  if (by && model.tool !== "select" && !event.ctrlKey && !event.metaKey && !event.altKey) {
    event.preventDefault();
    event.stopPropagation();
    const far = event.shiftKey ? 1 : FAR;
    cursor ??= { x: canvas.width / 2, y: canvas.height / 2 };
    cursor = {
      x: Math.min(Math.max(cursor.x + by[0] * far, 0), canvas.width - 1),
      y: Math.min(Math.max(cursor.y + by[1] * far, 0), canvas.height - 1),
    };
    if (stroke) extend(cursor);
    changed("tool");
  } else if (event.key === "Enter" && result() && !event.ctrlKey) {
    event.preventDefault();
    cursor ??= { x: canvas.width / 2, y: canvas.height / 2 };
    pressKey();
  }
};

export const startStrokes = () => {
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !result()) return;
    const place = placeOf(event);
    if (model.tool === "select") choose(place, event.shiftKey || event.ctrlKey || event.metaKey);
    else if (model.tool === "add") add(place);
    else {
      canvas.setPointerCapture(event.pointerId);
      stroke = [place];
      changed("tool");
    }
  });
  canvas.addEventListener("pointermove", (event) => {
    if (model.tool === "select" || !result()) return;
    cursor = placeOf(event);
    if (stroke) for (const each of event.getCoalescedEvents?.() ?? [event]) extend(placeOf(each));
    changed("tool");
  });
  canvas.addEventListener("pointerup", () => stroke && finish());
  canvas.addEventListener("pointercancel", cancelStroke);
  canvas.addEventListener("pointerleave", () => {
    if (stroke) return;
    cursor = null;
    changed("tool");
  });
  canvas.addEventListener("keydown", onKey);
  on("tool", () => {
    canvas.dataset.tool = model.tool;
  });
};
