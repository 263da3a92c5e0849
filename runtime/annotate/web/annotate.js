// An annotator's page: shows the task that the server says, plays its pictures, and sends what somebody writes.

import { byId, button, element } from "./dom.js";

/** While there is nothing to do, and after a lost connection, the server is asked again this often. */
const ASK_EVERY_MS = 5000;
/** While somebody works, the server is given a sign of them this often, so that the task stays theirs. */
const SIGN_EVERY_MS = 60_000;
const GIVE_UP_MS = 8000;
/** Pictures a second at the speed 1. A step is a picture. */
const PICTURES_PER_S = 1.5;

const KINDS = {
  instruction: {
    title: "What would you tell the robot?",
    what: "Watch what the robot does. Then write what somebody would say to it so that it does just this.",
    ask: "Your instruction",
  },
  question: {
    title: "What would you ask?",
    what: "The robot was told what stands below the pictures, and has come as far as they show. In its place, what would you ask to do it well?",
    ask: "Your question",
  },
  answer: {
    title: "What is the answer?",
    what: "Somebody asked a question about what you see. Watch what the robot does, and answer it.",
    ask: "Your answer",
  },
};

const here = location.pathname.replace(/\/$/, "");
/** The task that is shown, and the newest state of the server. */
let task = null;
let state = null;
let isShown = false;
let signed = 0;
let isWorkedOn = false;
let corrected = null;

async function ask(path, body) {
  const request = { signal: AbortSignal.timeout(GIVE_UP_MS) };
  if (body !== undefined) {
    Object.assign(request, { method: "POST", body: JSON.stringify(body), headers: { "content-type": "application/json" } });
  }
  const answer = await fetch(`${here}/${path}`, request);
  if (!answer.ok) throw new Error(`status ${answer.status}`);
  return answer.json();
}

/** Tells the server something; gives what is wrong with it, in words, or nothing. */
async function tell(body) {
  try {
    const answer = await ask("send", body);
    byId("offline").hidden = true;
    if (!answer.problem) show(answer);
    else state = answer;
    return answer.problem ?? "";
  } catch {
    byId("offline").hidden = false;
    return "Nothing was saved: there is no connection at the moment. Your text is still here; please try again in a while.";
  }
}

async function refresh() {
  const isDue = !task || (isWorkedOn && Date.now() - signed > SIGN_EVERY_MS);
  if (isDue) {
    try {
      const answer = await ask("task");
      byId("offline").hidden = true;
      signed = Date.now();
      isWorkedOn = false;
      if (isSame(answer.task)) {
        task = answer.task;
      } else if (task) {
        state = answer;
        gone("This task has gone to somebody else meanwhile. Your text is still here, but it cannot be sent any more.");
      } else {
        show(answer);
      }
    } catch {
      byId("offline").hidden = false;
    }
  }
  setTimeout(refresh, ASK_EVERY_MS);
}

/** Whether a task is the one that is shown, also of a server that was started anew and counts anew. */
function isSame(other) {
  return Boolean(task && other) && JSON.stringify({ ...task, claim: 0 }) === JSON.stringify({ ...other, claim: 0 });
}

/** The task is somebody else's; what was written stays until somebody goes on. */
function gone(problem) {
  byId("problem").textContent = problem;
  byId("next").hidden = false;
}

function show(answer) {
  state = answer;
  byId("bar-name").textContent = answer.annotator;
  byId("bar-done").textContent = `${answer.done} done`;
  showOwn(answer.own);
  if (isShown && answer.task?.claim === task?.claim) return;
  isShown = true;
  task = answer.task;
  signed = Date.now();
  pause();
  byId("work").hidden = !task;
  if (task) showTask();
  else showNothing();
  byId("title").focus({ preventScroll: true });
  scrollTo(0, 0);
}

function showNothing() {
  byId("title").textContent = "Nothing to do at the moment";
  byId("what").textContent = "Thank you. Either all is done, or others have not come so far yet: the page goes on by itself when there is more.";
}

function showTask() {
  const { title, what, ask: label } = KINDS[task.kind];
  byId("title").textContent = title;
  byId("what").textContent = what;
  byId("ask").textContent = label;
  byId("problem").textContent = "";
  byId("next").hidden = true;
  const lines = [["The robot was told", task.instruction], ["The question", task.question]].filter(([, text]) => text);
  byId("read").replaceChildren(...lines.flatMap(([name, text]) => [element("dt", "", name), element("dd", "", text)]));
  byId("text").value = kept();
  count();
  const scrub = byId("scrub");
  scrub.max = task.last_step - task.first_step;
  scrub.value = 0;
  load();
  look();
}

// What is typed outlasts a reload of the page.

const draft = () => `draft ${here} ${JSON.stringify({ ...task, claim: 0 })}`;

function kept() {
  try {
    return sessionStorage.getItem(draft()) ?? "";
  } catch {
    return "";
  }
}

function keep(text) {
  try {
    if (text) sessionStorage.setItem(draft(), text);
    else sessionStorage.removeItem(draft());
  } catch {
    // A browser may keep nothing; then a reload begins anew.
  }
}

