// A participant's page: shows what the study's server says that it is time for.

import { byId, button, clock, element, whileOf } from "./dom.js";
import { probeForm, questionnaireForm } from "./forms.js";
import { endFollowing, follow, tell, tellQuietly } from "./server.js";

/** Pages after which nothing follows. */
const LAST = ["finished", "withdrawn", "excluded", "unknown"];

/** What is shown, so that it is built once; and how it takes in what changes. */
let shown = "";
let update = () => {};
let step = null;

/**
 * What is left of a page when the server no longer knows its link. Links of participants are forgotten only when they
 * withdraw, be it while the server was away; those of people who have not agreed yet, whenever it is started.
 */
let kept = { takesPart: false };

const send = (event) => tell("event", { step, event });

function show(answer) {
  const state = answer.page === "unknown" ? { ...kept, page: kept.takesPart ? "withdrawn" : "unknown" } : answer;
  const takesPart = kept.takesPart || Boolean(state.step) || state.page === "finished";
  kept = { title: state.title, contact: state.contact, takesPart };
  const key = JSON.stringify([state.page, state.step, state.session]);
  step = state.step ?? null;
  if (key !== shown) {
    shown = key;
    build(state);
  }
  update(state);
  showBar(state);
  if (LAST.includes(state.page)) endFollowing();
}

function build(state) {
  update = () => {};
  document.body.dataset.page = state.page;
  document.title = state.title ?? "Study";
  const parts = (PAGES[state.page] ?? PAGES.unknown)(state);
  byId("content").replaceChildren(...parts);
  const heading = byId("content").querySelector("h1");
  if (heading) {
    heading.tabIndex = -1;
    heading.focus({ preventScroll: true });
  }
  scrollTo(0, 0);
}

function showBar(state) {
  byId("bar-title").textContent = state.title ?? "";
  byId("bar-step").textContent = state.step ? `Step ${state.step} of ${state.steps}` : "";
  const isTimed = state.page === "mission" && !state.is_over && state.left_s !== null;
  byId("bar-time").textContent = isTimed ? `${clock(state.left_s)} left` : "";
  const mayLeave = Boolean(state.step) || state.page === "finished";
  byId("leave").hidden = !mayLeave;
  byId("contact").textContent = state.contact ? `Questions about this study? Contact: ${state.contact}` : "";
  if (state.page !== "mission" || state.is_over) byId("skip-card").close();
}

const heading = (text) => element("h1", "", text);

/** A text that the server made from Markdown; all that was HTML in it is escaped. */
function sheet(html) {
  const made = element("div", "sheet");
  made.innerHTML = html ?? "";
  return made;
}

/** A button that tells the server something once. */
function going(text, event) {
  const problem = element("p", "problem");
  problem.role = "alert";
  const made = button("chief", text, async () => {
    made.disabled = true;
    problem.textContent = await send(event());
    made.disabled = false;
  });
  return element("div", "actions", made, problem);
}

/** What is to be tried in a tutorial, ticked as it is; and the button that goes on from there. */
function exerciseList(exercises) {
  const count = element("p", "soft", "");
  count.role = "status";
  const states = exercises.map(() => element("span", "unseen", ""));
  const items = exercises.map(({ text }, at) => element("li", "exercise", element("span", "", text), states[at]));
  const go = going("Go on", () => "goes_on");
  const goOn = go.querySelector("button");
  const shown = element("section", "exercises", element("h2", "", "Try this"), element("ol", "", ...items), count, go);
  shown.setAttribute("aria-label", "Things to try");
  let told = "";
  return {
    shown,
    update(now, mayGoOn, isOver) {
      shown.hidden = isOver;
      const key = JSON.stringify([now, mayGoOn]);
      if (key === told) return;
      told = key;
      now.forEach(({ is_tried: isTried }, at) => {
        items[at].classList.toggle("tried", isTried);
        states[at].textContent = isTried ? " (done)" : "";
      });
      const done = now.filter(({ is_tried: isTried }) => isTried).length;
      count.textContent = done === now.length ? "You have tried all of it. Go on when you like." : `${done} of ${now.length} done`;
      goOn.disabled = !mayGoOn;
    },
  };
}

