// The one statement about the shape. The server works it out; whatever speaks of the shape on this page reads it here.

import { capital, seconds } from "./format.js";

const COMPUTING = { kind: "computing", words: "Computing", isStale: true };

/** Whether a shape is computed for so long that the page offers its end. */
export const isLong = ({ searching, busy, engine, settling, badge }) =>
  Boolean(searching || (busy && engine === "computing") || (settling && badge?.kind === "computing"));

/** What each state means. */
export const MEANINGS = {
  computing: "A newer shape is on its way.",
  none: "This design has no preview and is shown as it is printed: the exact model computes its shape.",
  outdated: "The shape is of an earlier state of the design.",
  doubtful: "The computation ended without a certified minimum.",
  preview: "Root mean square distance to the exact shape, in percent of the diameter. The exact shape follows in a pause.",
  exact: "A certified minimum of the exact model. The error of its mesh is in percent of the diameter.",
};

/** The state of the shape that is drawn; what the server says of a frame that is still under way is not said of it. */
export function badgeOf({ state: { badge, busy }, frame, connection, document }) {
  const waits = busy ? "Starting" : "Ready";
  if (!document || !badge) return { kind: "computing", words: connection === "open" ? waits : "Connecting" };
  if (connection === "lost") return { kind: "outdated", words: "Outdated", isStale: true };
  const isDrawn = frame ? frame.revision === badge.revision && frame.stage === badge.stage : badge.revision === null;
  return isDrawn ? { ...badge, isStale: badge.is_stale } : COMPUTING;
}

const SEARCHES = { flip: "Searching for the other side", form: "Searching for the other form" };

/** How long an exact shape still takes, as long as the estimate says something, then how long it has taken. */
function timeOf({ begun, about_s: about }) {
  const taken = performance.now() / 1000 - begun;
  return taken < about ? `about ${seconds(Math.ceil(about - taken), 0)} left` : `${seconds(Math.floor(taken), 0)} so far`;
}

/** What is being done for the shape, in a few words; empty if nothing. */
export function activityOf({ state, connection, document }) {
  const { engine, busy, searching, settling } = state;
  if (connection === "lost") return "Connection lost, trying again";
  if (searching) return `${SEARCHES[searching]}, Esc cancels`;
  if (busy) return isLong(state) ? `${capital(busy)}, Esc cancels` : capital(busy);
  if (engine === "starting") return "Engine starts";
  if (engine === "failed") return "Engine restarts";
  if (settling && document) return `Exact shape, ${timeOf(settling)}`;
  return "";
}

export const dotOf = ({ kind }, activity) =>
  ({ outdated: "bad", doubtful: "bad", computing: "busy" })[kind] ?? (activity ? "busy" : kind);
