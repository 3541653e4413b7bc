// Proposals that are no object of the result: each can be looked at and promoted.

import { find, make, refill } from "./elements.js";
import { sendEdit } from "./edits.js";
import { changed, goTo, model, nameOf, on, result, select } from "./model.js";

const look = (identity) => {
  const entry = model.grid?.rejected[identity];
  model.hasRejected = true;
  changed("view");
  select([identity]);
  if (entry) goTo(entry.best);
};

const makeEntry = ({ identity }) => {
  const entry = model.grid?.rejected[identity];
  const image = entry && make("img", { alt: "", loading: "lazy", src: `thumbnails/${identity}/${entry.best}?of=${entry.tag}` });
  return make(
    "li",
    {},
    make(
      "button",
      { type: "button", class: "look", "data-key": `look-${identity}`, onclick: () => look(identity), "aria-label": `look at rejected proposal ${nameOf(identity)}` },
      image,
      make("span", {}, make("b", {}, nameOf(identity)), make("span", { class: "muted" }, entry ? ` ${entry.first}–${entry.last} · ${entry.mean.toFixed(1)}\u00a0%` : "")),
    ),
    make("button", { type: "button", "data-key": `promote-${identity}`, onclick: () => sendEdit({ keep: identity }, `object ${identity} promoted`), "aria-label": `promote ${nameOf(identity)}` }, "Promote"),
  );
};

const draw = () => {
  const shown = result();
  if (!shown) return;
  refill(
    find("rejected"),
    make("h2", { id: "rejected-heading" }, `Rejected proposals (${shown.rejected.length})`),
    shown.rejected.length
      ? make("ul", { class: "rejected" }, ...shown.rejected.map(makeEntry))
      : make("p", { class: "muted" }, "None: everything that was proposed is in the result."),
  );
};

export const startRejected = () => on("state grid", draw);
