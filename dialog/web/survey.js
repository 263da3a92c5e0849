// Questionnaires: asked before people play or after, one after the other, and answered when the session says so.

import { byId, element, toast, tooLong } from "./dom.js";
import { send } from "./socket.js";
import { text } from "./texts.js";

/** Scales with more places than these are sliders. */
const MOST_BUTTONS = 11;
/** So long the end of a mission is seen before questions cover it, ms. */
const ENDING_SEEN_MS = 3500;

const card = byId("survey");
let questionnaires = [];
let answered = new Set();
/** Those that were put off. */
const later = new Set();
/** The one that is shown, and how to read its answers. */
let shown = null;
let fields = [];
/** The fields of each that was shown and not answered yet, by its name: what was filled in before it was put off stands there again. */
const begun = new Map();
let endedAt = null;
/** Whether there is a mission that is not over. */
let isRunning = false;
/** Whether the person says that they have finished, though it is not over. */
let finished = false;

export function noteAnswered(names = []) {
  answered = new Set(names);
}

export function buildSurvey(all = []) {
  questionnaires = all;
  if (shown && (answered.has(shown.name) || !questionnaires.some(({ name }) => name === shown.name))) close();
  showButton();
}

/** Whether a questionnaire is to be answered now, the mission being over or not. */
export function askWhenDue({ ending, goals }) {
  isRunning = ending === "running" && goals.length > 0;
  if (ending === "running") endedAt = null;
  else endedAt ??= performance.now();
  const isOver = endedAt !== null && performance.now() - endedAt > ENDING_SEEN_MS;
  const due = asked(isOver).find(({ name }) => !later.has(name));
  showButton();
  if (due && !shown) show(due);
}

function asked(isOver) {
  return questionnaires.filter(({ name, when }) => !answered.has(name) && (when === "before" || isOver || finished));
}

function unanswered() {
  return questionnaires.filter(({ name }) => !answered.has(name));
}

/** What is asked after the mission is asked of whoever says that they have finished. */
function asksEarly(questionnaire) {
  return questionnaire?.when === "after" && isRunning && !finished;
}

function showButton() {
  const [first] = unanswered();
  byId("survey-open").hidden = !first;
  const words = asksEarly(first) ? text("have_finished") : text("questionnaire");
  if (byId("survey-open").textContent !== words) byId("survey-open").textContent = words;
}

function show(questionnaire) {
  shown = questionnaire;
  byId("survey-title").textContent = questionnaire.title;
  byId("survey-about").textContent = questionnaire.about;
  fields = begun.get(questionnaire.name) ?? questionnaire.items.map(fieldOf);
  begun.set(questionnaire.name, fields);
  byId("survey-items").replaceChildren(...fields.map(({ row }) => row));
  showProblem("");
  card.showModal();
  card.querySelector("form").scrollTop = 0;
}

function close() {
  shown = null;
  card.close();
}

function fieldOf(item, index) {
  const row = element("li", "survey-item");
  const label = element("p", "survey-ask", item.ask);
  label.id = `survey-ask-${index}`;
  if (item.optional) label.append(element("span", "survey-optional", text("optional")));
  const { control, named = control, read } = item.scale ? scaleOf(item.scale, index) : item.choice ? choiceOf(item.choice, index) : wordsOf();
  named.setAttribute("aria-labelledby", label.id);
  row.append(label, control);
  return { row, optional: item.optional, read };
}

function scaleOf(scale, index) {
  const places = (scale.most - scale.least) / scale.step + 1;
  return places > MOST_BUTTONS ? sliderOf(scale, index) : buttonsOf(scale, places, index);
}

function ends({ left, right, least, most }) {
  return [element("span", "survey-end", left || String(least)), element("span", "survey-end", right || String(most))];
}

function buttonsOf(scale, places, index) {
  const control = element("div", "survey-scale");
  control.role = "radiogroup";
  const [left, right] = ends(scale);
  const row = element("div", "survey-places");
  const name = (value, at) => {
    const end = at === 0 ? scale.left : at === places - 1 ? scale.right : "";
    return end ? `${value}, ${end}` : String(value);
  };
  row.append(...Array.from({ length: places }, (_, at) => {
    const value = scale.least + at * scale.step;
    return radio(index, value, String(value), name(value, at));
  }));
  control.append(left, row, right);
  return { control, read: () => chosen(control) };
}

