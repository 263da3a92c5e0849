// The wizard's page of a study: opens the seat of the session that a participant plays with a wizard.

import { byId, button, element } from "./dom.js";
import { follow } from "./server.js";

let sessions = [];
/** Which is open, by its address. */
let open = "";

/** A session's pages are at the study's host, at a port of their own. */
const addressOf = ({ port, token }) => `${location.protocol}//${location.hostname}:${port}/wizard?token=${encodeURIComponent(token)}`;

function show(next) {
  if (next.page === "unknown") return;
  byId("title").textContent = next.title;
  document.title = `${next.title} – wizard`;
  const isNew = JSON.stringify(next.sessions) !== JSON.stringify(sessions);
  sessions = next.sessions;
  if (!sessions.some((session) => addressOf(session) === open)) sit(sessions.find((session) => !session.is_over) ?? sessions[0]);
  else if (isNew) showSessions();
}

/** Takes the wizard's seat of a session, or of none. */
function sit(session) {
  const address = session ? addressOf(session) : "";
  if (address !== open) {
    open = address;
    byId("content").querySelector("iframe")?.remove();
    byId("waiting").hidden = Boolean(session);
    if (session) {
      document.body.dataset.page = "seat";
      const frame = element("iframe", "session");
      frame.title = `Wizard's seat of ${session.participant}`;
      frame.allow = "autoplay";
      frame.src = address;
      frame.addEventListener("load", () => frame.focus());
      byId("content").append(frame);
    } else {
      delete document.body.dataset.page;
    }
  }
  showSessions();
}

function showSessions() {
  byId("sessions").replaceChildren(...sessions.map((session) => {
    const made = button("quiet", `${session.participant} · ${session.mission}${session.is_over ? " (over)" : ""}`, () => sit(session));
    made.setAttribute("aria-pressed", String(addressOf(session) === open));
    return made;
  }));
}

follow(show, (isLost) => {
  byId("offline").hidden = !isLost;
});
