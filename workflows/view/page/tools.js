// The bar above the picture: tools, brush, and what is drawn.

import { find, make } from "./elements.js";
import { changed, model, on, result } from "./model.js";

const TOOLS = [
  ["select", "Select", "V", "click an object to select it, with shift several"],
  ["paint", "Paint", "B", "draw what belongs to the selected object, or a new object if none is selected"],
  ["erase", "Erase", "E", "draw what is not the selected object, or no object if none is selected"],
  ["add", "Add", "A", "click on something that moves: an object grows from there"],
];
const MAX_RADIUS = 120;
const MIN_RADIUS = 1;
const USUAL_RADIUS = 0.015; // of the width of the video
let radius = null;

export const chooseTool = (tool) => {
  model.tool = tool;
  changed("tool");
};

const setRadius = (wanted) => {
  model.radius = Math.min(Math.max(wanted, MIN_RADIUS), MAX_RADIUS);
  radius.value = model.radius;
  radius.setAttribute("aria-valuetext", `${model.radius} px`);
  changed("tool");
};

export const changeRadius = (factor) =>
  setRadius(factor > 1 ? Math.ceil(model.radius * factor) : Math.floor(model.radius * factor));

export const toggleView = (name) => {
  model[name] = !model[name];
  changed("view");
};

const check = (name, text, key) => {
  const input = make("input", { type: "checkbox", checked: model[name], onchange: () => toggleView(name) });
  on("view", () => {
    input.checked = model[name];
  });
  return make("label", { class: "check", title: `${text} (${key})` }, input, text);
};

const fillCues = (choice) => {
  const shown = result();
  const options = shown.cues.map(({ name, isStored }, number) =>
    make("option", { value: number, disabled: !isStored }, isStored ? name : `${name} (not stored)`),
  );
  choice.replaceChildren(make("option", { value: -1 }, "video"), ...options);
  choice.value = model.cue;
};

const GROWING = { region: "motion and colour", sam2: "SAM 2.1" };

// With the network here, a click is its.
const fillGrowing = (choice) => {
  const { growing } = result();
  choice.replaceChildren(
    ...Object.entries(GROWING).map(([name, text]) => make("option", { value: name, disabled: !growing.includes(name) }, text)),
  );
  model.growing = growing.includes("sam2") ? "sam2" : "region";
  choice.value = model.growing;
};

export const startTools = () => {
  const help = find("picture-help");
  const buttons = TOOLS.map(([tool, text, key, title]) => {
    const button = make(
      "button",
      { type: "button", title: `${title} (${key})`, "aria-keyshortcuts": key, "aria-pressed": String(tool === model.tool), onclick: () => chooseTool(tool) },
      text,
    );
    on("tool", () => {
      button.setAttribute("aria-pressed", String(tool === model.tool));
      if (tool === model.tool) help.textContent = `${title}. Arrows move the cross, Enter presses.`;
    });
    return button;
  });
  radius = make("input", {
    type: "range", id: "radius", min: MIN_RADIUS, max: MAX_RADIUS, value: model.radius, "aria-valuetext": `${model.radius} px`,
    oninput: () => setRadius(Number(radius.value)),
  });
  const brush = make("label", { class: "slider" }, "brush", radius);
  on("tool", () => {
    brush.hidden = !["paint", "erase"].includes(model.tool);
  });
  brush.hidden = true;
  const growing = make("select", { id: "growing", onchange: () => { model.growing = growing.value; } });
  const grow = make("label", { hidden: true, title: "SAM 2.1 needs its weights: moseg weights fetch" }, "grow by", growing);
  on("tool", () => {
    grow.hidden = model.tool !== "add";
  });
  const cue = make("select", { id: "cue", onchange: () => { model.cue = Number(cue.value); changed("view"); } });
  const opacity = make("input", {
    type: "range", id: "opacity", min: 0, max: 1, step: 0.05, value: model.opacity,
    oninput: () => { model.opacity = Number(opacity.value); changed("view"); },
  });
  const key = make("img", { class: "key", alt: "", hidden: true });
  const about = make("p", { class: "about-cue muted", hidden: true });
  find("tools").append(
    make("span", { class: "group", role: "group", "aria-label": "tool" }, ...buttons),
    brush,
    grow,
    make("label", {}, "picture", cue),
    check("hasOverlay", "masks", "O"),
    check("hasNames", "names", "N"),
    check("hasRejected", "rejected", "R"),
    make("label", { class: "slider" }, "tint", opacity),
  );
  find("stage").after(make("div", { class: "cue-key" }, key, about));
  let filled = "";
  on("state", () => {
    const shown = result();
    if (!shown || filled === shown.source) return;
    filled = shown.source;
    fillCues(cue);
    fillGrowing(growing);
    setRadius(Math.round(shown.width * USUAL_RADIUS));
  });
  on("view", () => {
    const shown = result();
    const hasCue = shown && model.cue >= 0;
    key.hidden = about.hidden = !hasCue;
    if (!hasCue) return;
    const { name, description, hasKey } = shown.cues[model.cue];
    about.textContent = `${name}: ${description}`;
    key.hidden = !hasKey;
    if (hasKey) {
      key.src = `cues/${model.cue}/key?of=${shown.source}`;
      key.alt = `colour key of ${name}`;
    }
  });
};
