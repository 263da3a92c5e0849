// The experimenter's page: where everybody is, under which conditions, and what was noted.

import { byId, button, clock, element } from "./dom.js";
import { follow, tell } from "./server.js";

/** From this share of late ticks on, a session is said to run badly. */
const BAD_SHARE = 0.05;
/** After this, s, somebody's page is said to be silent. */
const SILENT_S = 10;

let state = { participants: [], notes: [], codes: [], sign_up: "" };
/** What the rows were built of, so that they are built anew only when they differ and the focus stays. */
let built = "";

function show(next) {
  if (next.page === "unknown") return;
  state = next;
  // Who observes has no buttons; the server would not take what they ask for.
  document.body.dataset.page = state.is_observed ? "observed" : "experimenter";
  byId("title").textContent = state.title;
  document.title = `${state.title} – experimenter`;
  byId("sessions").textContent = `${state.sessions.running} of ${state.sessions.most} sessions`;
  const begun = state.participants.filter((one) => one.progress !== "not begun").length;
  byId("caption").textContent = `${begun} of ${state.planned} planned participants have begun`;
  byId("wizard").hidden = !state.wizard;
  if (state.wizard && !byId("wizard").href.endsWith(state.wizard)) byId("wizard").href = state.wizard;
  showRows();
  showAlarm();
  showNotes();
  showCodes();
}

async function order(command) {
  byId("problem").textContent = await tell("command", command);
}

function showRows() {
  byId("pair-head").hidden = !state.has_pairs;
  const form = state.participants.map(({ participant, progress, mission, is_paused: isPaused }) => [participant, progress, mission, isPaused]);
  if (JSON.stringify(form) !== built) {
    built = JSON.stringify(form);
    const focused = byId("rows").contains(document.activeElement) ? document.activeElement.getAttribute("aria-label") : null;
    byId("rows").replaceChildren(...state.participants.map(rowOf));
    const again = [...byId("rows").querySelectorAll("button")].find((one) => one.getAttribute("aria-label") === focused);
    if (again) again.focus({ preventScroll: true });
    showAbout();
  }
  state.participants.forEach((one, index) => fill(byId("rows").children[index], one));
}

function rowOf(one) {
  const name = element("th", "", one.participant);
  name.scope = "row";
  const cells = Array.from({ length: state.has_pairs ? 7 : 6 }, () => element("td"));
  return element("tr", "", name, ...cells, element("td", "buttons", ...actionsOf(one)));
}

function fill(row, one) {
  const steps = one.steps === undefined ? "" : `${one.done} of ${one.steps}`;
  const now = one.mission ? [one.mission, one.now, one.played_s ? clock(one.played_s) : ""].filter(Boolean).join(" · ") : "";
  const texts = [...(state.has_pairs ? [one.pair] : []), one.progress, steps, one.between ?? "", (one.order ?? []).join(" → "), now, pageOf(one)];
  texts.forEach((text, index) => {
    const cell = row.children[index + 1];
    if (cell.textContent !== text) cell.textContent = text;
  });
  row.classList.toggle("alarm", isSilent(one) || Boolean(one.failed || one.lacks_wizard || one.partner_is_late || runsBadly(one)));
}

const isOut = ({ progress }) => ["not begun", "finished", "excluded", "withdrawn", "parted"].includes(progress);
const isSilent = (one) => !isOut(one) && (one.away_s === null || one.away_s > SILENT_S);

const runsBadly = ({ health }) => (health?.missed ?? 0) >= BAD_SHARE;

/** How well somebody's session runs, and how fast the robot was last. */
function healthOf({ health, is_paused: isPaused }) {
  const ms = (what, value) => (value === null ? "" : `${what} after ${Math.round(value)} ms`);
  const late = (health?.missed ?? null) === null ? "" : `${Math.round(health.missed * 100)} % of ticks late`;
  const parts = [isPaused ? "paused" : "", late, ...(health ? [ms("answered", health.answered_ms), ms("moved", health.moved_ms)] : [])];
  return parts.filter(Boolean).map((part) => ` · ${part}`).join("");
}

function pageOf(one) {
  if (isOut(one)) return "";
  const page = one.away_s === null ? "not open" : one.away_s > SILENT_S ? `silent for ${clock(one.away_s)}` : "open";
  const waits = one.waited_s === null || one.waited_s === undefined ? "" : ` · waits for a partner: ${clock(one.waited_s)}`;
  return `${page}${waits}${one.lacks_wizard ? " · no wizard at the seat" : ""}${healthOf(one)}`;
}

function badly() {
  const all = state.participants.filter(runsBadly).map(({ participant }) => participant);
  return all.length ? `Sessions run late: ${all.join(", ")}` : "";
}

/** What is the same is not told anew to who listens to the page. */
function showAlarm() {
  const lacking = state.participants.filter((one) => one.lacks_wizard).map(({ participant }) => participant);
  const waiting = state.participants.filter((one) => one.partner_is_late).map(({ participant }) => participant);
  // Who fills in a form may be away as long as they like; a mission that nobody plays is none.
  const silent = state.participants.filter((one) => one.progress === "mission" && isSilent(one)).map(({ participant }) => participant);
  const failing = state.participants.filter((one) => one.failed).map(({ participant, failed }) => `${participant} (${failed})`);
  const alarms = [
    failing.length ? `Sessions cannot be started, and are tried again and again: ${failing.join(", ")}` : "",
    silent.length ? `These participants' pages are silent during a mission: ${silent.join(", ")}` : "",
    lacking.length ? `Nobody sits at the wizard's seat: ${lacking.join(", ")}` : "",
    waiting.length ? `These participants have waited long for a partner; please look for the partner: ${waiting.join(", ")}` : "",
    badly(),
  ];
  const text = alarms.filter(Boolean).join(". ");
  if (byId("alarm").textContent !== text) byId("alarm").textContent = text;
}

