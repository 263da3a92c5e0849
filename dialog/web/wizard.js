// The wizard's seat: shows what the robot sees, what was said and what it proposes, and sends what the wizard decides.
// It knows the messages of the service's socket and nothing of the world behind them.

import { byId, capitalised, element, toast } from "./dom.js";
import { enlargeMap, floor } from "./floor.js";
import { greeted, listen, send, watchSilence } from "./socket.js";
import { forgetSounds, hearState, takeSound } from "./sound.js";
import { buildViews, lookThroughCamera, nextView, showRate, takeFrame, takeMarks, takeSeen } from "./view.js";

/** Binary messages that are pieces of what robots say begin so; all others are frames. */
const SPEECH = 2;
/** What the robot is seen through first. */
const EYES = "eyes/0";

/** What tests and curious people may read. */
window.cohabit = { frames: 0, state: null, view: null, seen: null, marks: [], sounds: [], proposal: null, seat: null };

/** What each robot holds back, by its body. */
const proposals = new Map();
/** What is shown of them: the first, with the body of its robot. */
let shown = null;
let phrases = [];
let longest = Infinity;
let robots = [];
let hasLooked = false;
/** When the time to decide is over, ms of this page's clock, and how long it was. */
let left = null;
/** The turn that was decided a moment ago: what is pressed before the session says so is not about it any more. */
let deciding = null;
/** The fields that are emptied once what stands in them was taken. */
let sent = [];

function takeHello({ session, mission, map, views, robots: all }) {
  greeted();
  byId("session").textContent = session;
  document.title = `${mission.title ? `${mission.title} · ` : ""}Wizard's seat · Cohabit`;
  robots = all;
  byId("robot").replaceChildren(...all.map(({ body, name }) => new Option(capitalised(name), body)));
  byId("robot-field").hidden = all.length < 2;
  floor.build(map);
  buildViews(views);
  if (!hasLooked) lookThroughCamera(EYES);
  hasLooked = true;
  byId("chat").replaceChildren();
  forgetSounds();
  proposals.clear();
  deciding = null;
  showProposal();
}

function takeSeat(seat) {
  window.cohabit.seat = seat;
  ({ phrases } = seat);
  longest = seat.longest_saying;
  const follows = { act: "then the robot does what it proposes", say: "then it says that it takes a moment", wait: "then it waits on" };
  const parts = [];
  if (seat.delay_ms) parts.push(`answers come ${seat.delay_ms / 1000} s after the words`);
  parts.push(seat.timeout_ms ? `${seat.timeout_ms / 1000} s to decide, ${follows[seat.on_timeout]}` : "no time limit");
  byId("policy").textContent = parts.join(" · ");
  byId("phrases").replaceChildren(...phrases.map(({ key, text, waits }) => {
    const button = element("button");
    button.type = "button";
    button.setAttribute("aria-keyshortcuts", key);
    button.append(element("kbd", "", key), element("span", "", text));
    if (waits) button.append(element("span", "hint", "(the proposal waits on)"));
    button.addEventListener("click", () => sayPhrase(key));
    return button;
  }));
  byId("phrases").previousElementSibling.hidden = !phrases.length;
}

function takeProposal({ body, proposal }) {
  if (proposal) proposals.set(body, proposal);
  else proposals.delete(body);
  showProposal();
}

const KINDS = { plan: "The robot would do this:", question: "The robot would ask:", answer: "The robot would answer:", refusal: "The robot would refuse:", stop: "The robot would stop:" };

function showProposal() {
  const [first] = proposals;
  const before = shown;
  shown = first ? { body: first[0], ...first[1] } : null;
  window.cohabit.proposal = shown;
  const isOpen = Boolean(shown) && !shown.is_decided;
  const { classList } = byId("proposal");
  classList.toggle("open", isOpen);
  classList.toggle("decided", Boolean(shown?.is_decided));
  classList.toggle("late", Boolean(shown?.is_late) && isOpen);
  const edits = shown?.edits ?? [];
  setText("said", shown ? shown.said : "");
  const taken = edits.length ? ` Taken as: ${edits.at(-1)}.` : "";
  setText("understood", shown ? `${nameOf(shown.body)}${KINDS[shown.kind] ?? ""}${taken}` : "Nothing is to be decided.");
  const steps = shown?.steps ?? [];
  if (JSON.stringify(steps) !== byId("steps").dataset.shown) {
    byId("steps").dataset.shown = JSON.stringify(steps);
    byId("steps").replaceChildren(...steps.map((step) => element("li", "", step)));
  }
  setText("reply", shown?.reply ? `“${shown.reply}”` : "");
  setText("waiting", shown?.waiting.length ? `Said since: ${shown.waiting.join(" · ")}` : "");
  setText("proposal-state", stateOf(shown));
  byId("to-say-text").textContent = isOpen ? "Say instead" : "Say";
  for (const id of ["accept", "to-edit", "dismiss", "edit"]) byId(id).disabled = !isOpen;
  if (!isOpen && before && document.activeElement === byId("edit")) byId("edit").blur();
  if (before?.turn !== shown?.turn) byId("edit").value = "";
  left = shown?.left_ms === null || !shown ? null : { until: performance.now() + shown.left_ms, all: shown.left_ms };
  byId("left").hidden = left === null;
  showLeft();
}

