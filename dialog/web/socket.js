// The page's one connection to the session: reconnects by itself, and shows how it stands.

import { byId } from "./dom.js";
import { text } from "./texts.js";

const FIRST_PAUSE_MS = 500;
const LONGEST_PAUSE_MS = 5000;
/** A session sends its state many times a second; this long without a word means that it hangs. */
const SILENCE_MS = 4000;
/** And this long, that the connection is dead: longer than the session waits for a page. */
const DEAD_MS = 20_000;

let receivers = {};
let socket = null;
let pauseMs = FIRST_PAUSE_MS;
let heardAt = 0;

/** By which the session knows this page when it connects again. */
const KEY = recallKey();

/** A browser may refuse to keep anything; a page that is loaded anew is then somebody new. */
function recallKey() {
  const fresh = String(crypto.getRandomValues(new Uint32Array(1))[0]);
  try {
    const key = sessionStorage.getItem("visitor") ?? fresh;
    sessionStorage.setItem("visitor", key);
    return key;
  } catch {
    return fresh;
  }
}

/** What lets this page into its session. */
const token = new URLSearchParams(location.search).get("token");

/**
 * Keeps what somebody chose for the pages of this session: who plays the next one, perhaps at the same machine, begins without it. A
 * browser may refuse to keep anything.
 */
export function keepChoice(name, value) {
  try {
    localStorage.setItem(name, JSON.stringify({ of: token, value }));
  } catch {}
}

/** What was kept so; nothing, if it was chosen in another session. */
export function keptChoice(name) {
  try {
    const kept = JSON.parse(localStorage.getItem(name));
    return kept?.of === token ? kept.value : undefined;
  } catch {
    return undefined;
  }
}

function socketAddress() {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const parameters = new URLSearchParams({ visitor: KEY, ...(token !== null && { token }) });
  return `${scheme}://${location.host}/ws?${parameters}`;
}

/** What to call for each type of message, for `binary` ones, and when the connection is `lost`. */
export function listen(to) {
  receivers = to;
  connect();
}

function connect() {
  socket = new WebSocket(socketAddress());
  socket.binaryType = "arraybuffer";
  socket.onopen = () => { heardAt = performance.now(); };
  socket.onmessage = ({ data }) => {
    heardAt = performance.now();
    if (typeof data === "string") take(JSON.parse(data));
    else receivers.binary(data);
  };
  socket.onclose = lose;
}

function lose() {
  showLink("lost");
  receivers.lost();
  setTimeout(connect, pauseMs);
  pauseMs = Math.min(pauseMs * 1.8, LONGEST_PAUSE_MS);
}

/** A browser that was asleep while the session gave it up is told nothing of that: it would wait for ever. */
function connectAnew() {
  [socket.onopen, socket.onmessage, socket.onclose] = [null, null, null];
  socket.close();
  lose();
}

export function send(message) {
  if (socket?.readyState !== WebSocket.OPEN) return false;
  socket.send(JSON.stringify(message));
  return true;
}

/** More sound than this does not wait to be sent: it is too late then. */
const MOST_WAITING_BYTES = 256 << 10;

export function sendSound(piece) {
  if (socket?.readyState === WebSocket.OPEN && socket.bufferedAmount < MOST_WAITING_BYTES) socket.send(piece);
}

function take(message) {
  receivers[message.type]?.(message);
}

export function showLink(link) {
  const { classList } = document.body;
  classList.remove("connecting", "open", "lost", "quiet");
  classList.add(link);
  const words = { connecting: text("connecting"), open: text("connected"), lost: text("not_connected"), quiet: text("no_word") };
  byId("link-text").textContent = words[link];
  const notices = {
    lost: text("session_lost"),
    quiet: text("session_quiet"),
    open: window.cohabit.frames ? "" : text("waiting_for_picture"),
  };
  showNotice(notices[link] ?? "");
}

/** A session has greeted this page. */
export function greeted() {
  pauseMs = FIRST_PAUSE_MS;
  showLink("open");
}

function showNotice(words) {
  byId("notice-text").textContent = words;
  byId("notice").hidden = !words;
}

export function watchSilence() {
  if (socket?.readyState !== WebSocket.OPEN || !heardAt) return;
  const silentMs = performance.now() - heardAt;
  if (silentMs > DEAD_MS) {
    connectAnew();
    return;
  }
  const silent = silentMs > SILENCE_MS;
  const { classList } = document.body;
  if (silent && classList.contains("open")) showLink("quiet");
  else if (!silent && classList.contains("quiet")) showLink("open");
}
