// The page: its parts, each started once, and the server's events.

import { GONE, listen } from "./api.js";
import { startCorrections } from "./corrections.js";
import { find, showMessage } from "./elements.js";
import { startEvidence } from "./evidence.js";
import { startExport } from "./export.js";
import { startInspector } from "./inspector.js";
import { startKeys } from "./keys.js";
import { startLookAt } from "./look_at.js";
import { model, on } from "./model.js";
import { startPlayer } from "./player.js";
import { startRejected } from "./rejected.js";
import { startSettings } from "./settings.js";
import { showProgress, startStart } from "./start.js";
import { hearOf, reload, startStates } from "./states.js";
import { startStrokes } from "./strokes.js";
import { startTimeline } from "./timeline.js";
import { startTools } from "./tools.js";

for (const start of [startStart, startStates, startPlayer, startTools, startStrokes, startTimeline, startInspector, startSettings, startLookAt, startRejected, startEvidence, startCorrections, startExport, startKeys]) start();

find("message").querySelector("button").addEventListener("click", () => showMessage(""));
on("fault", () => showMessage(model.fault));

let isLost = false;

listen(
  ({ revision }) => hearOf(revision),
  showProgress,
  (isConnected) => {
    if (isConnected && isLost) {
      showMessage("");
      reload();
    } else if (!isConnected) showMessage(GONE);
    isLost = !isConnected;
  },
);
reload();