function choiceOf(choices, index) {
  const control = element("div", "survey-choice");
  control.role = "radiogroup";
  control.append(...choices.map((choice, at) => radio(index, at + 1, choice)));
  return { control, read: () => chosen(control) };
}

function radio(index, value, shownAs, name) {
  const label = element("label", "survey-radio");
  const input = element("input");
  Object.assign(input, { type: "radio", name: `survey-${index}`, value });
  if (name) input.setAttribute("aria-label", name);
  label.append(input, element("span", "", shownAs));
  return label;
}

function chosen(control) {
  const input = control.querySelector("input:checked");
  return input ? { value: Number(input.value) } : null;
}

/** A slider that has no value before it is touched. */
function sliderOf(scale, index) {
  const control = element("div", "survey-scale slider untouched");
  const input = element("input");
  Object.assign(input, { type: "range", min: scale.least, max: scale.most, step: scale.step });
  input.setAttribute("aria-valuetext", text("not_answered"));
  const touch = () => {
    control.classList.remove("untouched");
    input.setAttribute("aria-valuetext", input.value);
  };
  for (const kind of ["input", "pointerup"]) input.addEventListener(kind, touch);
  // Who means the place where it stands presses Space or Enter on it.
  input.addEventListener("keydown", (event) => {
    if (event.key !== " " && event.key !== "Enter") return;
    event.preventDefault();
    touch();
  });
  const [left, right] = ends(scale);
  for (const [end, words] of [["left", left], ["right", right]]) words.id = `survey-${end}-${index}`;
  input.setAttribute("aria-describedby", `${left.id} ${right.id}`);
  control.append(left, input, right);
  return { control, named: input, read: () => (control.classList.contains("untouched") ? null : { value: Number(input.value) }) };
}

function wordsOf() {
  const control = element("textarea", "survey-words");
  control.rows = 3;
  return { control, read: () => (control.value.trim() ? { text: control.value.trim() } : null) };
}

function showProblem(problem) {
  byId("survey-problem").textContent = problem;
}

byId("survey-form").addEventListener("submit", (event) => {
  event.preventDefault();
  const answers = fields.map(({ read }) => read());
  const problems = fields.map(({ optional }, index) => (!optional && answers[index] === null ? text("no_answer") : tooLong(answers[index]?.text ?? "")));
  const wrong = problems.findIndex((problem) => problem);
  fields.forEach(({ row }, index) => row.classList.toggle("missing", index === wrong));
  if (wrong >= 0) {
    showProblem(text("question_problem", { number: wrong + 1, problem: problems[wrong] }));
    fields[wrong].row.scrollIntoView({ block: "center" });
    fields[wrong].row.querySelector("input, textarea").focus({ preventScroll: true });
  } else if (send({ type: "answer", questionnaire: shown.name, answers, finished })) {
    showProblem("");
  } else {
    showProblem(text("no_connection"));
  }
});

export function takeAnswered({ questionnaire, problem }) {
  if (problem) {
    showProblem(problem);
    return;
  }
  answered.add(questionnaire);
  begun.delete(questionnaire);
  if (shown?.name === questionnaire) close();
  showButton();
  // The button that had the focus may be gone.
  if (document.activeElement === document.body) byId("chat-input").focus();
  toast(text("thank_you"));
}

function putOff() {
  // That a card was closed is told a moment later: the next questionnaire may be shown by then.
  if (card.open) return;
  if (shown) later.add(shown.name);
  shown = null;
}

byId("survey-later").addEventListener("click", () => card.close());
card.addEventListener("close", putOff);
byId("survey-open").addEventListener("click", () => {
  const [first] = unanswered();
  if (!first) return;
  if (asksEarly(first)) {
    if (!window.confirm(text("finished_early"))) return;
    finished = true;
  }
  show(first);
});
