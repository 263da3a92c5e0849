// The editor's page: asks the server, shows its answers, and keeps edits in order. What is edited is a part's own.

import { byId, button, element } from "./dom.js";
import { missionPart } from "./mission.js";
import { planPart } from "./plan.js";
import { text } from "./texts.js";

const TYPED_AFTER_MS = 500;

const here = location.pathname.replace(/\/$/, "");
let state = null;
let part = null;
/** One thing is asked after the other: each edit is of the text that the one before has left. */
let queue = Promise.resolve();
let typing = null;

async function ask(path, body) {
  const request = body === undefined ? {} : { method: "POST", body: JSON.stringify(body), headers: { "content-type": "application/json" } };
  const answer = await fetch(`${here}/${path}`, request);
  if (!answer.ok) throw new Error(`status ${answer.status}`);
  return answer.json();
}

function inOrder(work) {
  queue = queue.then(work).then(
    () => { byId("offline").hidden = true; },
    (error) => {
      byId("offline").hidden = false;
      console.warn(error);
    },
  );
  return queue;
}

/** Changes the text; `said` is told when it is done. */
function edit(change, said = "") {
  return inOrder(async () => {
    show(await ask("edit", { revision: state.revision, edit: change }));
    if (!state.problem && said) say(said);
  });
}

function wish(what) {
  return inOrder(async () => show(await ask("wish", what)));
}

/** Has screen readers say something. */
function say(words) {
  byId("said").textContent = words;
}

function play() {
  say(text("starting"));
  byId("play").disabled = true;
  return inOrder(async () => {
    try {
      show(await ask("play", null));
    } finally {
      byId("play").disabled = false;
    }
    if (!state.played) return;
    byId("session").href = state.played;
    byId("session").hidden = false;
    say(text("playing"));
  });
}

function show(next) {
  state = next;
  byId("problem").textContent = state.problem ?? "";
  byId("saved").textContent = state.is_saved ? text("is_saved") : text("is_not_saved");
  byId("undo").disabled = !state.has_past;
  byId("redo").disabled = !state.has_future;
  const area = byId("text");
  if (document.activeElement !== area) area.value = state.text;
  part.show(state);
  showFaults();
  showPictures();
}

function showFaults() {
  const { faults } = state;
  byId("sound").textContent = faults.length === 0 ? text("no_faults") : text("some_faults", { count: faults.length });
  byId("faults").replaceChildren(...faults.map((fault) => {
    const what = element("p", "what", fault.message);
    if (fault.remedy) what.append(" – ", element("span", "remedy", fault.remedy));
    const row = element("li", "", what);
    if (part.canPoint(fault)) {
      const pointer = button("quiet", text("show"), () => part.point(fault));
      pointer.setAttribute("aria-label", `${text("show")}: ${fault.message}`);
      row.append(pointer);
    }
    return row;
  }));
  byId("complete").hidden = !faults.some((fault) => fault.is_lack);
}

function showPictures() {
  byId("undrawn").hidden = state.is_drawn;
  byId("above").hidden = byId("within").hidden = !state.is_drawn;
  const eyes = part.eyes(state);
  const chosen = byId("eye").value;
  byId("eye").replaceChildren(...eyes.map(({ value, words }) => new Option(words, value)));
  if (eyes.some(({ value }) => value === chosen)) byId("eye").value = chosen;
  byId("eye").disabled = eyes.length === 0;
  if (!state.is_drawn) return;
  look("above", "above");
  if (byId("eye").value) look("within", byId("eye").value);
}

/** Has a picture of the present text drawn, if it is another one. */
function look(id, eye) {
  const source = `${here}/picture/${state.revision}/${eye}`;
  if (byId(id).getAttribute("src") !== source) byId(id).src = source;
}

function onKey(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  const isWriting = event.target.matches("textarea, input:not([type=radio])");
  const key = event.key.toLowerCase();
  if (key === "s") wish("save");
  else if (key === "z" && !isWriting) wish(event.shiftKey ? "redo" : "undo");
  else if (key === "y" && !isWriting) wish("redo");
  else return;
  event.preventDefault();
}

async function begin() {
  const [choices, first] = [await ask("choices"), await ask("state")];
  byId("file").textContent = choices.file;
  document.title = `${choices.file} – ${text("title")}`;
  part = { plan: planPart, mission: missionPart }[first.kind]({ choices, edit, say, ask });
  show(first);
  byId("undo").addEventListener("click", () => wish("undo"));
  byId("redo").addEventListener("click", () => wish("redo"));
  byId("save").addEventListener("click", () => wish("save"));
  byId("play").addEventListener("click", play);
  byId("complete").addEventListener("click", () => edit({ do: "complete" }));
  byId("eye").addEventListener("change", () => look("within", byId("eye").value));
  byId("text").addEventListener("input", () => {
    clearTimeout(typing);
    typing = setTimeout(() => edit({ do: "text", text: byId("text").value }), TYPED_AFTER_MS);
  });
  document.addEventListener("keydown", onKey);
  addEventListener("beforeunload", (event) => { if (!state.is_saved) event.preventDefault(); });
}

inOrder(begin);
