// Questionnaires as forms, one question after the other.

import { element } from "./dom.js";
import { text as words } from "./texts.js";

/** Scales with more places than these are sliders. */
const MOST_BUTTONS = 11;

/** So long nobody changes anything before what was filled in is kept, and before that is tried again, ms. */
const KEEP_AFTER_MS = 600;
const KEEP_AGAIN_MS = 4000;

/** Keeps at once what was filled in. */
let keepNow = () => {};
addEventListener("pagehide", () => keepNow(true));

/**
 * The form of a questionnaire, filled in as it was left. `send` is given the answers, and gives what is wrong with them; `keep`
 * is given what was filled in so far, and gives whether that is kept.
 */
export function questionnaireForm({ items }, draft, send, keep) {
  const form = element("form", "questions");
  form.noValidate = true;
  form.autocomplete = "off";
  const fields = items.map(fieldOf);
  fields.forEach(({ write }, index) => draft[index] && write(draft[index]));
  const list = element("ol", "items", ...fields.map(({ row }) => row));
  const problem = element("p", "problem");
  problem.role = "alert";
  const submit = element("button", "chief", words("send_answers"));
  submit.type = "submit";
  const hint = element("p", "soft", words("answers_kept"));
  form.append(list, hint, problem, element("div", "actions", submit));
  keepUpWith(form, () => fields.map(({ read }) => read()), keep);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const answers = fields.map(({ read }) => read());
    const missing = fields.findIndex(({ optional }, index) => !optional && answers[index] === null);
    fields.forEach(({ group }, index) => group.toggleAttribute("data-missing", index === missing));
    if (missing >= 0) {
      problem.textContent = words("question_unanswered", { number: missing + 1 });
      fields[missing].group.querySelector("input, textarea").focus();
      return;
    }
    submit.disabled = true;
    problem.textContent = await send(answers);
    submit.disabled = false;
  });
  return form;
}

/** One question below what it is `about`, asked while something else goes on. `send` is given the answer, and gives what is wrong with it. */
export function probeForm(item, about, send) {
  const form = element("form", "probe");
  form.noValidate = true;
  form.autocomplete = "off";
  const { group, read, optional } = fieldOf(item, 0);
  const problem = element("p", "problem");
  problem.role = "alert";
  const submit = element("button", "chief", words("probe_send"));
  submit.type = "submit";
  form.append(element("p", "soft", about), group, problem, element("div", "actions", submit));
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const answer = read();
    if (answer === null && !optional) {
      problem.textContent = words("probe_unanswered");
      return;
    }
    submit.disabled = true;
    problem.textContent = await send(answer);
    submit.disabled = false;
  });
  return form;
}

/** Has what is filled in kept by and by, one time after the other. */
function keepUpWith(form, read, keep) {
  let kept = JSON.stringify(read());
  let timer = 0;
  let isKeeping = false;
  const soon = (ms) => {
    clearTimeout(timer);
    timer = setTimeout(() => keepNow(false), ms);
  };
  keepNow = async (isLast) => {
    const answers = read();
    const now = JSON.stringify(answers);
    if (!form.isConnected || now === kept || (isKeeping && !isLast)) return;
    isKeeping = true;
    const isKept = await keep(answers, isLast);
    isKeeping = false;
    if (isKept) kept = now;
    if (JSON.stringify(read()) !== kept) soon(isKept ? KEEP_AFTER_MS : KEEP_AGAIN_MS);
  };
  form.addEventListener("input", () => soon(KEEP_AFTER_MS));
  form.addEventListener("change", () => soon(0));
}

function fieldOf(item, index) {
  const group = element("fieldset", "item");
  const legend = element("legend", "", item.ask);
  if (item.optional) legend.append(element("span", "soft", words("optional")));
  const { controls, read, write } = item.scale ? scaleOf(item.scale, index) : item.choice ? choiceOf(item.choice, index) : wordsOf(item.ask);
  group.append(legend, ...controls);
  return { row: element("li", "", group), group, optional: item.optional, read, write };
}

function scaleOf(scale, index) {
  const places = (scale.most - scale.least) / scale.step + 1;
  return places > MOST_BUTTONS ? sliderOf(scale) : buttonsOf(scale, places, index);
}

function endsOf({ left, right, least, most }) {
  return element("div", "ends", element("span", "", left || String(least)), element("span", "", right || String(most)));
}

function buttonsOf(scale, places, index) {
  const values = Array.from({ length: places }, (_, at) => scale.least + at * scale.step);
  const name = (value, at) => {
    const end = at === 0 ? scale.left : at === places - 1 ? scale.right : "";
    return end ? `${value}, ${end}` : String(value);
  };
  const row = element("div", "places", ...values.map((value, at) => radio(index, value, String(value), name(value, at))));
  return { controls: [row, endsOf(scale)], read: () => chosen(row), write: (given) => choose(row, given) };
}

function choiceOf(choices, index) {
  const column = element("div", "choices", ...choices.map((text, at) => radio(index, at + 1, text)));
  return { controls: [column], read: () => chosen(column), write: (given) => choose(column, given) };
}

function radio(index, value, text, name) {
  const input = element("input");
  Object.assign(input, { type: "radio", name: `item-${index}`, value });
  if (name) input.setAttribute("aria-label", name);
  return element("label", "radio", input, element("span", "", text));
}

function chosen(group) {
  const input = group.querySelector("input:checked");
  return input ? { value: Number(input.value) } : null;
}

function choose(group, { value }) {
  const input = [...group.querySelectorAll("input")].find((one) => one.value === String(value));
  if (input) input.checked = true;
}

/** A slider that has no value before it is touched. */
function sliderOf(scale) {
  const input = element("input", "untouched");
  const middle = scale.least + scale.step * Math.round((scale.most - scale.least) / scale.step / 2);
  Object.assign(input, { type: "range", min: scale.least, max: scale.most, step: scale.step, value: middle });
  const about = (text) => input.setAttribute("aria-valuetext", text);
  input.setAttribute("aria-label", words("scale_ends", { left: scale.left || scale.least, right: scale.right || scale.most }));
  about(words("not_answered"));
  const touch = () => {
    input.classList.remove("untouched");
    about(input.value);
  };
  for (const kind of ["input", "pointerup"]) input.addEventListener(kind, touch);
  // Who means the middle presses Space or Enter on it.
  input.addEventListener("keydown", (event) => {
    if (event.key === " " || event.key === "Enter") {
      event.preventDefault();
      touch();
    }
  });
  const read = () => (input.classList.contains("untouched") ? null : { value: Number(input.value) });
  const write = ({ value }) => {
    input.value = value;
    touch();
  };
  return { controls: [input, endsOf(scale)], read, write };
}

function wordsOf(ask) {
  const area = element("textarea", "words");
  area.rows = 3;
  area.setAttribute("aria-label", ask);
  const write = ({ text }) => {
    area.value = text ?? "";
  };
  return { controls: [area], read: () => (area.value.trim() ? { text: area.value.trim() } : null), write };
}
