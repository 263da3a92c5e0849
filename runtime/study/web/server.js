// What the page asks the study's server, and tells it. Lost connections are tried again for ever.

import { text } from "./texts.js";

const ASK_EVERY_MS = 1000;
const GIVE_UP_MS = 8000;

/** What this page calls itself, by which the server tells it from another one that is opened by the same link. */
const PAGE = `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;

const here = location.pathname.replace(/\/$/, "");
let listen = () => {};
let onLost = () => {};
let timer = null;
let isOver = false;
/** What was asked last: older answers do not count. */
let count = 0;

async function ask(path, body, keepalive = false) {
  const request = { signal: AbortSignal.timeout(GIVE_UP_MS) };
  if (body !== undefined) {
    Object.assign(request, { method: "POST", body: JSON.stringify(body), headers: { "content-type": "application/json" }, keepalive });
  }
  const answer = await fetch(`${here}/${path}?page=${PAGE}`, request);
  if (answer.status === 404) return { page: "unknown" };
  if (!answer.ok) throw new Error(`status ${answer.status}`);
  return answer.json();
}

async function refresh() {
  const number = ++count;
  try {
    const state = await ask("state");
    onLost(false);
    if (number === count) listen(state);
  } catch {
    onLost(true);
  }
  clearTimeout(timer);
  if (!isOver) timer = setTimeout(refresh, ASK_EVERY_MS);
}

/** Has `show` called with what the server says, again and again, and `lost` with whether it cannot be reached. */
export function follow(show, lost) {
  listen = show;
  onLost = lost;
  refresh();
}

/** Asks no more. */
export function endFollowing() {
  isOver = true;
  clearTimeout(timer);
}

/** Tells the server something; gives what is wrong with it, in words, or nothing. */
export async function tell(path, body) {
  const number = ++count;
  try {
    const state = await ask(path, body);
    onLost(false);
    if (number === count) listen(state);
    return state.problem ?? "";
  } catch {
    onLost(true);
    return text("no_connection");
  }
}

/** Tells the server something that nobody waits for, also when the page is about to go; whether it was taken in. */
export async function tellQuietly(path, body, isLast) {
  try {
    const state = await ask(path, body, isLast);
    return state.page !== "unknown" && !state.problem;
  } catch {
    return false;
  }
}
