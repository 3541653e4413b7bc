// Frames, labels and cues: fetched once, decoded, and kept as long as they are the most recently used.

import { getBlob, getBytes } from "./api.js";

const MAX_BYTES = 384 * 2 ** 20;

class Kept {
  constructor(maxBytes) {
    this.maxBytes = maxBytes;
    this.entries = new Map();
    this.numBytes = 0;
  }

  // Returns the promise of what `load` loads under a key.
  get(key, numBytes, load) {
    const known = this.entries.get(key);
    if (known) {
      this.entries.delete(key);
      this.entries.set(key, known);
      return known.value;
    }
    const entry = { value: load(), numBytes };
    entry.value.catch(() => this.forget(key, entry));
    this.entries.set(key, entry);
    this.numBytes += numBytes;
    for (const [oldest, other] of this.entries) {
      if (this.numBytes <= this.maxBytes || other === entry) break;
      this.forget(oldest, other);
      other.value.then((value) => value?.close?.(), () => {});
    }
    return entry.value;
  }

  forget(key, entry) {
    if (this.entries.get(key) !== entry) return;
    this.entries.delete(key);
    this.numBytes -= entry.numBytes;
  }
}

const kept = new Kept(MAX_BYTES);
let side = 0;
let run = "";

// Names what is shown: pictures of one name never change.
export const useResult = (result) => {
  run = result.source;
  side = result.grid.width * result.grid.height;
};

const picture = (address) =>
  kept.get(address, 4 * side, async () => {
    const blob = await getBlob(address);
    return blob && createImageBitmap(blob);
  });

export const frameAt = (frame) => picture(`frames/${frame}?of=${run}`);

export const cueAt = (number, frame) => picture(`cues/${number}/${frame}?of=${run}`);

const labelMap = (address) => kept.get(address, 2 * side, async () => new Uint16Array(await getBytes(address)));

export const labelsAt = (key, frame) => labelMap(`labels/${key}/${frame}`);

export const proposalsAt = (frame) => labelMap(`proposals/${frame}?of=${run}`);
