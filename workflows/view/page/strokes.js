// Brush strokes and clicks on the picture, by pointer or by keys, in px of the video's own frames.

import { announce, find, showMessage } from "./elements.js";
import { labelsAt, proposalsAt } from "./media.js";
import { changed, freeIdentity, model, nameOf, on, only, result, select } from "./model.js";
import { sendEdit } from "./edits.js";
import { drawAbove, play } from "./player.js";

const BRUSHES = new Set(["paint", "erase"]);
const FAR = 8; // px of a step by arrows, without the shift key
const canvas = find("picture");
let stroke = null; // points of the stroke that is being made
let drawnBy = null; // tool and frame of the stroke: neither changes while it is made
const pending = new Set(); // strokes and clicks that the server is at, which stay in sight until it has answered
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

const CLICK_RADIUS = 5; // px of the canvas: the mark of a click
const radiusOnCanvas = ({ grid, width }) => (model.radius * grid.width) / width;

const drawStroke = (context, shown, { tool, places, radius }) => {
  context.save();
  context.lineCap = "round";
  context.lineJoin = "round";
  context.lineWidth = (2 * radius * shown.grid.width) / shown.width;
  context.strokeStyle = tool === "erase" ? "rgb(255 90 60 / 55%)" : "rgb(80 200 255 / 55%)";
  context.beginPath();
  context.moveTo(places[0].x, places[0].y);
  for (const { x, y } of places) context.lineTo(x, y + (places.length === 1 ? 0.01 : 0));
  context.stroke();
  context.restore();
};

// Sends what was drawn, and shows it until the result has it.
const sendDrawn = async (drawn, edit, said) => {
  pending.add(drawn);
  changed("tool");
  try {
    return await sendEdit(edit, said);
  } finally {
    pending.delete(drawn);
    changed("tool");
  }
};

// The brush, strokes that are made or sent, and the cross of the keys.
const drawBrush = (context, shown) => {
  for (const each of pending) if (each.frame === model.frame) drawStroke(context, shown, each);
  if (stroke) drawStroke(context, shown, { ...drawnBy, places: stroke, radius: model.radius });
  if (!cursor || model.tool === "select") return;
  context.save();
  context.beginPath();
  context.arc(cursor.x, cursor.y, BRUSHES.has(model.tool) ? radiusOnCanvas(shown) : CLICK_RADIUS, 0, 2 * Math.PI);
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
  let identity = 0;
  try {
    identity = await identityAt(place);
  } catch (error) {
    showMessage(error.message);
    return;
  }
  const chosen = new Set(isMore ? model.selected : []);
  if (identity) {
    if (chosen.has(identity)) chosen.delete(identity);
    else chosen.add(identity);
  }
  select(chosen);
  announce(identity ? `object ${nameOf(identity)} ${chosen.has(identity) ? "selected" : "not selected"}` : "no object here");
};

const begin = (place) => {
  play(false);
  stroke = [place];
  drawnBy = { tool: model.tool, frame: model.frame };
};

const finish = async () => {
  const shown = result();
  const { tool, frame } = drawnBy;
  const drawn = { tool, frame, places: stroke, radius: model.radius };
  const strokes = [{ radius: model.radius, points: stroke.map((place) => toVideo(place, shown)) }];
  stroke = null;
  const target = only();
  if (tool === "paint") {
    let object = target;
    const edit = () => {
      object ??= freeIdentity();
      return { paint: { object, frame, strokes } };
    };
    if (await sendDrawn(drawn, edit, () => `painted object ${object} in frame ${frame}`)) select([object]);
  } else {
    const which = target === null ? {} : { object: target };
    await sendDrawn(drawn, { erase: { ...which, frame, strokes } }, `erased in frame ${frame}`);
  }
};

const add = async (place) => {
  play(false);
  const shown = result();
  const { frame } = model;
  let object = null;
  const drawn = { tool: "add", frame, places: [place], radius: (CLICK_RADIUS * shown.width) / shown.grid.width };
  const added = { frame, points: [toVideo(place, shown)], by: model.growing };
  const edit = () => {
    object = freeIdentity();
    return { add: { object, ...added } };
  };
  if (await sendDrawn(drawn, edit, () => `object ${object} added`)) select([object]);
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
    begin(cursor);
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
  drawAbove(drawBrush);
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !result()) return;
    const place = placeOf(event);
    if (model.tool === "select") choose(place, event.shiftKey || event.ctrlKey || event.metaKey);
    else if (model.tool === "add") add(place);
    else {
      canvas.setPointerCapture(event.pointerId);
      begin(place);
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
    if (stroke && model.tool !== drawnBy.tool) stroke = null;
  });
  on("frame", () => {
    // Another frame is seen, so that the stroke would be drawn where nobody looks.
    if (stroke && model.frame !== drawnBy.frame) cancelStroke();
  });
};
