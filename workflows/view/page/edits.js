// Corrections: sent to the server one by one, which writes the file before it answers.

import { post } from "./api.js";
import { announce, showMessage } from "./elements.js";
import { changed, model } from "./model.js";
import { receiveState, reload } from "./states.js";

let tail = Promise.resolve(true);

// Sends a change after those before it; true where it was accepted.
const send = (address, content, said) => {
  const next = tail.then(async () => {
    model.isBusy = true;
    changed("busy");
    try {
      const own = typeof content === "function" ? content() : content;
      receiveState(await post(address, { revision: model.state.revision, ...own }));
      showMessage("");
      if (said) announce(typeof said === "function" ? said() : said);
      return true;
    } catch (error) {
      showMessage(error.message);
      // Another tab, or the file itself, has changed: what is shown is out of date.
      if (error.status === 409) await reload();
      return false;
    } finally {
      model.isBusy = false;
      changed("busy");
    }
  });
  tail = next;
  return next;
};

// A function gives the edit when those before it are done, which may have taken the next free number.
export const sendEdit = (edit, said) =>
  send("edits", typeof edit === "function" ? () => ({ edit: edit() }) : { edit }, said);

export const undo = () => send("undo", {}, "undone");

export const redo = () => send("redo", {}, "done again");

// Sliders send their latest value while the server is at the one before; a gesture is one step of undo.
const waiting = new Map();
let isSending = false;

// True while a value has been chosen that the server has not been sent: what it answers now is older.
export const isSettingWaiting = () => waiting.size > 0;

export const sendSetting = async (name, value, gesture) => {
  waiting.set(name, { name, value, gesture });
  if (isSending) return;
  isSending = true;
  try {
    while (waiting.size) {
      const [[next, content]] = waiting;
      waiting.delete(next);
      await send("settings", content, "");
    }
  } finally {
    isSending = false;
  }
};