/** What is the same is not told anew to who listens to the page. */
function setText(id, text) {
  if (byId(id).textContent !== text) byId(id).textContent = text;
}

function stateOf(proposal) {
  if (!proposal) return "";
  if (proposal.is_decided) return "Decided: it is answered once the delay is over";
  if (proposal.is_late) return "Late: the time to decide is over";
  return `Waits for you · the robot is ${Math.round(100 * proposal.sureness)} % sure`;
}

function nameOf(body) {
  const robot = robots.length > 1 && robots.find((one) => one.body === body);
  return robot ? `${capitalised(robot.name)}: ` : "";
}

function showLeft() {
  if (left) byId("left").value = left.all ? Math.max(0, (left.until - performance.now()) / left.all) : 0;
}

/** Sends a decision; `from` are the fields that it was written in. */
function decide(decision, body = shown?.body ?? Number(byId("robot").value || 0), from = []) {
  byId("problem").textContent = "";
  sent = from;
  if (decision.type !== "edit" && decision.turn !== null) deciding = decision.turn;
  if (!send({ type: "decide", body, decision })) toast("There is no connection at the moment; please try again in a while.");
}

const turnNow = () => (shown && !shown.is_decided && shown.turn !== deciding ? shown.turn : null);

function accept() {
  if (turnNow() === null) return;
  decide({ type: "accept", turn: shown.turn, revision: shown.revision });
}

function dismiss() {
  if (turnNow() !== null) decide({ type: "own", turn: shown.turn });
}

function sayPhrase(key) {
  const phrase = phrases.find((one) => one.key === key);
  if (phrase) decide({ type: "own", turn: phrase.waits ? null : turnNow(), phrase: key });
}

function stopRobot() {
  decide({ type: "own", turn: turnNow(), order: "stop" });
}

function takeDecided({ problem }) {
  byId("problem").textContent = problem ?? "";
  if (problem) deciding = null;
  else for (const field of sent) field.value = "";
  sent = [];
}

byId("orders").addEventListener("submit", (event) => {
  event.preventDefault();
  const [edit, say, order] = ["edit", "say", "order"].map(byId);
  if (!say.value.trim() && !order.value.trim()) {
    if (!edit.disabled && edit.value.trim()) {
      decide({ type: "edit", turn: shown.turn, text: edit.value }, shown.body, [edit]);
      // Enter then accepts what is proposed anew.
      edit.blur();
    } else if (document.activeElement === edit) {
      edit.blur();
    }
    return;
  }
  const problem = [say, order].find((field) => [...field.value].length > longest);
  if (problem) {
    byId("problem").textContent = `The robot says and is told ${longest} characters at most.`;
    problem.focus();
    return;
  }
  decide({ type: "own", turn: turnNow(), say: say.value, order: order.value }, undefined, [edit, say, order]);
  document.activeElement?.blur();
});

byId("accept").addEventListener("click", accept);
byId("dismiss").addEventListener("click", dismiss);
byId("stop").addEventListener("click", stopRobot);
const to = (id) => () => byId(id).focus();
byId("to-edit").addEventListener("click", startEdit);
byId("to-say").addEventListener("click", to("say"));
byId("to-order").addEventListener("click", to("order"));

/** The words stand in the field to begin with: most edits are small. */
function startEdit() {
  const edit = byId("edit");
  if (edit.disabled) return;
  if (!edit.value) edit.value = shown.edits.at(-1) ?? shown.said;
  edit.focus();
  edit.select();
}