function actionsOf(one) {
  if (state.is_observed) return [];
  const { participant } = one;
  const labelled = (made, text) => {
    made.setAttribute("aria-label", `${text}: ${participant}`);
    return made;
  };
  const made = [];
  if (one.link) made.push(labelled(button("quiet", "Copy link", (event) => copy(event.target, one.link)), "Copy link"));
  if (one.progress === "mission") {
    const text = one.is_paused ? "Resume" : "Pause";
    made.push(labelled(button("quiet", text, () => order({ pause: { participant, is_paused: !one.is_paused } })), text));
    made.push(labelled(button("quiet", "End mission", () => confirm(state.has_pairs ? `End the mission of ${participant} and their partner?` : `End ${participant}'s mission?`) && order({ end_mission: { participant } })), "End mission"));
  }
  if (!["not begun", "excluded", "withdrawn", "parted"].includes(one.progress)) {
    made.push(
      labelled(button("quiet", "Message", () => {
        const text = prompt(`What do you tell ${participant}? It stands above their page until they close it.`);
        if (text) order({ tell: { participant, text } });
      }), "Message"),
    );
    made.push(
      labelled(button("quiet", "Exclude", () => {
        const reason = prompt(`Why is ${participant} excluded? Their data stay.`);
        if (reason) order({ exclude: { participant, reason } });
      }), "Exclude"),
    );
  }
  if (!["not begun", "withdrawn"].includes(one.progress)) {
    made.push(
      labelled(button("danger", "Withdraw", () => confirm(`Delete all data of ${participant}${state.has_pairs ? ", with the sessions of their pair" : ""}? This cannot be undone.`) && order({ withdraw: { participant } })), "Withdraw"),
    );
  }
  return made;
}

async function copy(from, path) {
  const before = from.textContent;
  try {
    await navigator.clipboard.writeText(location.origin + path);
    from.textContent = "Copied";
    byId("copied").textContent = "The link is copied";
  } catch {
    prompt("Copy this link:", location.origin + path);
  }
  setTimeout(() => {
    from.textContent = before;
    byId("copied").textContent = "";
  }, 1500);
}

function showAbout() {
  const chosen = byId("note-about").value;
  const options = state.participants.map(({ participant }) => {
    const option = element("option", "", participant);
    option.value = participant;
    return option;
  });
  byId("note-about").replaceChildren(byId("note-about").firstElementChild, ...options);
  byId("note-about").value = chosen;
}

function showNotes() {
  const [list, now] = [byId("notes"), JSON.stringify(state.notes)];
  if (list.dataset.shown === now) return;
  list.dataset.shown = now;
  const rows = state.notes.map(({ at_ms, participant, text }) => {
    const at = element("time", "soft", new Date(at_ms).toLocaleString());
    at.dateTime = new Date(at_ms).toISOString();
    return element("li", "", at, " ", element("b", "", participant ?? "Study"), " ", text);
  });
  list.replaceChildren(...rows.reverse());
}

/** Buttons of the study's codes, each with its key. */
function showCodes() {
  const [list, now] = [byId("codes"), JSON.stringify(state.codes)];
  if (list.dataset.shown === now) return;
  list.dataset.shown = now;
  list.hidden = state.codes.length === 0;
  const made = state.codes.map((code) => {
    const one = button("quiet", "", () => noteCode(code));
    one.append(element("kbd", "", code.key), ` ${code.text}`);
    one.setAttribute("aria-keyshortcuts", code.key);
    return one;
  });
  list.replaceChildren(...made);
}

/** Notes a code about whom the next note is to be about. */
async function noteCode({ text }) {
  const participant = byId("note-about").value || null;
  await order({ note: { participant, text } });
  byId("copied").textContent = byId("problem").textContent ? "" : `Noted about ${participant ?? "the study"}: ${text}`;
}

byId("note-form").addEventListener("submit", async (event) => {
  event.preventDefault();
  const participant = byId("note-about").value || null;
  await order({ note: { participant, text: byId("note-text").value } });
  if (!byId("problem").textContent) byId("note-text").value = "";
});

document.addEventListener("keydown", (event) => {
  if (event.target.matches("input, select, textarea") || event.ctrlKey || event.altKey || event.metaKey) return;
  const code = event.repeat ? undefined : state.codes.find(({ key }) => key === event.key);
  if (event.key !== "/" && !code) return;
  event.preventDefault();
  if (code) noteCode(code);
  else byId("note-text").focus();
});

byId("copy-observer").addEventListener("click", (event) => copy(event.target, state.observer));
byId("reserve").addEventListener("click", () => order("reserve"));
byId("copy-sign-up").addEventListener("click", (event) => copy(event.target, state.sign_up));

follow(show, (isLost) => {
  byId("offline").hidden = !isLost;
});