const PAGES = {
  information: ({ html }) => [heading("About this study"), sheet(html), going("I have read this", () => "read")],

  consent({ html, boxes: asked, version }) {
    const form = element("form", "consent");
    const boxes = asked.map(({ text, is_required: isRequired }) => {
      const box = element("input");
      box.type = "checkbox";
      box.required = isRequired;
      const words = element("span", "", text, ...(isRequired ? [] : [element("span", "soft", " (optional)")]));
      form.append(element("label", "check", box, words));
      return box;
    });
    const agree = element("button", "chief", "I agree to take part");
    agree.type = "submit";
    const problem = element("p", "problem");
    problem.role = "alert";
    form.append(problem, element("div", "actions", button("quiet", "I do not agree", () => send("declined")), agree));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      agree.disabled = true;
      const ticked = boxes.flatMap((box, number) => (box.checked ? [number] : []));
      problem.textContent = await send({ consented: { version, ticked } });
      agree.disabled = false;
    });
    return [heading("Your consent"), sheet(html), form];
  },

  declined: () => [
    heading("You do not take part"),
    element("p", "", "Thank you. Nothing of yours was recorded. You can close this page."),
    element("div", "actions", button("quiet", "Back to the consent form", () => send("read"))),
  ],

  questionnaire({ questionnaire, draft }) {
    const about = element("p", "soft", questionnaire.about);
    const { name } = questionnaire;
    const answer = (answers) => send({ answered: { questionnaire: name, answers } });
    const keep = (answers, isLast) => tellQuietly("event", { step, event: { drafted: { questionnaire: name, answers } } }, isLast);
    return [heading(questionnaire.title), about, questionnaireForm(questionnaire, draft, answer, keep)];
  },

  ready({ html, is_tutorial: isTutorial, limit_s, skip_after_s }) {
    const lines = [];
    if (isTutorial) lines.push("There is a list of things to try. You go on when you have tried them all.");
    if (limit_s !== null) lines.push(`It lasts ${whileOf(limit_s)} at most.`);
    const may = isTutorial ? "go on without having tried all of it" : "skip it";
    if (skip_after_s !== null) lines.push(`After ${whileOf(skip_after_s)} you may ${may}, if you like.`);
    return [heading(isTutorial ? "Learn how it works" : "Your next mission"), sheet(html), element("p", "", lines.join(" ")), going("Begin", () => "goes_on")];
  },

  waiting() {
    const place = element("p", "", "");
    place.role = "status";
    update = ({ ahead }) => {
      const text = ahead ? `${ahead} ${ahead === 1 ? "person is" : "people are"} before you.` : "You are next.";
      if (place.textContent !== text) place.textContent = text;
    };
    return [heading("Please wait"), element("p", "", "All robots are busy at the moment. Your mission begins by itself."), place];
  },

  starting() {
    const text = element("p", "", "The robot is getting ready. This takes a few seconds.");
    text.role = "status";
    return [heading("One moment, please"), text];
  },

  mission({ session, exercises }) {
    const frame = element("iframe", "session");
    frame.title = "The robot, and what you tell it";
    frame.allow = session.has_microphone ? "microphone; autoplay" : "autoplay";
    frame.src = `${location.protocol}//${location.hostname}:${session.port}/?token=${session.token}`;
    const over = element("p", "over", "This mission is over. The study goes on in a moment.");
    over.role = "status";
    over.hidden = true;
    const skip = button("quiet", "Skip this mission", () => byId("skip-card").showModal());
    skip.id = "skip";
    const offer = element("div", "offer", element("p", "", "If you are stuck, you may go on without finishing this mission."), skip);
    const probes = element("div", "probes");
    probes.role = "status";
    let asked = null;
    const list = exercises.length > 0 ? exerciseList(exercises) : null;
    update = ({ is_over: isOver, skip_in_s: skipInS, probe, exercises: now, may_go_on: mayGoOn }) => {
      over.hidden = !isOver;
      offer.hidden = list !== null || isOver || skipInS !== 0;
      list?.update(now, mayGoOn, isOver);
      const number = isOver ? null : (probe?.number ?? null);
      if (number === asked) return;
      asked = number;
      const answer = (given) => send({ probe_answered: { probe: number, answer: given } });
      probes.replaceChildren(...(number === null ? [] : [probeForm(probe.item, answer)]));
    };
    const beside = list ? element("div", "beside", frame, list.shown) : frame;
    return [element("h1", "unseen", list ? "Tutorial" : "Mission"), over, offer, beside, probes];
  },

  break({ html }) {
    const left = element("p", "soft", "");
    update = ({ left_s }) => {
      left.textContent = left_s === null ? "" : `The study goes on by itself in ${clock(left_s)}.`;
    };
    return [heading("A break"), sheet(html), left, going("Go on now", () => "goes_on")];
  },

  finished({ html, completion }) {
    const parts = [heading("Thank you")];
    if (html) parts.push(sheet(html));
    else parts.push(element("p", "", "You have done all of it. You may close this page."));
    if (completion?.code) {
      const code = element("output", "code", completion.code);
      parts.push(element("p", "", "Your completion code: ", code));
    }
    if (completion?.return) {
      const link = element("a", "chief", "Go back to where you came from");
      link.href = completion.return;
      parts.push(element("p", "actions", link));
    }
    return parts;
  },

  withdrawn: () => [
    heading("You have left the study"),
    element("p", "", "Nothing of yours in this study is kept. You can close this page."),
  ],

  excluded: () => [
    heading("The study ends here for you"),
    element("p", "", "Thank you for taking part. You can close this page."),
  ],

  unknown: () => [
    heading("This link is not known any more"),
    element("p", "", "Please open the link that you were given once more."),
  ],
};

byId("skip-now").addEventListener("click", () => send({ over: { ending: "skipped" } }));
byId("leave").addEventListener("click", () => byId("leave-card").showModal());
byId("leave-now").addEventListener("click", () => send("withdrew"));

follow(show, (isLost) => {
  byId("offline").hidden = !isLost;
});
