// The time bar of a recorded session: where it is, where it goes, and how fast.

import { byId, element } from "./dom.js";
import { send } from "./socket.js";
import { clearChat, endDoing, takeLine } from "./talk.js";
import { text } from "./texts.js";

/** A slider that is dragged asks for another time so often, ms. */
const SEEK_EVERY_MS = 120;
const ARROW_S = 5;

let span = null;
let tickS = 1 / 60;
let paused = true;
let tick = 0;
/** The time that was asked for and is not there yet. */
let wanted = null;
let askedAt = 0;
let pending = 0;

export const isReplay = () => span !== null;

/** Makes the page one of a recorded session, if it is greeted by one. */
export function buildReplay(replay) {
  document.body.classList.toggle("replay", Boolean(replay));
  byId("timebar").hidden = !replay;
  if (!replay) return;
  span = replay.span;
  tickS = replay.tick_s;
  tick = span[0];
  const track = byId("track");
  [track.min, track.max] = span;
  byId("time-end").textContent = clock(span[1]);
  byId("track-marks").replaceChildren(...replay.marks.map(markOf));
  showTime();
}

function markOf({ tick: at, kind, text: words }) {
  const mark = element("button", `mark-of-${kind}`);
  mark.type = "button";
  mark.tabIndex = -1;
  mark.title = `${clock(at)}  ${words}`;
  mark.style.left = `${100 * share(at)}%`;
  mark.addEventListener("click", () => seek(at));
  return mark;
}

function share(at) {
  return (at - span[0]) / Math.max(1, span[1] - span[0]);
}

function clock(at) {
  const seconds = Math.floor(at * tickS);
  const [hours, minutes] = [Math.floor(seconds / 3600), Math.floor(seconds / 60) % 60];
  const two = (number) => String(number).padStart(2, "0");
  return `${hours ? `${hours}:${two(minutes)}` : minutes}:${two(seconds % 60)}`;
}

/** Where the session is now, and how it goes. */
export function takePlayer(state) {
  if (!span || !state.player) return;
  paused = state.player.paused;
  tick = state.tick;
  if (wanted === tick) wanted = null;
  byId("play").classList.toggle("playing", !paused);
  byId("play").setAttribute("aria-label", paused ? text("play") : text("pause"));
  byId("pace").value = String(state.player.speed);
  showTime();
}

function showTime() {
  const at = wanted ?? tick;
  byId("track").value = at;
  byId("track").style.setProperty("--past", `${100 * share(at)}%`);
  byId("track").setAttribute("aria-valuetext", clock(at));
  byId("time-now").textContent = clock(at);
}

/** What was said up to where the session is now. */
export function takeRewind({ lines }) {
  clearChat();
  endDoing();
  byId("latency").textContent = "";
  lines.forEach(takeLine);
  byId("chat").removeAttribute("aria-busy");
}

function seek(at) {
  wanted = Math.round(Math.min(span[1], Math.max(span[0], at)));
  showTime();
  clearTimeout(pending);
  const ask = () => {
    askedAt = performance.now();
    send({ type: "seek", tick: wanted });
  };
  const early = askedAt + SEEK_EVERY_MS - performance.now();
  if (early > 0) pending = setTimeout(ask, early);
  else ask();
}

function togglePlay() {
  if (paused && tick >= span[1]) seek(span[0]);
  send({ type: paused ? "resume" : "pause" });
}

/** Space plays and pauses; the arrows go five seconds on or back, Home and End to the ends. Whether a key was one. */
export function takeReplayKey(event) {
  if (!isReplay() || event.ctrlKey || event.metaKey || event.altKey) return false;
  const steps = { ArrowLeft: -ARROW_S, ArrowRight: ARROW_S };
  const focused = document.activeElement;
  if (focused instanceof HTMLSelectElement) return true;
  if (event.key === " " && !(focused instanceof HTMLButtonElement)) togglePlay();
  else if (event.key in steps) seek((wanted ?? tick) + steps[event.key] / tickS);
  else if (event.key === "Home") seek(span[0]);
  else if (event.key === "End") seek(span[1]);
  else return true;
  event.preventDefault();
  return true;
}

byId("play").addEventListener("click", togglePlay);
byId("track").addEventListener("input", ({ target }) => seek(Number(target.value)));
byId("pace").addEventListener("change", ({ target }) => send({ type: "speed", factor: Number(target.value) }));
