// A participant's page: shows what the study's server says that it is time for.

import { byId, button, clock, element } from "./dom.js";
import { probeForm, questionnaireForm } from "./forms.js";
import { endFollowing, follow, tell, tellQuietly } from "./server.js";
import { text as words } from "./texts.js";

/** Pages after which nothing follows. */
const LAST = ["finished", "withdrawn", "excluded", "parted", "elsewhere", "unknown"];

/** What is shown, so that it is built once; and how it takes in what changes. */
let shown = "";
let update = () => {};
let step = null;
/** The message of the experimenter's that was closed. */
let closedMessage = null;

/**
 * What is left of a page when the server no longer knows its link. Links of participants are forgotten only when they
 * withdraw, be it while the server was away; those of people who have not agreed yet, whenever it is started.
 */
let kept = { takesPart: false };

/** Whether it is the last page of somebody whose answers are kept. */
const hasEnded = (page) => ["finished", "parted", "excluded"].includes(page);

const send = (event) => tell("event", { step, event });

function show(answer) {
  const state = answer.page === "unknown" ? { ...kept, page: kept.takesPart ? "withdrawn" : "unknown" } : answer;
  const takesPart = kept.takesPart || Boolean(state.step) || hasEnded(state.page);
  kept = { title: state.title, contact: state.contact, takesPart };
  const key = JSON.stringify([state.page, state.step, state.session, state.may]);
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
  document.title = state.title ?? words("study");
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
  byId("bar-step").textContent = state.step ? words("step_of", { step: state.step, steps: state.steps }) : "";
  const isTimed = state.page === "mission" && !state.is_over && state.left_s !== null;
  byId("bar-time").textContent = isTimed ? words("time_left", { time: clock(state.left_s) }) : "";
  const mayLeave = Boolean(state.step) || hasEnded(state.page);
  byId("leave").hidden = !mayLeave;
  byId("paused").hidden = !state.is_paused || state.is_over;
  showMessage(state.message);
  byId("leave-pair").hidden = !state.is_with_partner;
  byId("contact").textContent = state.contact ? words("contact", { contact: state.contact }) : "";
  if (state.page !== "mission" || state.is_over) byId("skip-card").close();
  if (state.page === "withdrawn") byId("leave-card").close();
}

/** What the experimenter has told this participant last, until they close it. */
function showMessage(message) {
  const isOpen = Boolean(message) && message.number !== closedMessage;
  byId("told").hidden = !isOpen;
  const text = isOpen ? words("message_from", { text: message.text }) : "";
  if (byId("told-text").textContent !== text) byId("told-text").textContent = text;
  byId("told-close").onclick = () => {
    closedMessage = message?.number ?? null;
    showMessage(message);
  };
}

const heading = (text) => element("h1", "", text);

/** Words for a while, such as 4 minutes. */
function whileOf(seconds) {
  const minutes = Math.round(seconds / 60);
  if (minutes < 1) return words("while_seconds", { count: Math.round(seconds) });
  return minutes === 1 ? words("while_minute") : words("while_minutes", { count: minutes });
}

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

/** Lets the keyboard scroll what does not fit its place: there may be nothing in it that takes the focus. */
function scrollByKeyboard(box) {
  const fitting = new ResizeObserver(() => {
    if (box.scrollHeight > box.clientHeight) box.tabIndex = 0;
    else box.removeAttribute("tabindex");
  });
  for (const part of [box, ...box.children]) fitting.observe(part);
}

/** What is to be tried in a tutorial, ticked as it is; and the button that goes on from there. */
function exerciseList(exercises) {
  const count = element("p", "soft", "");
  count.role = "status";
  const states = exercises.map(() => element("span", "unseen", ""));
  const items = exercises.map(({ text }, at) => element("li", "exercise", element("span", "", text), states[at]));
  const go = going(words("go_on"), () => "goes_on");
  const goOn = go.querySelector("button");
  const shown = element("section", "exercises", element("h2", "", words("try_this")), element("ol", "", ...items), count, go);
  shown.setAttribute("aria-label", words("things_to_try"));
  scrollByKeyboard(shown);
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
        states[at].textContent = isTried ? words("tried_mark") : "";
      });
      const done = now.filter(({ is_tried: isTried }) => isTried).length;
      count.textContent = done === now.length ? words("tried_all") : words("tried_some", { done, all: now.length });
      goOn.disabled = !mayGoOn;
    },
  };
}

