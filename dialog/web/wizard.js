// The wizard's seat: shows what the robot sees, what was said and what it proposes, and sends what the wizard decides.
// It knows the messages of the service's socket and nothing of the world behind them.

import { byId, capitalised, element, toast } from "./dom.js";
import { faceOf, meetFaces, takeExpression } from "./face.js";
import { enlargeMap, floor } from "./floor.js";
import { isMenuOpen, noteClick, openMenu, takeMenuKey } from "./menu.js";
import { isSpeech, keepWatch, sendOrSay, takeViewKey } from "./page.js";
import { greeted, listen, send } from "./socket.js";
import { forgetSounds, hearState, takeSound } from "./sound.js";
import { buildViews, lookThroughCamera, pointWith, takeFrame, takeMarks, takeSeen } from "./view.js";

/** What the robot is seen through first. */
const EYES = "eyes/0";

/** What tests and curious people may read. */
window.cohabit = { frames: 0, state: null, view: null, seen: null, marks: [], sounds: [], proposal: null, seat: null, menu: null };

/** What each robot holds back, by its body. */
const proposals = new Map();
/** What is shown of them: the first that is to be decided, with the body of its robot. */
let shown = null;
let phrases = [];
let expressions = [];
let longest = Infinity;
let robots = [];
let hasLooked = false;
/** When the time to decide is over, ms of this page's clock, and how long it was. */
let left = null;
/** The turn that was decided a moment ago: what is pressed before the session says so is not about it any more. */
let deciding = null;
/** What was written for each decision that is not answered yet, by its fields: it is given back if it is not taken. */
let sent = [];
/** The turn for which an edit is written: a connection that comes again brings the same one. */
let edited = null;

function takeHello({ session, mission, map, views, robots: all }) {
  greeted();
  byId("session").textContent = session;
  document.title = `${mission.title ? `${mission.title} · ` : ""}Wizard's seat · Cohabit`;
  robots = all;
  byId("robot").replaceChildren(...all.map(({ body, name }) => new Option(capitalised(name), body)));
  byId("robot-field").hidden = all.length < 2;
  meetFaces(all);
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
  showErrors(seat.errors);
  expressions = seat.expressions;
  byId("expressions").replaceChildren(...expressions.map((expression, index) => {
    const key = `Alt+${index + 1}`;
    const button = element("button");
    button.type = "button";
    button.setAttribute("aria-keyshortcuts", key);
    button.append(faceOf(expression), element("span", "", capitalised(expression)), element("kbd", "", key));
    button.addEventListener("click", () => express(expression));
    return button;
  }));
}

/** The planned errors, each with what the robot would say and do. */
function showErrors(errors) {
  byId("errors").replaceChildren(...errors.map(({ name, say, do: does, step }) => {
    const button = element("button");
    button.type = "button";
    const parts = [say && `says “${say}”`, does && (step ? `step ${step}: ${does}` : does)];
    button.append(element("span", "", name), element("span", "hint", parts.filter(Boolean).join(" · ")));
    button.addEventListener("click", () => decide({ type: "inject", turn: turnNow(), error: name }));
    return button;
  }));
  byId("errors").parentElement.hidden = !errors.length;
}

function takeProposal({ body, proposal }) {
  if (proposal) proposals.set(body, proposal);
  else proposals.delete(body);
  showProposal();
}

const KINDS = { plan: "The robot would do this:", question: "The robot would ask:", answer: "The robot would answer:", refusal: "The robot would refuse:", stop: "The robot would stop:" };

