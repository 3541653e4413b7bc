// Elements of the page: made from text only, so that no name can become markup.

const SVG = "http://www.w3.org/2000/svg";

const fill = (element, attributes, children) => {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name in { value: 1, checked: 1, disabled: 1, indeterminate: 1 }) element[name] = value;
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return element;
};

export const make = (name, attributes = {}, ...children) => fill(document.createElement(name), attributes, children);

export const makeDrawing = (name, attributes = {}, ...children) =>
  fill(document.createElementNS(SVG, name), attributes, children);

export const find = (id) => document.getElementById(id);

// Replaces the content of an element and keeps the focus on what has the same data-key.
export const refill = (element, ...children) => {
  const key = element.contains(document.activeElement) ? document.activeElement.dataset.key : undefined;
  element.replaceChildren(...children.flat().filter(Boolean));
  if (key !== undefined) element.querySelector(`[data-key="${CSS.escape(key)}"]`)?.focus({ preventScroll: true });
};

export const swatch = (colour) => {
  const element = make("span", { class: "swatch", "aria-hidden": "true" });
  element.style.background = colour;
  return element;
};

export const plural = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;

let last = "";

// Says a sentence to a screen reader; the same one again too.
export const announce = (text) => {
  const element = find("announcer");
  element.textContent = text === last ? `${text}\u00a0` : text;
  last = element.textContent;
};

export const showMessage = (text) => {
  const box = find("message");
  box.querySelector("p").textContent = text;
  box.hidden = !text;
};