/** Who of a pair wants to skip the mission, and what follows if this one does. */
function showSkipOfPair(line, ofPair) {
  const text = ofPair?.is_asked ? words("skip_asked") : ofPair?.is_wanted ? words("skip_wanted") : "";
  if (line.textContent !== text) line.textContent = text;
  line.hidden = !text;
  const follows = byId("skip-pair");
  follows.hidden = !ofPair;
  follows.textContent = ofPair ? (ofPair.by === "both" ? words("skip_both") : words("skip_either")) : "";
}

/** What shows that somebody took part, if anything does. */
function proof(completion) {
  const parts = [];
  if (completion?.code) {
    const code = element("output", "code", completion.code);
    parts.push(element("p", "", words("completion_code"), code));
  }
  if (completion?.return) {
    const link = element("a", "chief", words("completion_return"));
    link.href = completion.return;
    parts.push(element("p", "actions", link));
  }
  return parts;
}

const PAGES = {
  information: ({ html }) => [heading(words("information")), sheet(html), going(words("information_read"), () => "read")],

  consent({ html, boxes: asked, version }) {
    const form = element("form", "consent");
    const boxes = asked.map(({ text, is_required: isRequired }) => {
      const box = element("input");
      box.type = "checkbox";
      box.required = isRequired;
      const sentence = element("span", "", text, ...(isRequired ? [] : [element("span", "soft", words("optional"))]));
      form.append(element("label", "check", box, sentence));
      return box;
    });
    const agree = element("button", "chief", words("consent_agree"));
    agree.type = "submit";
    const problem = element("p", "problem");
    problem.role = "alert";
    form.append(problem, element("div", "actions", button("quiet", words("consent_decline"), () => send("declined")), agree));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      agree.disabled = true;
      const ticked = boxes.flatMap((box, number) => (box.checked ? [number] : []));
      problem.textContent = await send({ consented: { version, ticked } });
      agree.disabled = false;
    });
    return [heading(words("consent")), sheet(html), form];
  },

  declined: () => [
    heading(words("declined")),
    element("p", "", words("declined_about")),
    element("div", "actions", button("quiet", words("declined_back"), () => send("read"))),
  ],

  questionnaire({ questionnaire, draft }) {
    const about = element("p", "soft", questionnaire.about);
    const { name } = questionnaire;
    const answer = (answers) => send({ answered: { questionnaire: name, answers } });
    const keep = (answers, isLast) => tellQuietly("event", { step, event: { drafted: { questionnaire: name, answers } } }, isLast);
    return [heading(questionnaire.title), about, questionnaireForm(questionnaire, draft, answer, keep)];
  },

  ready({ html, is_tutorial: isTutorial, is_with_partner: isWithPartner, limit_s, skip_after_s }) {
    const lines = [];
    if (isWithPartner) lines.push(words("ready_pair"));
    if (isTutorial) lines.push(words("ready_tutorial"));
    if (limit_s !== null) lines.push(words("ready_limit", { while: whileOf(limit_s) }));
    if (skip_after_s !== null) {
      const values = { while: whileOf(skip_after_s) };
      lines.push(isTutorial ? words("ready_tutorial_skip", values) : words("ready_skip", values));
    }
    const title = heading(isTutorial ? words("tutorial_next") : words("mission_next"));
    const robot = element("p", "robot-language", words("robot_language"));
    return [title, sheet(html), robot, element("p", "", lines.join(" ")), going(words("begin"), () => "goes_on")];
  },

  waiting() {
    const place = element("p", "", "");
    place.role = "status";
    update = ({ ahead }) => {
      const text = ahead ? (ahead === 1 ? words("waiting_one") : words("waiting_several", { count: ahead })) : words("waiting_next");
      if (place.textContent !== text) place.textContent = text;
    };
    return [heading(words("waiting")), element("p", "", words("waiting_about")), place];
  },

  partner({ may }) {
    const late = element("p", "", "");
    late.role = "status";
    update = ({ is_late: isLate }) => {
      const text = isLate ? words("partner_late") : "";
      if (late.textContent !== text) late.textContent = text;
    };
    const instead = {
      alone: () => [element("p", "", words("partner_alone_about")), going(words("partner_alone"), () => "goes_alone")],
      end: () => [element("p", "", words("partner_stop_about")), going(words("partner_stop"), () => "stops_waiting")],
    };
    const offered = instead[may]?.() ?? [];
    return [heading(words("partner_waiting")), element("p", "", words("partner_about")), late, ...offered];
  },

  starting() {
    const text = element("p", "", words("starting_about"));
    text.role = "status";
    return [heading(words("starting")), text];
  },

  mission({ session, exercises }) {
    const frame = element("iframe", "session");
    frame.title = words("session");
    frame.allow = session.has_microphone ? "microphone; autoplay" : "autoplay";
    frame.src = `${location.protocol}//${location.hostname}:${session.port}/?token=${session.token}`;
    const over = element("p", "over", words("mission_over"));
    over.role = "status";
    over.hidden = true;
    const skip = button("quiet", words("skip"), () => byId("skip-card").showModal());
    skip.id = "skip";
    const offer = element("div", "offer", element("p", "", words("skip_offer")), skip);
    const wish = element("p", "wish", "");
    wish.role = "status";
    const probes = element("div", "probes");
    probes.role = "status";
    let asked = null;
    const list = exercises.length > 0 ? exerciseList(exercises) : null;
    update = ({ is_over: isOver, skip_in_s: skipInS, skip: ofPair, probe, exercises: now, may_go_on: mayGoOn }) => {
      over.hidden = !isOver;
      offer.hidden = list !== null || isOver || skipInS !== 0 || Boolean(ofPair?.is_asked);
      showSkipOfPair(wish, isOver ? null : ofPair);
      list?.update(now, mayGoOn, isOver);
      const number = probe?.number ?? null;
      if (number === asked) return;
      asked = number;
      const answer = (given) => send({ probe_answered: { probe: number, answer: given } });
      const during = probe?.pauses ? words("probe_about_pause") : words("probe_about");
      const about = isOver ? words("probe_about_end") : during;
      probes.replaceChildren(...(number === null ? [] : [probeForm(probe.item, about, answer)]));
    };
    const beside = list ? element("div", "beside", frame, list.shown) : frame;
    return [element("h1", "unseen", list ? words("tutorial") : words("mission")), over, wish, offer, beside, probes];
  },

  break({ html }) {
    const left = element("p", "soft", "");
    update = ({ left_s }) => {
      left.textContent = left_s === null ? "" : words("break_left", { time: clock(left_s) });
    };
    return [heading(words("break")), sheet(html), left, going(words("go_on_now"), () => "goes_on")];
  },

  finished({ html, completion }) {
    const parts = [heading(words("finished"))];
    if (html) parts.push(sheet(html));
    else parts.push(element("p", "", words("finished_about")));
    return [...parts, ...proof(completion)];
  },

  parted({ html, completion }) {
    const parts = [heading(words("parted")), element("p", "", words("parted_about"))];
    if (html) parts.push(sheet(html));
    return [...parts, ...proof(completion)];
  },

  withdrawn: () => [
    heading(words("withdrawn")),
    element("p", "", words("withdrawn_about")),
  ],

  excluded({ html }) {
    const parts = [heading(words("excluded")), element("p", "", words("excluded_about"))];
    if (html) parts.push(sheet(html));
    return parts;
  },

  elsewhere: () => [
    heading(words("elsewhere")),
    element("p", "", words("elsewhere_about")),
    element("div", "actions", button("chief", words("elsewhere_here"), () => location.reload())),
  ],

  unknown: () => [
    heading(words("unknown")),
    element("p", "", words("unknown_about")),
  ],
};

/** The server is told what a card asks. The card stays open until that was taken in, and says why it was not. */
function tellFromCard(name, event) {
  const [now, card, problem] = ["now", "card", "problem"].map((part) => byId(`${name}-${part}`));
  now.addEventListener("click", async (click) => {
    click.preventDefault();
    now.disabled = true;
    problem.textContent = await send(event);
    now.disabled = false;
    if (!problem.textContent) card.close();
  });
  card.addEventListener("close", () => {
    problem.textContent = "";
  });
}

tellFromCard("skip", { over: { ending: "skipped" } });
tellFromCard("leave", "withdrew");
byId("leave").addEventListener("click", () => byId("leave-card").showModal());

follow(show, (isLost) => {
  byId("offline").hidden = !isLost;
});
