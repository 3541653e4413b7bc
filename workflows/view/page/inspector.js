// The inspector: the selected object and what can be done with it.

import { find, make, refill, showMessage, swatch } from "./elements.js";
import { sendEdit } from "./edits.js";
import { freeIdentity, model, nameOf, objectOf, on, only, result, select } from "./model.js";

const chosen = () => [...model.selected];

const isRejected = (identity) => result().rejected.some((each) => each.identity === identity);

const each = async (kind, said) => {
  for (const identity of chosen()) {
    if (!(await sendEdit({ [kind]: identity }, `object ${nameOf(identity)} ${said}`))) return;
  }
};

export const actions = {
  drop: () => each("drop", "dropped"),
  keep: () => each("keep", "kept"),
  static: () => each("static", "is static"),
  moving: () => each("moving", "moves"),
  merge: async () => {
    const identities = chosen();
    if (identities.length < 2) return;
    if (await sendEdit({ merge: identities }, `objects ${identities.join(" and ")} merged`)) select([identities[0]]);
  },
  split: async () => {
    const object = only();
    if (object === null || model.frame === 0) return;
    const { frame } = model;
    let into = null;
    const edit = () => {
      into = freeIdentity();
      return { split: { object, frame, into } };
    };
    await sendEdit(edit, () => `object ${object} is ${into} from frame ${frame} on`);
  },
  rename: () => {
    find("name")?.focus();
    find("name")?.select();
  },
};

const ACTIONS = [
  ["drop", "Drop", "D", "no object of the result; its motion still counts", (count) => count > 0],
  ["keep", "Keep", "K", "stays in the result whatever the settings say", (count) => count > 0],
  ["static", "Static", "S", "belongs to the background's motion", (count) => count > 0],
  ["moving", "Moving", "M", "moves on its own, with a motion of its own", (count) => count > 0],
  ["merge", "Merge", "G", "one object, with the number of the first one selected; in the result if one of them is", (count) => count > 1],
  ["split", "Split", "X", "another object from this frame on", (count) => count === 1 && model.frame > 0],
];

const facts = (identity) => {
  const object = objectOf(identity);
  const entry = model.grid?.objects[identity] ?? model.grid?.rejected[identity];
  const rows = [["motion", object.motion ? String(object.motion) : "0, the background's"]];
  if (entry) {
    rows.push(["frames", `${entry.first}–${entry.last}`], ["mean area", `${entry.mean.toFixed(2)} %`]);
  }
  if (object.verdict) rows.push(["corrected", object.verdict]);
  return make("dl", { class: "object-facts" }, ...rows.map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value))));
};

let named = null; // object whose name the field has, and that name
let given = "";
let isDue = false; // to be drawn when the name has been typed

const nameField = (identity) => {
  const object = objectOf(identity);
  given = object.name ?? "";
  const input = make("input", {
    type: "text", id: "name", "data-key": "name", maxlength: 100, value: given, placeholder: "no name",
    autocomplete: "off", spellcheck: "false",
    onchange: () => {
      const name = input.value.trim();
      if (!name && object.name) {
        input.value = object.name;
        showMessage(`A name is changed, or its correction undone; object ${identity} is still called ${object.name}.`);
      } else if (name !== (object.name ?? "")) sendEdit({ rename: { object: identity, name } }, `object ${identity} is called ${name}`);
    },
    // After onchange, which sends the name.
    onblur: () => {
      if (isDue) draw();
    },
    onkeydown: (event) => {
      if (event.key === "Enter") input.blur();
      if (event.key === "Escape") {
        input.value = object.name ?? "";
        input.blur();
      }
    },
  });
  return make("label", { class: "name-field" }, "name", input);
};

const draw = () => {
  const shown = result();
  if (!shown) return;
  const identities = chosen().filter((identity) => objectOf(identity));
  const heading = make("h2", { id: "selection-heading" }, identities.length ? `Selected: ${identities.map(nameOf).join(", ")}` : "Nothing selected");
  const buttons = ACTIONS.map(([name, text, key, title, isPossible]) =>
    make(
      "button",
      { type: "button", "data-key": `action-${name}`, "data-action": name, title: `${title} (${key})`, "aria-keyshortcuts": key, disabled: !isPossible(identities.length), onclick: actions[name] },
      name === "keep" && identities.length && identities.every(isRejected) ? "Promote" : text,
    ),
  );
  const one = identities.length === 1 ? identities[0] : null;
  const field = find("selection").querySelector("#name");
  // A field in which a name is being typed is not replaced: what is new is drawn when it is left.
  isDue = field !== null && field === document.activeElement && one === named && field.value !== given;
  if (isDue) return;
  named = one;
  refill(
    find("selection"),
    heading,
    one === null
      ? make("p", { class: "muted" }, identities.length ? "Several objects: merge them, or one action for each." : "Click an object in the picture, or its row; with shift, several.")
      : [make("p", {}, swatch(objectOf(one).colour), isRejected(one) ? "a rejected proposal" : "an object of the result"), facts(one), nameField(one)],
    make("div", { class: "actions", role: "group", "aria-label": "actions" }, ...buttons),
  );
};

const followFrame = () => {
  const split = find("selection").querySelector("[data-action=split]");
  if (split) split.disabled = !(model.selected.size === 1 && model.frame > 0);
};

export const startInspector = () => {
  on("state selection grid", draw);
  on("frame", followFrame);
};
