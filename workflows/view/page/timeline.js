// Objects over time: a row for each object with pictures cut out of frames, and its area.

import { announce, find, make, makeDrawing, plural, refill, swatch } from "./elements.js";
import { goTo, model, nameOf, on, result, select } from "./model.js";

const HEIGHT = 26;
const FEW = 4; // rows of full height
const made = new Map(); // rows by identity, with what they were made from
let active = null; // identity of the row that the tab key stops at

const outline = (areas, step, numFrames, largest) => {
  const corners = [`0,${HEIGHT}`];
  areas.forEach((area, place) => {
    const level = (HEIGHT * (1 - area / (largest || 1))).toFixed(1);
    corners.push(`${place * step},${level}`, `${Math.min((place + 1) * step, numFrames)},${level}`);
  });
  return [...corners, `${numFrames},${HEIGHT}`].join(" ");
};

const drawTrack = (object, entry, shown) => {
  const { numFrames } = shown;
  const playhead = makeDrawing("line", { class: "playhead", y1: 0, y2: HEIGHT });
  const area = makeDrawing("polygon", { points: outline(entry.areas, model.grid.step, numFrames, entry.largest) });
  area.style.fill = object.colour;
  return makeDrawing(
    "svg",
    { class: "area", viewBox: `0 0 ${numFrames} ${HEIGHT}`, preserveAspectRatio: "none", "aria-hidden": "true" },
    area,
    playhead,
  );
};

const drawThumbnails = (object, entry, shown) =>
  make(
    "div",
    { class: "thumbnails", "aria-hidden": "true" },
    ...entry.thumbnails.map((frame) => {
      if (frame === null) return make("span", { class: "thumbnail is-empty" });
      const image = make("img", { alt: "", loading: "lazy", decoding: "async", src: `thumbnails/${object.identity}/${frame}?of=${entry.tag}` });
      return make("span", { class: "thumbnail", "data-frame": frame, title: `frame ${frame}` }, image);
    }),
  );

const describe = (object, entry) => {
  const parts = [`object ${nameOf(object.identity)}`, `motion ${object.motion}`];
  if (entry) parts.push(`frames ${entry.first} to ${entry.last}`, `mean area ${entry.mean.toFixed(1)} percent`);
  return parts.join(", ");
};

const facts = (object, entry) =>
  entry
    ? `motion ${object.motion} · ${entry.first}–${entry.last} · ${entry.mean.toFixed(1)}\u00a0%`
    : `motion ${object.motion}${model.grid?.key === result().key ? " · no pixel of it is left" : ""}`;

const makeRow = (object, shown) => {
  const entry = model.grid?.objects[object.identity];
  const { identity } = object;
  const row = make(
    "li",
    { role: "option", class: "row", id: `row-${identity}`, "data-key": `row-${identity}`, "data-identity": identity, tabindex: -1, "aria-label": describe(object, entry) },
    make(
      "div",
      { class: "row-name" },
      make("span", { class: "called", title: object.name }, swatch(object.colour), make("b", {}, String(identity)), object.name ? ` ${object.name}` : ""),
      make("span", { class: "muted" }, facts(object, entry)),
    ),
    make("div", { class: "track" }, entry && drawThumbnails(object, entry, shown), entry && drawTrack(object, entry, shown)),
  );
  return row;
};

// The row of an object, the same one as before unless what it shows has changed.
const rowOf = (object, shown) => {
  const { step, key } = model.grid ?? {};
  const entry = model.grid?.objects[object.identity];
  const from = JSON.stringify([object, entry ? [entry.tag, step] : key === shown.key, shown.source]);
  const known = made.get(object.identity);
  if (known?.from === from) return known.row;
  const row = makeRow(object, shown);
  made.set(object.identity, { from, row });
  return row;
};

const markRows = () => {
  const rows = [...find("rows").children];
  const known = rows.some((row) => row.dataset.identity === String(active));
  rows.forEach((row, place) => {
    const identity = Number(row.dataset.identity);
    row.setAttribute("aria-selected", String(model.selected.has(identity)));
    row.tabIndex = known ? (identity === active ? 0 : -1) : place === 0 ? 0 : -1;
  });
};

const markFrame = () => {
  for (const playhead of find("rows").querySelectorAll(".playhead")) {
    playhead.setAttribute("x1", model.frame + 0.5);
    playhead.setAttribute("x2", model.frame + 0.5);
  }
};

const drawRuler = (shown) => {
  const count = Math.min(8, shown.numFrames);
  const places = Array.from({ length: count }, (_, place) => Math.floor((shown.numFrames * place) / count));
  find("ruler").replaceChildren(...places.map((frame) => make("span", {}, String(frame))));
};

const drawRows = () => {
  const shown = result();
  if (!shown) return;
  drawRuler(shown);
  const rows = find("rows");
  const wanted = shown.objects.map((object) => rowOf(object, shown));
  rows.classList.toggle("is-many", wanted.length > FEW);
  if (wanted.length !== rows.children.length || wanted.some((row, place) => row !== rows.children[place])) refill(rows, ...wanted);
  if (!shown.objects.length) {
    rows.append(make("li", { class: "nothing muted", role: "option", "aria-selected": "false" }, "No object moves. Rejected proposals can be promoted, objects painted or added by a click."));
  }
  find("timeline-note").textContent = `${plural(shown.objects.length, "object")}, ${plural(shown.numMotions, "motion")} with the background's`;
  markRows();
  markFrame();
};

const frameAt = (track, event) => {
  const box = track.getBoundingClientRect();
  return Math.floor(((event.clientX - box.left) / box.width) * result().numFrames);
};

const choose = (row, isMore) => {
  const identity = Number(row.dataset.identity);
  active = identity;
  const chosen = new Set(isMore ? model.selected : []);
  if (isMore && chosen.has(identity)) chosen.delete(identity);
  else chosen.add(identity);
  select(chosen);
  announce(`object ${nameOf(identity)} ${chosen.has(identity) ? "selected" : "not selected"}, ${chosen.size} in all`);
};

const onKey = (event) => {
  const rows = [...find("rows").querySelectorAll(".row")];
  const at = rows.indexOf(event.target);
  if (at < 0) return;
  const next = { ArrowDown: at + 1, ArrowUp: at - 1 }[event.key];
  if (next !== undefined) {
    event.preventDefault();
    event.stopPropagation();
    const row = rows[next];
    if (!row) return;
    active = Number(row.dataset.identity);
    markRows();
    row.focus();
    if (!event.ctrlKey) choose(row, event.shiftKey);
  } else if (event.key === "Enter" || (event.key === " " && (event.ctrlKey || event.shiftKey))) {
    event.preventDefault();
    event.stopPropagation();
    if (event.key === "Enter") {
      choose(event.target, false);
      const entry = model.grid?.objects[event.target.dataset.identity];
      if (entry) goTo(entry.first);
    } else choose(event.target, true);
  }
};

export const startTimeline = () => {
  const rows = find("rows");
  rows.addEventListener("click", (event) => {
    const row = event.target.closest(".row");
    if (!row) return;
    const thumbnail = event.target.closest("[data-frame]");
    const track = event.target.closest(".track");
    if (thumbnail) goTo(Number(thumbnail.dataset.frame));
    else if (track) goTo(frameAt(track, event));
    choose(row, event.shiftKey || event.ctrlKey || event.metaKey);
  });
  rows.addEventListener("keydown", onKey);
  on("state grid", drawRows);
  on("selection", markRows);
  on("frame", markFrame);
};
