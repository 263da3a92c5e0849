// The conversation: what was said, what the robot is about, and what a person types.

import { byId, capitalised, element, narrow, toast, tooLong } from "./dom.js";
import { floor } from "./floor.js";
import { sendOrSay } from "./page.js";
import { send } from "./socket.js";
import { language, text as words } from "./texts.js";
import { sendHeard } from "./voice.js";

/** So near its end, the log follows what is said, px. */
const NEAR_END_PX = 60;
const NEW_GOAL = /^New goal:\s*/;

const log = byId("chat");
export const input = byId("chat-input");
let lastSpeaker = "";
let unseenLines = false;
/** The number of this page among all. */
let visitor = 0;
/** What the robots are called, by their bodies; empty where there is but one. */
let robotNames = new Map();

/** The body that this conversation is with, of several robots: the one of which something was said last. */
let talkedWith = null;

/** The robot that is spoken with, by its body and name; nothing where there is but one. */
export const robotNow = () => (robotNames.has(talkedWith) ? { body: talkedWith, name: robotNames.get(talkedWith) } : null);

export function takeYou(you) {
  ({ visitor } = you);
}

/** Who can be spoken to. */
export function meet(robots) {
  robotNames = new Map(robots.length > 1 ? robots.map(({ body, name }) => [body, capitalised(name)]) : []);
  const named = [...robotNames.values()];
  if (!robotNames.has(talkedWith)) talkedWith = robotNames.keys().next().value ?? null;
  byId("called").textContent = named.length ? words("call_by_name", { names: named.join(", ") }) : "";
}

/** The room from which a walk was offered. */
let offeredFrom;

/** Offers a walk to the largest room that the robot is not in. */
export function offerRoom(rooms, here) {
  if (here === offeredFrom) return;
  offeredFrom = here;
  const area = ({ rects }) => rects.reduce((sum, [w, s, e, n]) => sum + (e - w) * (n - s), 0);
  const others = rooms.filter(({ id }) => id !== here).sort((a, b) => area(b) - area(a));
  const chip = byId("chip-room");
  chip.hidden = !others.length;
  chip.textContent = others.length ? `go to the ${others[0].name}` : "";
}

/** Who says a line: a name where it is neither this person nor the one robot. */
function speakerOf({ from, body, name, visitor: by }) {
  if (from === "person") return by === undefined || by === visitor ? "" : words("person_number", { number: by });
  if (from !== "robot") return "";
  const robot = robotNames.get(body);
  if (name) return robot ? `${capitalised(name)} (${robot})` : capitalised(name);
  return body === undefined ? "" : robot ?? words("body_number", { number: body });
}

/** Whether lines that are told again are ones that this page did not know, as when it is loaded. */
let isNew = true;

export function clearChat() {
  isNew = said.length === 0;
  log.setAttribute("aria-busy", "true");
  log.replaceChildren();
  byId("trail").replaceChildren();
  lastSpeaker = "";
  offeredFrom = undefined;
  byId("chips").hidden = false;
}

export function takeLine(line) {
  const atEnd = log.scrollHeight - log.scrollTop - log.clientHeight < NEAR_END_PX;
  const replayed = log.hasAttribute("aria-busy");
  if (line.from !== "game") closeQuestions(line);
  if (robotNames.has(line.body)) talkedWith = line.body;
  const bubble = lineOf(line);
  const speaker = line.from + speakerOf(line);
  if (speaker === lastSpeaker) bubble.classList.add("follows");
  if (!replayed) bubble.classList.add("fresh");
  lastSpeaker = speaker;
  log.append(bubble);
  if (line.from !== "game") input.placeholder = log.querySelector(OPEN_QUESTION) ? words("answer_robot") : words("tell_robot");
  if (isMine(line)) {
    if (isNew || !replayed) remember(line.text);
    byId("chips").hidden = true;
  }
  if (atEnd || replayed || isMine(line)) toNewest();
  else {
    unseenLines = true;
    showToNewest();
  }
}

function isMine(line) {
  return line.from === "person" && !speakerOf(line);
}