const KEYS = { Enter: accept, "=": startEdit, "/": to("say"), "-": to("order"), Delete: dismiss, Escape: stopRobot };

/** Keys decide wherever the focus is, but where something is typed or chosen, and where Enter presses a button. */
document.addEventListener("keydown", (event) => {
  if (event.altKey && event.code === "KeyC" && !event.ctrlKey && !event.metaKey) {
    event.preventDefault();
    nextView();
    return;
  }
  if (event.isComposing || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
  const { target, key } = event;
  if (target.matches("input, select, textarea")) {
    if (key !== "Escape") return;
    event.preventDefault();
    target.blur();
    return;
  }
  if (key === "Enter" && target.matches("button, a")) return;
  const does = KEYS[key] ?? (phrases.some((one) => one.key === key) ? () => sayPhrase(key) : null);
  if (!does) return;
  event.preventDefault();
  if (key === "Escape") enlargeMap(false);
  does();
});

/** A click on a thing writes its name where somebody types: the field keeps the focus. */
byId("view").addEventListener("mousedown", (event) => event.preventDefault());

function writeName({ name }) {
  const field = document.activeElement;
  if (!field?.matches("#orders input[type=text]")) return;
  const before = field.value.slice(0, field.selectionStart);
  const space = before && !before.endsWith(" ") ? " " : "";
  field.setRangeText(space + name, field.selectionStart, field.selectionEnd, "end");
}

const SPEAKERS = { person: "Participant: ", robot: "Robot: ", game: "" };
const NEAR_END_PX = 60;

function addLine(line) {
  const log = byId("chat");
  const atEnd = log.scrollHeight - log.scrollTop - log.clientHeight < NEAR_END_PX;
  log.append(line);
  if (atEnd) log.scrollTop = log.scrollHeight;
}

function takeLine({ from, kind, text, body, answers = [] }) {
  const line = element("div", `line from-${from} kind-${kind}`);
  if (from === "robot" && body !== undefined) line.append(element("b", "said-for", nameOf(body).replace(": ", "")));
  line.append(element("span", "unseen", SPEAKERS[from] ?? ""), element("span", "line-text", text));
  if (answers.length) line.append(element("span", "said-for", `Offered: ${answers.map((one) => one.text).join(", ")}`));
  addLine(line);
}

function takeUnsaid({ text }) {
  const line = element("div", "line unsaid");
  line.append(element("b", "said-for", "Told to you alone"), element("span", "line-text", text));
  addLine(line);
}

/** What each robot is about, by its body. */
const doing = new Map();

function showDoing() {
  byId("doing").textContent = [...doing.values()].join(", ") || "Nothing";
}

function takeState(state) {
  window.cohabit.state = state;
  const { robot, others, notes, goals } = state;
  byId("room").textContent = capitalised(robot?.room_name ?? "–");
  byId("holding").textContent = capitalised(robot?.holding ?? "nothing");
  const met = goals.filter((goal) => goal.met).length;
  const open = goals.filter((goal) => !goal.met && !goal.hidden).map((goal) => goal.text);
  setText("goals", goals.length ? [`${met} of ${goals.length}`, ...open].join(" · ") : "None");
  document.body.classList.toggle("busy", Boolean(robot?.busy));
  floor.follow(robot);
  floor.showOthers(others);
  floor.showNotes(notes);
  hearState(state);
}

setInterval(() => {
  showRate();
  watchSilence();
}, 500);
setInterval(showLeft, 100);
showDoing();
listen({
  hello: takeHello,
  seat: takeSeat,
  proposal: takeProposal,
  unsaid: takeUnsaid,
  decided: takeDecided,
  state: takeState,
  chat: takeLine,
  progress: ({ body, text }) => {
    doing.set(body, `${nameOf(body)}${capitalised(text)}`);
    showDoing();
  },
  turn: ({ body, ended }) => {
    if (ended) doing.delete(body);
    showDoing();
  },
  seen: (seen) => {
    takeSeen(seen);
    writeName(seen);
  },
  marks: takeMarks,
  sound: takeSound,
  highlight: (message) => floor.pointOut(message),
  error: (message) => toast(message.text),
  binary: (buffer) => {
    if (new Uint8Array(buffer, 0, 1)[0] !== SPEECH) takeFrame(buffer);
  },
  lost: () => {
    doing.clear();
    showDoing();
    proposals.clear();
    showProposal();
  },
});
