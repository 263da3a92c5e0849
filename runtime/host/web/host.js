// The page of all sessions: how they are, what they take, and buttons that start and end them.

import { byId, button, element } from "./dom.js";

const ASK_EVERY_MS = 1000;
const GIVE_UP_MS = 8000;
const MEGABYTE = 1 << 20;

const here = location.pathname.replace(/\/$/, "");
/** What the rows were built of, so that they are built anew only when they differ and the focus stays. */
let built = "";
/** What was asked last: older answers do not count. */
let count = 0;
let timer = null;

/** Asks the server something and shows what it says; gives what is wrong, in words, or nothing. */
async function ask(path, body) {
  const number = ++count;
  const request = { signal: AbortSignal.timeout(GIVE_UP_MS) };
  if (body !== undefined) Object.assign(request, { method: "POST", body: JSON.stringify(body), headers: { "content-type": "application/json" } });
  try {
    const answer = await fetch(`${here}/${path}`, request);
    if (!answer.ok) throw new Error(`status ${answer.status}`);
    const state = await answer.json();
    byId("offline").hidden = true;
    if (number === count) show(state);
    return state.problem ?? "";
  } catch {
    byId("offline").hidden = false;
    return "";
  }
}

async function refresh() {
  await ask("state");
  clearTimeout(timer);
  timer = setTimeout(refresh, ASK_EVERY_MS);
}

async function order(command) {
  byId("problem").textContent = await ask("command", command);
}

function show(state) {
  set(byId("load"), state.cores ? `${state.busy_cores.toFixed(1)} of ${state.cores.toFixed(0)} cores busy` : "");
  set(byId("memory"), state.free_bytes ? `${Math.round(state.free_bytes / MEGABYTE)} MB free` : "");
  set(byId("caption"), `${state.open} of ${state.sessions.length} sessions can be opened`);
  set(byId("shares"), state.shares);
  const form = JSON.stringify(state.sessions.map(({ number, mission, wanted, port, token }) => [number, mission, wanted, port, token]));
  if (form !== built) {
    built = form;
    build(state.sessions);
  }
  state.sessions.forEach((one, index) => fill(byId("rows").children[index], one, state.most_missed));
}

function build(sessions) {
  const label = byId("rows").contains(document.activeElement) ? document.activeElement.getAttribute("aria-label") : null;
  byId("rows").replaceChildren(...sessions.map(rowOf));
  // Who has just started or ended one finds the other button at the same place.
  const all = [...byId("rows").querySelectorAll("[aria-label]")];
  const isSameRow = (one) => one.tagName === "BUTTON" && one.getAttribute("aria-label").split(" ").pop() === label.split(" ").pop();
  const again = label && (all.find((one) => one.getAttribute("aria-label") === label) ?? all.find(isSameRow));
  if (again) again.focus({ preventScroll: true });
}

function rowOf(one) {
  const name = element("th", "", String(one.number));
  name.scope = "row";
  const cells = Array.from({ length: 4 }, () => element("td"));
  const action = one.wanted
    ? labelled(button("danger", "Stop", () => confirm(`End session ${one.number}?`) && order({ stop: one.number })), `Stop session ${one.number}`)
    : labelled(button("quiet", "Start", () => order({ start: one.number })), `Start session ${one.number}`);
  return element("tr", "", name, element("td", "", one.mission), element("td", "", ...linkOf(one)), ...cells, element("td", "buttons", action));
}

function labelled(made, text) {
  made.setAttribute("aria-label", text);
  return made;
}

function linkOf({ number, port, token }) {
  if (!port) return [];
  const link = element("a", "", "Open");
  link.href = `${location.protocol}//${location.hostname}:${port}/?token=${token}`;
  link.target = "_blank";
  link.rel = "noopener";
  return [labelled(link, `Open session ${number}`)];
}

function fill(row, one, mostMissed) {
  const texts = [
    stateOf(one),
    typeof one.cores === "number" ? one.cores.toFixed(2) : "",
    typeof one.memory_bytes === "number" && one.memory_bytes ? `${Math.round(one.memory_bytes / MEGABYTE)} MB` : "",
    typeof one.missed === "number" ? `${(100 * one.missed).toFixed(2)} %` : "",
  ];
  texts.forEach((text, index) => set(row.children[index + 3], text));
  row.classList.toggle("alarm", one.missed > mostMissed);
}

function stateOf({ state, why, position }) {
  if (state === "waiting") return `waits, ${position === 1 ? "next" : `number ${position}`}${why ? `: ${why}` : ""}`;
  return why ? `${state}: ${why}` : state;
}

/** What is the same is not told anew to who listens to the page. */
function set(to, text) {
  if (to.textContent !== text) to.textContent = text;
}

refresh();