/** The answers that the question of a body offers, numbered if they are objects; clicking on one gives it. */
function answersOf(answers, body) {
  const list = element("div", "answers");
  list.lang = "en";
  list.append(...answers.map(({ text, object }, index) => {
    const button = element("button", "");
    button.type = "button";
    if (object !== undefined) button.append(element("b", "answer-number", String(index + 1)), " ");
    button.append(text);
    button.addEventListener("click", () => {
      // Another robot may have asked something since.
      if (object === undefined) say(robotNames.has(body) ? `${robotNames.get(body)}, ${text}` : text);
      else choose(object);
      if (!narrow.matches) input.focus();
    });
    return button;
  }));
  return list;
}

function choose(object) {
  sendOrSay({ type: "choose", object });
}

const OPEN_QUESTION = ".kind-question:not(.closed)";

/**
 * An answer is given once: what a robot asked before this line of the conversation with it is past. Its question waits on where another
 * robot speaks, and where it tells what came of something that it was told before.
 */
function closeQuestions({ body, turn }) {
  const isPast = ({ dataset }) => dataset.turn === "0" || (dataset.body === String(body ?? "") && Number(dataset.turn) <= turn);
  const past = [...log.querySelectorAll(OPEN_QUESTION)].filter(isPast);
  for (const question of past) {
    question.classList.add("closed");
    for (const button of question.querySelectorAll(".answers button")) button.disabled = true;
  }
  if (past.length) floor.forgetMarks();
}

function lineOf(line) {
  const { from, kind, body, turn, answers = [] } = line;
  let { text } = line;
  const bubble = element("div", `line from-${from} kind-${kind}`);
  if (kind === "question") Object.assign(bubble.dataset, { body: body ?? "", turn });
  const name = speakerOf(line);
  const unnamed = { person: words("you_said"), robot: words("robot_said"), game: "" }[from] ?? "";
  if (name) bubble.append(element("b", "line-speaker", name), element("span", "unseen", ": "));
  else if (unnamed) bubble.append(element("span", "unseen", unnamed));
  bubble.classList.toggle("from-other", from === "person" && name !== "");
  if (from === "game" && kind === "goal") {
    const added = NEW_GOAL.test(text);
    bubble.classList.toggle("new-goal", added);
    bubble.append(element("b", "line-label", added ? words("new_goal") : words("goal_reached")));
    text = text.replace(NEW_GOAL, "");
  } else if (from === "game" && kind === "note") {
    bubble.append(element("b", "line-label", words("sticky_note")));
  } else if (from === "game" && kind === "ending") {
    bubble.classList.toggle("failed", /fail/i.test(text));
  }
  const said = element("span", "line-text", text);
  said.lang = "en";
  bubble.append(said);
  if (answers.length) bubble.append(answersOf(answers, body));
  return bubble;
}

function toNewest() {
  log.scrollTop = log.scrollHeight;
  unseenLines = false;
  showToNewest();
}

function showToNewest() {
  byId("to-newest").hidden = !unseenLines;
}

log.addEventListener("scroll", () => {
  if (log.scrollHeight - log.scrollTop - log.clientHeight < NEAR_END_PX) {
    unseenLines = false;
    showToNewest();
  }
}, { passive: true });
byId("to-newest").addEventListener("click", toNewest);
// The log loses height when the keyboard of a phone opens or the chips appear: its end stays in sight.
new ResizeObserver(() => {
  if (!unseenLines) log.scrollTop = log.scrollHeight;
}).observe(log);

/** More steps than these are not drawn one by one. */
const MOST_STEPS = 24;

/** What each robot is about, by its body, the latest last. */
const doing = new Map();

export function takeProgress(progress) {
  endStep(progress.body, "done");
  doing.delete(progress.body);
  doing.set(progress.body, progress);
  showDoing(progress);
}

/** Older steps are forgotten. */
const MOST_PAST_STEPS = 20;

/** Adds what a robot was about to the trail of what was done. */
function endStep(body, status) {
  const progress = doing.get(body);
  if (!progress) return;
  const name = robotNames.get(body);
  const step = element("li", status === "done" ? "done" : "undone", name ? `${name}: ${progress.text}` : capitalised(progress.text));
  step.lang = "en";
  const trail = byId("trail");
  trail.prepend(step);
  while (trail.childElementCount > MOST_PAST_STEPS) trail.lastElementChild.remove();
}

