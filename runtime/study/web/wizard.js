// The wizard's page of a study: opens the seat of the session that a participant plays with a wizard.

import { byId, button, element } from "./dom.js";
import { follow } from "./server.js";

let seats = [];
/** Which is open, by its address. */
let open = "";

/** A session's pages are at the study's host, at a port of their own. */
const addressOf = ({ port, token }) => `${location.protocol}//${location.hostname}:${port}/wizard?token=${encodeURIComponent(token)}`;

function show(next) {
  if (next.page === "unknown") return;
  byId("title").textContent = next.title;
  document.title = `${next.title} – wizard`;
  const isNew = JSON.stringify(next.seats) !== JSON.stringify(seats);
  seats = next.seats;
  if (!seats.some((seat) => addressOf(seat) === open)) sit(seats.find((seat) => !seat.is_over) ?? seats[0]);
  else if (isNew) showSeats();
}

/** Takes the seat of a session, or none. */
function sit(seat) {
  const address = seat ? addressOf(seat) : "";
  if (address !== open) {
    open = address;
    byId("content").querySelector("iframe")?.remove();
    byId("waiting").hidden = Boolean(seat);
    if (seat) {
      document.body.dataset.page = "seat";
      const frame = element("iframe", "session");
      frame.title = `Wizard's seat of ${seat.participant}`;
      frame.allow = "autoplay";
      frame.src = address;
      frame.addEventListener("load", () => frame.focus());
      byId("content").append(frame);
    } else {
      delete document.body.dataset.page;
    }
  }
  showSeats();
}

function showSeats() {
  byId("seats").replaceChildren(...seats.map((seat) => {
    const made = button("quiet", `${seat.participant} · ${seat.mission}${seat.is_over ? " (over)" : ""}`, () => sit(seat));
    made.setAttribute("aria-pressed", String(addressOf(seat) === open));
    return made;
  }));
}

follow(show, (isLost) => {
  byId("offline").hidden = !isLost;
});
