// The server's state, as far as this page has it.

import { getJson } from "./api.js";
import { showMessage } from "./elements.js";
import { useResult } from "./media.js";
import { changed, model, on, result } from "./model.js";

let gridKey = null;
let announced = 0; // revision that the server told of

// Areas over time, after the picture that they belong to: while a slider moves, only those of its last value.
const loadGrid = async () => {
  const shown = result();
  if (!shown || model.isBusy || shown.key === gridKey) return;
  gridKey = shown.key;
  try {
    const grid = await getJson(`grid/${shown.key}`);
    // A later state may have come meanwhile.
    if (result()?.key !== shown.key) {
      // It may come back, and then needs its areas.
      if (gridKey === shown.key) gridKey = null;
      return;
    }
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
};

export const reload = async () => {
  try {
    receiveState(await getJson("state"));
  } catch (error) {
    showMessage(error.message);
  }
};

// The answer to a change of this page has the new state: only changes of others are fetched.
const catchUp = () => {
  if (!model.isBusy && (model.state?.revision ?? 0) < announced) reload();
};

export const hearOf = (revision) => {
  announced = revision;
  catchUp();
};

export const startStates = () => {
  on("busy", catchUp);
  // Not between two values of a slider.
  on("drawn busy", () => setTimeout(loadGrid));
};
