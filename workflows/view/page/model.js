// What the page shows now: the server's state, and the user's own choices of frame, selection and tool.

const listeners = new Map();

export const model = {
  state: null, // as the server sent it
  grid: null, // areas and thumbnails of the result, or null while they are fetched
  frame: 0,
  selected: new Set(),
  tool: "select",
  radius: 12, // of the brush, px of the video
  growing: "region", // way in which an object grows from a click
  cue: -1, // number of the cue in place of the frame; -1 for the frame
  opacity: 1,
  hasOverlay: true,
  hasNames: true,
  hasRejected: false,
  isBusy: false, // while the server is at a change of this page
  fault: "", // why the frame cannot be shown
};

// Calls a function whenever one of these topics changes: state, grid, frame, selection, tool, view, busy, drawn, fault.
export const on = (topics, listener) => {
  for (const topic of topics.split(" ")) {
    if (!listeners.has(topic)) listeners.set(topic, new Set());
    listeners.get(topic).add(listener);
  }
};

export const changed = (...topics) => {
  const due = new Set(topics.flatMap((topic) => [...(listeners.get(topic) ?? [])]));
  for (const listener of due) listener();
};

export const result = () => model.state?.result ?? null;

export const objectOf = (identity) => {
  const shown = result();
  return shown?.objects.find((each) => each.identity === identity) ?? shown?.rejected.find((each) => each.identity === identity) ?? null;
};

export const nameOf = (identity) => {
  const object = objectOf(identity);
  return object?.name ? `${identity} ${object.name}` : `${identity}`;
};

export const select = (identities) => {
  model.selected = new Set(identities);
  changed("selection");
};

export const goTo = (frame) => {
  const shown = result();
  if (!shown) return;
  const next = Math.min(Math.max(Math.round(frame), 0), shown.numFrames - 1);
  if (next === model.frame) return;
  model.frame = next;
  changed("frame");
};

// The one object that an action is about, or null where none or several are selected.
export const only = () => (model.selected.size === 1 ? [...model.selected][0] : null);

// A number that no object has.
export const freeIdentity = () => {
  const shown = result();
  return shown ? shown.nextIdentity : 1;
};