function showProposal() {
  const all = [...proposals];
  // What is to be decided comes before what was decided and is answered later.
  const first = all.find(([, proposal]) => !proposal.is_decided) ?? all[0];
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
  if (shown && shown.turn !== edited) {
    edited = shown.turn;
    byId("edit").value = "";
  }
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

/** The robot that is meant, by its body: the one that waits for a decision, or else the one that is chosen. */
const robotNow = () => shown?.body ?? Number(byId("robot").value || robots[0]?.body || 0);

/** Sends a decision, and empties the fields that it was written in. */
function decide(decision, body = robotNow(), from = []) {
  byId("problem").textContent = "";
  if (!sendOrSay({ type: "decide", body, decision })) return;
  if (decision.type !== "edit" && decision.turn !== undefined && decision.turn !== null) deciding = decision.turn;
  sent.push(from.map((field) => [field, field.value]));
  for (const field of from) field.value = "";
}

/** What was written and not taken stands in its fields again, unless something else does. */
function giveBack(written) {
  for (const [field, value] of written) field.value ||= value;
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

function express(expression) {
  decide({ type: "express", expression });
}

/** What is no answer to what was said: a gesture, or a step aside. What is proposed waits on. */
const GESTURES = ["point", "look", "turn", "move"];

function doClicked(click, body = robotNow()) {
  decide({ type: "click", turn: GESTURES.includes(click.does) ? null : turnNow(), click }, body);
}

function takeMenu({ body, name, choices }) {
  window.cohabit.menu = choices;
  // Who types has the name written where they type.
  if (isWriting()) return;
  openMenu(name, choices, ({ click }) => doClicked(click, body));
}

function stopRobot() {
  decide({ type: "own", turn: turnNow(), order: "stop" });
}

function takeDecided({ problem }) {
  const written = sent.shift() ?? [];
  byId("problem").textContent = problem ?? "";
  if (!problem) return;
  deciding = null;
  giveBack(written);
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

const STEP_M = 0.5;
const TURN_RAD = Math.PI / 6;
/** What arrows have the robot do. */
const STEPS = {
  ArrowUp: { does: "move", distance_m: STEP_M },
  ArrowDown: { does: "move", distance_m: -STEP_M },
  ArrowLeft: { does: "turn", yaw_rad: TURN_RAD },
  ArrowRight: { does: "turn", yaw_rad: -TURN_RAD },
};

/** Alt and a digit have the robot's face show something. Whether it was that. */
function takeFaceKey(event) {
  const digit = /^Digit([1-9])$/.exec(event.code)?.[1];
  const expression = expressions[digit - 1];
  if (!event.altKey || event.ctrlKey || event.metaKey || event.repeat || !expression) return false;
  event.preventDefault();
  express(expression);
  return true;
}

/** What keys do that stand for no letter: arrows scroll the conversation where it has the focus. */
function actionOf(key, target) {
  if (key in STEPS) return target.matches("#chat") ? null : () => doClicked(STEPS[key]);
  return KEYS[key] ?? (phrases.some((one) => one.key === key) ? () => sayPhrase(key) : null);
}

/** Keys decide wherever the focus is, but where something is typed or chosen, and where Enter presses a button. */
document.addEventListener("keydown", (event) => {
  if (takeViewKey(event) || takeFaceKey(event)) return;
  if (event.isComposing || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
  const { target, key } = event;
  if (target.matches("input, select, textarea")) {
    if (key !== "Escape") return;
    event.preventDefault();
    target.blur();
    return;
  }
  if (isMenuOpen() && takeMenuKey(event)) {
    event.preventDefault();
    return;
  }
  if (key === "Enter" && target.matches("button, a")) return;
  const does = actionOf(key, target);
  if (!does) return;
  event.preventDefault();
  if (key === "Escape") enlargeMap(false);
  does();
});

/** A click on a thing writes its name where somebody types, so the field keeps the focus; else it offers what can be done. */
byId("view").addEventListener("mousedown", (event) => event.preventDefault());
byId("view").addEventListener("click", noteClick);
pointWith(() => ({ body: robotNow() }));

byId("map").addEventListener("click", (event) => {
  const inPlan = byId("map").getScreenCTM()?.inverse();
  if (!inPlan) return;
  noteClick(event);
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(inPlan);
  send({ type: "floor", x: at.x, y: -at.y, body: robotNow() });
});

const isWriting = () => Boolean(document.activeElement?.matches("#orders input[type=text]"));

function writeName({ name }) {
  if (!isWriting()) return;
  const field = document.activeElement;
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

/** What each robot is about, by its body: in which turn, and in words. */
const doing = new Map();

function showDoing() {
  byId("doing").textContent = [...doing.values()].map(({ words }) => words).join(", ") || "Nothing";
}

function takeState(state) {
  window.cohabit.state = state;
  const { robot, others, notes, goals } = state;
  // Of several, those of the one that is decided about.
  const meant = others.find(({ body }) => body === robotNow()) ?? robot;
  byId("room").textContent = capitalised(meant?.room_name ?? "–");
  byId("holding").textContent = capitalised(meant?.holding ?? "nothing");
  const met = goals.filter((goal) => goal.met).length;
  const open = goals.filter((goal) => !goal.met && !goal.hidden).map((goal) => goal.text);
  setText("goals", goals.length ? [`${met} of ${goals.length}`, ...open].join(" · ") : "None");
  document.body.classList.toggle("busy", Boolean(robot?.busy));
  floor.follow(robot);
  floor.showOthers(others);
  floor.showNotes(notes);
  hearState(state);
}

keepWatch();
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
  progress: ({ body, turn, text }) => {
    doing.set(body, { turn, words: `${nameOf(body)}${capitalised(text)}` });
    showDoing();
  },
  turn: ({ body, turn, ended }) => {
    if (ended && turn === doing.get(body)?.turn) doing.delete(body);
    showDoing();
  },
  seen: (seen) => {
    takeSeen(seen);
    writeName(seen);
  },
  menu: takeMenu,
  expression: takeExpression,
  marks: takeMarks,
  sound: takeSound,
  highlight: (message) => floor.pointOut(message),
  error: (message) => {
    toast(message.text);
    giveBack(sent.flat());
    [sent, deciding] = [[], null];
  },
  binary: (buffer) => {
    if (!isSpeech(buffer)) takeFrame(buffer);
  },
  lost: () => {
    giveBack(sent.flat());
    sent = [];
    doing.clear();
    showDoing();
    proposals.clear();
    showProposal();
  },
});
