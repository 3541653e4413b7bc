// The server's state, as far as this page has it.

import { getJson } from "./api.js";
import { showMessage } from "./elements.js";
import { useResult } from "./media.js";
import { changed, model, result } from "./model.js";

let gridKey = null;

const loadGrid = async () => {
  const shown = result();
  if (!shown || shown.key === gridKey) return;
  gridKey = shown.key;
  try {
    const grid = await getJson(`grid/${shown.key}`);
    // A later state may have come meanwhile.
    if (result()?.key !== shown.key) return;
    model.grid = grid;
    changed("grid");
  } catch (error) {
    gridKey = null;
    if (error.status !== 404) showMessage(error.message);
  }
};

export const receiveState = (state) => {
  if (model.state && state.revision < model.state.revision) return;
  model.state = state;
  const shown = result();
  if (shown) {
    useResult(shown);
    model.frame = Math.min(model.frame, shown.numFrames - 1);
    const known = new Set([...shown.objects, ...shown.rejected].map(({ identity }) => identity));
    model.selected = new Set([...model.selected].filter((identity) => known.has(identity)));
  }
  changed("state", "selection");
  loadGrid();
};

export const reload = async () => {
  try {
    receiveState(await getJson("state"));
  } catch (error) {
    showMessage(error.message);
  }
};
