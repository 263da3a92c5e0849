// What pages of people and of wizards have in common beyond what they show: pieces of sound among frames, the key that changes the
// view, and the watch over the connection.

import { toast } from "./dom.js";
import { send, watchSilence } from "./socket.js";
import { text } from "./texts.js";
import { nextView, showRate } from "./view.js";

/** Binary messages that are pieces of what robots say begin so; all others are frames. */
const SPEECH = 2;
const WATCH_EVERY_MS = 500;

export const isSpeech = (buffer) => new Uint8Array(buffer, 0, 1)[0] === SPEECH;

/** Alt+C changes the view, whatever has the focus. Whether it was that. */
export function takeViewKey(event) {
  if (!event.altKey || event.code !== "KeyC" || event.ctrlKey || event.metaKey) return false;
  event.preventDefault();
  nextView();
  return true;
}

/** Sends a message, or says that it cannot be sent. Whether it was sent. */
export function sendOrSay(message) {
  const isSent = send(message);
  if (!isSent) toast(text("no_connection"));
  return isSent;
}

export function keepWatch() {
  setInterval(() => {
    showRate();
    watchSilence();
  }, WATCH_EVERY_MS);
}
