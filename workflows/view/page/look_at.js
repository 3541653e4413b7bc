// What is worth a look in the result as it was written last; a frame that a sentence names is one click away.

import { find, make, refill } from "./elements.js";
import { goTo, on, result } from "./model.js";

const FRAME = /\bframes? (\d+)/;

const makeEntry = (text) => {
  const [, frame] = text.match(FRAME) ?? [];
  return make(
    "li",
    {},
    text,
    frame !== undefined && [" ", make("button", { type: "button", "data-key": `look-at-${text}`, onclick: () => goTo(Number(frame)) }, `Go to ${frame}`)],
  );
};

const draw = () => {
  const shown = result();
  if (!shown) return;
  find("look-at").hidden = shown.lookAt.length === 0;
  refill(
    find("look-at"),
    make("h2", { id: "look-at-heading" }, `Worth a look (${shown.lookAt.length})`),
    make("p", { class: "muted" }, "In the result as it was written last."),
    make("ul", { class: "look-at" }, ...shown.lookAt.map(makeEntry)),
  );
};

export const startLookAt = () => on("state", draw);