function showDoing({ body, step, steps, text }) {
  const several = steps > 1;
  byId("doing").classList.remove("idle");
  const name = robotNames.get(body);
  showDoingText(name ? `${name}: ${text}` : capitalised(text), "en");
  byId("doing-count").textContent = several ? words("step_of", { step, steps }) : "";
  const marks = Array.from({ length: several && steps <= MOST_STEPS ? steps : 0 }, (_, index) =>
    element("i", index + 1 < step ? "past" : index + 1 === step ? "now" : ""));
  byId("doing-steps").replaceChildren(...marks);
}

/** What robots are about is told by the session, in English; the rest is of the page's language. */
function showDoingText(shown, lang) {
  byId("doing-text").textContent = shown;
  byId("doing-text").lang = lang;
}

export function takeTurn({ body, turn, ended, status }) {
  // What was only answered meanwhile, or dismissed, ends nothing of what the robot is about: the turn of that ends by itself.
  if (!ended || turn !== doing.get(body)?.turn) return;
  endStep(body, status);
  doing.delete(body);
  const other = [...doing.values()].at(-1);
  if (other) showDoing(other);
  else endDoing();
}

export function endDoing() {
  doing.clear();
  byId("doing").classList.add("idle");
  const idle = { running: words("ready"), complete: words("all_done"), failed: words("mission_over") };
  const isLost = document.body.classList.contains("lost");
  showDoingText(isLost ? words("waiting_for_session") : idle[window.cohabit.state?.ending ?? "running"], language);
  byId("doing-count").textContent = "";
  byId("doing-steps").replaceChildren();
}

export function takeLatency(latency) {
  window.cohabit.latency = latency;
  const { heard_ms: heard, understood_ms: understood, sounded_ms: sounded, moved_ms: moved, shown_ms: seen } = latency;
  const has = (ms) => typeof ms === "number";
  const parts = [
    has(heard) && words("latency_heard", { time: inMilliseconds(heard) }),
    has(understood) && words("latency_understood", { time: inMilliseconds(understood) }),
    has(sounded) && words("latency_answering", { time: inMilliseconds(sounded) }),
    has(moved) && words("latency_moving", { time: inMilliseconds(moved) }),
    has(seen) && words("latency_seen", { time: inMilliseconds(seen) }),
  ];
  byId("latency").textContent = parts.filter(Boolean).join(" · ");
}

function inMilliseconds(ms) {
  return `${ms < 1 ? ms.toFixed(1) : Math.round(ms)} ms`;
}

const said = [];
let recalled = 0;
let draft = "";

function remember(text) {
  if (said.at(-1) !== text) said.push(text);
  recalled = said.length;
}

export function say(text) {
  const problem = tooLong(text);
  if (problem) {
    toast(words("too_long_for_robot", { problem }));
    return false;
  }
  if (!sendOrSay({ type: "say", text })) return false;
  remember(text);
  return true;
}

function recall(step) {
  const next = recalled + step;
  if (next < 0 || next > said.length) return;
  if (recalled === said.length) draft = input.value;
  recalled = next;
  input.value = next === said.length ? draft : said[next];
  input.setSelectionRange(input.value.length, input.value.length);
}

byId("composer").addEventListener("submit", (event) => {
  event.preventDefault();
  clearTimeout(pause);
  const text = input.value.trim();
  if (tooLong(text)) say(text);
  else if (sendHeard(input.value)) draft = "";
  else if (text && say(text)) {
    input.value = "";
    draft = "";
  }
  input.focus();
});

const TYPING_PAUSE_MS = 150;
let pause = 0;

// What is typed is understood ahead where somebody pauses; it counts for nothing, and is kept nowhere, until it is sent.
input.addEventListener("input", () => {
  clearTimeout(pause);
  pause = setTimeout(() => {
    const text = input.value.trim();
    if (text.includes(" ") && !tooLong(text)) send({ type: "typing", text });
  }, TYPING_PAUSE_MS);
});

input.addEventListener("keydown", (event) => {
  if (event.isComposing || (event.key !== "ArrowUp" && event.key !== "ArrowDown")) return;
  event.preventDefault();
  recall(event.key === "ArrowUp" ? -1 : 1);
});

byId("chips").addEventListener("click", ({ target }) => {
  if (!(target instanceof HTMLButtonElement)) return;
  say(target.textContent);
  if (!narrow.matches) input.focus();
});
byId("stop").addEventListener("click", () => say("stop"));
