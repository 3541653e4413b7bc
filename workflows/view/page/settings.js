// Settings in place of the run's: the result follows while a slider moves.

import { announce, find, make, refill } from "./elements.js";
import { isSettingWaiting, sendSetting } from "./edits.js";
import { on, result } from "./model.js";

const page = Math.random(); // another tab, or this page loaded anew, has other gestures
let gesture = 0;
let isHeld = false;
let drawn = "";

const show = (setting, value) => {
  if (typeof value !== "number") return String(value);
  if (setting.isShare) return `${Number((100 * value).toPrecision(3))} %`;
  return `${Number(value.toPrecision(3))}${setting.unit ? ` ${setting.unit}` : ""}`;
};

const nameGesture = (setting) => `${page} ${setting.name} ${gesture}`;

// The slider of a scale that spans decades is even in its logarithm.
const toSlider = (setting, value) => (setting.isLog ? Math.log10(value) : value);
const fromSlider = (setting, value) => {
  if (!setting.isLog) return value;
  return Number((10 ** value).toPrecision(3));
};

const hold = () => {
  isHeld = true;
  gesture += 1;
};

const letGo = () => {
  isHeld = false;
};

const makeRange = (setting) => {
  const output = make("output", {}, show(setting, setting.value));
  const input = make("input", {
    type: "range", "data-key": setting.name, "data-setting": setting.name,
    min: toSlider(setting, setting.min), max: toSlider(setting, setting.max), step: setting.step,
    "aria-valuetext": show(setting, setting.value), "aria-label": setting.label,
    onpointerdown: hold,
    onpointerup: letGo,
    onpointercancel: letGo,
    // A key that is held is one gesture, too.
    onkeydown: (event) => { if (!event.repeat) hold(); },
    onkeyup: letGo,
    oninput: () => {
      const value = fromSlider(setting, Number(input.value));
      output.textContent = show(setting, value);
      input.setAttribute("aria-valuetext", show(setting, value));
      sendSetting(setting.name, value, nameGesture(setting));
    },
    onchange: () => { if (!isHeld) gesture += 1; },
    onblur: letGo,
  });
  input.value = toSlider(setting, setting.value);
  return make("div", { class: "setting", title: setting.description }, make("span", {}, setting.label), input, output, makeReset(setting));
};

const makeChoice = (setting) => {
  const input = make(
    "select",
    { "data-key": setting.name, "data-setting": setting.name, "aria-label": setting.label, onchange: () => { gesture += 1; const word = input.value; sendSetting(setting.name, /^\d+$/.test(word) ? Number(word) : word, nameGesture(setting)); } },
    ...setting.options.map((option) => make("option", { value: option }, String(option))),
  );
  input.value = String(setting.value);
  return make("div", { class: "setting", title: setting.description }, make("span", {}, setting.label), input, make("span", {}), makeReset(setting));
};

const makeReset = (setting) =>
  make(
    "button",
    {
      type: "button", class: "reset", "data-key": `reset-${setting.name}`, disabled: !setting.isChanged,
      "aria-label": `${setting.label} as the run had it: ${show(setting, setting.initial)}`, title: `as the run had it: ${show(setting, setting.initial)}`,
      onclick: () => { gesture += 1; sendSetting(setting.name, null, nameGesture(setting)); announce(`${setting.label} as the run had it`); },
    },
    "↺",
  );

const draw = () => {
  const shown = result();
  if (!shown) return;
  // A slider that is held must not be replaced under the hand, nor may one jump back to a value before its last.
  if ((isHeld || isSettingWaiting()) && drawn === shown.source) {
    for (const setting of shown.settings) {
      const reset = find("settings").querySelector(`[data-key="reset-${CSS.escape(setting.name)}"]`);
      if (reset) reset.disabled = !setting.isChanged;
    }
    return;
  }
  drawn = shown.source;
  refill(
    find("settings"),
    make("h2", { id: "settings-heading" }, "Settings"),
    ...shown.settings.map((setting) => (setting.options.length ? makeChoice(setting) : makeRange(setting))),
  );
};

export const startSettings = () => on("state", draw);
