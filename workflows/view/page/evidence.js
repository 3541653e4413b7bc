// The evidence: how alike the motions of two objects are, under each motion model and together.

import { getJson } from "./api.js";
import { find, make, refill } from "./elements.js";
import { on, result } from "./model.js";

let isOpen = false;
let shownKey = null;

const makeCell = (value) => {
  const cell = make("td", {}, value === null ? "–" : value.toFixed(2));
  if (value !== null) cell.style.setProperty("--share", String(Math.min(Math.max(value, 0), 1)));
  return cell;
};

const makeTable = ({ title, description, labels, values }) =>
  make(
    "div",
    { class: "scroll", tabindex: 0, role: "region", "aria-label": title },
    make(
      "table",
      { class: "matrix" },
      make("caption", { title: description }, title),
      make("thead", {}, make("tr", {}, make("td"), ...labels.map((label) => make("th", { scope: "col" }, label)))),
      make("tbody", {}, ...values.map((row, place) => make("tr", {}, make("th", { scope: "row" }, labels[place]), ...row.map(makeCell)))),
    ),
  );

const load = async () => {
  const shown = result();
  if (!isOpen || !shown || shownKey === shown.key) return;
  shownKey = shown.key;
  const box = find("evidence-content");
  try {
    const { matrices, missing } = await getJson(`matrices/${shown.key}`);
    if (result()?.key !== shown.key) return;
    box.replaceChildren(
      ...matrices.map(makeTable),
      ...missing.map((text) => make("p", { class: "muted" }, text)),
      ...(matrices.length + missing.length ? [] : [make("p", { class: "muted" }, "Nothing to compare.")]),
    );
  } catch (error) {
    // A later result may be shown meanwhile.
    if (shownKey !== shown.key) return;
    shownKey = null;
    box.replaceChildren(make("p", { class: "muted" }, error.message));
  }
};

export const startEvidence = () => {
  const details = make(
    "details",
    { ontoggle: () => { isOpen = details.open; load(); } },
    make("summary", {}, make("h2", { id: "evidence-heading" }, "Affinities")),
    make("p", { class: "muted" }, "1: the same motion, 0: another one."),
    make("div", { id: "evidence-content" }),
  );
  refill(find("evidence"), details);
  on("state", load);
};