function count() {
  const left = state.longest_text - [...byId("text").value.trim()].length;
  byId("left").textContent = left < 0 ? `${-left} characters too many` : `${left} characters left`;
}

// The pictures: all are fetched at once, so that they play without a halt.

const address = (step) => `${here}/picture/${task.episode}/${step}`;
let loaded = [];
let timer = null;

function load() {
  loaded = [];
  for (let step = task.first_step; step <= task.last_step; step += 1) {
    const image = new Image();
    image.src = address(step);
    loaded.push(image);
  }
}

function look() {
  const at = Number(byId("scrub").value);
  const picture = byId("picture");
  picture.src = loaded[at].src;
  const text = `Picture ${at + 1} of ${loaded.length}`;
  picture.alt = `What the robot sees: ${text.toLowerCase()}`;
  byId("place").textContent = text;
  byId("scrub").setAttribute("aria-valuetext", text);
}

byId("picture").addEventListener("load", ({ target }) => {
  byId("film").style.setProperty("--shape", `${target.naturalWidth} / ${target.naturalHeight}`);
});

function go(by) {
  const scrub = byId("scrub");
  const before = scrub.value;
  scrub.value = Number(before) + by;
  look();
  return scrub.value !== before;
}

function pause() {
  clearTimeout(timer);
  timer = null;
  byId("play").textContent = "Play";
}

function play() {
  const scrub = byId("scrub");
  if (Number(scrub.value) === Number(scrub.max)) scrub.value = 0;
  look();
  byId("play").textContent = "Pause";
  tick();
}

function tick() {
  timer = setTimeout(() => {
    if (go(1)) tick();
    else pause();
  }, 1000 / (PICTURES_PER_S * Number(byId("speed").value)));
}

function toggle() {
  isWorkedOn = true;
  if (timer === null) play();
  else pause();
}

byId("play").addEventListener("click", toggle);
byId("scrub").addEventListener("input", () => {
  pause();
  look();
});
byId("film").addEventListener("keydown", (event) => {
  const keys = { " ": toggle, ArrowRight: () => (pause(), go(1)), ArrowLeft: () => (pause(), go(-1)), Home: () => (pause(), go(-1e6)), End: () => (pause(), go(1e6)) };
  const act = keys[event.key];
  if (!act || event.ctrlKey || event.altKey || event.metaKey) return;
  event.preventDefault();
  act();
});

// What somebody writes.

/** Sends something once; buttons wait for the answer. */
async function sendOnce(what) {
  const buttons = [byId("send"), byId("skip")];
  buttons.forEach((one) => { one.disabled = true; });
  const key = draft();
  let { claim } = task;
  let problem = await tell({ annotation: { claim, what } });
  if (problem && state.task?.claim !== claim && isSame(state.task)) {
    // The server was started anew, and has given the same task again.
    task = state.task;
    claim = task.claim;
    problem = await tell({ annotation: { claim, what } });
  }
  buttons.forEach((one) => { one.disabled = false; });
  if (!problem) {
    try {
      sessionStorage.removeItem(key);
    } catch {
      // Nothing was kept.
    }
    return;
  }
  byId("problem").textContent = problem;
  if (state.task?.claim !== claim) byId("next").hidden = false;
}

byId("form").addEventListener("submit", (event) => {
  event.preventDefault();
  sendOnce({ text: byId("text").value });
});
byId("text").addEventListener("input", ({ target }) => {
  isWorkedOn = true;
  keep(target.value);
  count();
});
byId("text").addEventListener("keydown", (event) => {
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) byId("form").requestSubmit();
});
byId("next").addEventListener("click", () => show(state));

byId("skip").addEventListener("click", () => {
  const choices = state.reasons.map(({ reason, text }) => {
    const made = button("quiet", text, () => {
      byId("skip-card").close();
      sendOnce({ skipped: reason });
    });
    made.dataset.reason = reason;
    return made;
  });
  const back = button("quiet", "Back to the task", () => byId("skip-card").close());
  byId("reasons").replaceChildren(...choices, back);
  byId("skip-card").showModal();
});

// What they wrote before.

function showOwn(own) {
  byId("own").hidden = own.length === 0;
  const lines = own.map(({ id, kind, text }) => {
    const correct = button("quiet", "Correct", () => {
      corrected = id;
      byId("own-text").value = text;
      byId("own-problem").textContent = "";
      byId("own-card").showModal();
    });
    correct.setAttribute("aria-label", `Correct: ${text}`);
    return element("li", "", element("span", "soft", kind), element("span", "", text), correct);
  });
  byId("own-list").replaceChildren(...lines);
}

byId("own-cancel").addEventListener("click", () => byId("own-card").close());
byId("own-form").addEventListener("submit", async (event) => {
  event.preventDefault();
  const problem = await tell({ correction: { id: corrected, text: byId("own-text").value } });
  byId("own-problem").textContent = problem;
  if (!problem) byId("own-card").close();
});

refresh();
