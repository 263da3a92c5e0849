// Driving a body: who one may be, the keys, the stick and the mouse that move it, and what it can do with what it sees.

import { byId, capitalised, element, toast } from "./dom.js";
import { collapseGoals } from "./goals.js";
import { sendOrSay } from "./page.js";
import { send } from "./socket.js";
import { language, text } from "./texts.js";
import { hideSeen, isLookingThrough, lookThroughCamera, view } from "./view.js";

/** What is asked of a body at most; the session cuts it down to what the body can do. */
const WALK_M_S = 1.4;
const BACK_M_S = 0.9;
const TURN_RAD_S = 1.9;
const PITCH_RAD_S = 0.9;
/** How often a key that is held down is told again: a body goes on for half a second without. */
const RENEW_MS = 110;
/** What a drag across the height of the picture turns by, rad: the picture takes in as much. */
const DRAG_RAD = 0.96;
/** A touch or press that moves further than this is a drag, px. */
const DRAG_PX = 5;
/** How long what came of a deed is shown. */
const SAID_MS = 4500;

/** Keys by where they lie, so that they lie well on every keyboard. */
const MOVES = {
  KeyW: ["forward", 1], ArrowUp: ["forward", 1],
  KeyS: ["forward", -1], ArrowDown: ["forward", -1],
  KeyA: ["turn", 1], ArrowLeft: ["turn", 1],
  KeyD: ["turn", -1], ArrowRight: ["turn", -1],
  KeyR: ["pitch", 1], PageUp: ["pitch", 1],
  KeyF: ["pitch", -1], PageDown: ["pitch", -1],
};
/**
 * The keys of what is offered, the most obvious first; some deeds have their own, lest they be done by mistake. They are found by where
 * they lie, too, so they are some that are labelled alike on German and French keyboards: the key that turns to the left is labelled Q on
 * French ones.
 */
const OFFER_KEYS = ["E", "X", "C", "G", "B"];
const OWN_KEYS = { throw: "T", scan: "V" };

let bodies = [];
/** The seat of this page, if each person has one: it drives the avatar of that seat alone. */
let seat = null;
let driven = null;
let before = null;
let labelBefore = "";
let offered = { object: null, options: [] };
let held = new Set();
let stick = { forward: 0, turn: 0 };
/** What a drag has asked for and was not told yet, rad. */
let dragged = { turn: 0, pitch: 0 };
let moving = false;
let toldAt = 0;
let saidTimer = 0;

const input = byId("chat-input");
const still = { forward_m_s: 0, turn_rad_s: 0, pitch_rad_s: 0 };

export const isDriving = () => driven !== null;

// ---------------------------------------------------------------------------------------------- walking in and out

/** Takes in which seat this page has, before it is told which bodies there are. */
export function takeSeat(own) {
  seat = own ?? null;
}

/** Takes in which bodies this session lets people drive. */
export function buildDriving(all) {
  bodies = seat ? all.filter(({ body }) => body === seat.body) : all;
  byId("walk-in").hidden = !bodies.length || isDriving();
  closeMenu();
  stopDriving("");
}

function walkIn() {
  if (bodies.length === 1) drive(bodies[0].body);
  else if (byId("walk-menu").hidden) openMenu();
  else closeMenu();
}

function openMenu() {
  const states = window.cohabit.state;
  byId("walk-menu").replaceChildren(...bodies.map(({ body, name }) => {
    const button = element("button", "", capitalised(name));
    const taken = Boolean(states?.driven?.includes(body));
    button.type = "button";
    button.disabled = taken;
    if (taken) button.append(element("span", "taken", text("body_taken")));
    button.addEventListener("click", () => drive(body));
    return button;
  }));
  byId("walk-menu").hidden = false;
  tellMenu();
  byId("walk-menu").querySelector("button:enabled")?.focus();
}

function closeMenu() {
  byId("walk-menu").hidden = true;
  tellMenu();
}

/** Says whether the menu is open, where there is one to open. */
function tellMenu() {
  if (bodies.length > 1) byId("walk-in").setAttribute("aria-expanded", String(!byId("walk-menu").hidden));
  else byId("walk-in").removeAttribute("aria-expanded");
}

function drive(body) {
  closeMenu();
  sendOrSay({ type: "drive_body", body });
}

export function leave() {
  if (!isDriving()) return;
  send({ type: "release" });
  stopDriving("");
}

/** The session says that this page drives a body, or no longer does. */
export function takeDriving({ body, text: why }) {
  if (body === null) stopDriving(why);
  else startDriving(bodies.find((one) => one.body === body));
}

function startDriving(body) {
  if (!body) return;
  driven = body;
  window.cohabit.driving = body.body;
  before = before ?? window.cohabit.view;
  document.body.classList.add("driving");
  byId("walk-in").hidden = true;
  byId("driver-name").textContent = capitalised(body.name);
  collapseGoals(true);
  lookThroughCamera(body.camera);
  hideSeen();
  takeAim({ object: null, options: [] });
  showHeld(window.cohabit.state);
  input.blur();
  labelBefore = view.getAttribute("aria-label");
  view.setAttribute("aria-label", text("picture_driven", { name: body.name }));
  // A screen reader then leaves the keys to the page.
  view.role = "application";
  view.tabIndex = 0;
  view.focus({ preventScroll: true });
}

function stopDriving(why) {
  // Who asked for a body and does not get it is told as well.
  if (why) toast(why, "en");
  if (!isDriving()) return;
  const was = driven;
  driven = null;
  window.cohabit.driving = null;
  letGo();
  document.body.classList.remove("driving");
  byId("walk-in").hidden = !bodies.length;
  collapseGoals(false);
  view.role = "img";
  view.removeAttribute("tabindex");
  view.setAttribute("aria-label", labelBefore);
  if (isLookingThrough(was.camera) && before) lookThroughCamera(before);
  before = null;
}

// ---------------------------------------------------------------------------------------------- moving

/** Takes a key while a body is driven; whether it was one of its keys. */
export function takeKey(event) {
  if (!isDriving() || event.ctrlKey || event.metaKey || event.altKey) return false;
  if (event.key === "Escape") {
    if (event.repeat) return true;
    if (document.activeElement === input) view.focus({ preventScroll: true });
    else leave();
    return true;
  }
  if (isTyping()) return false;
  if (event.key === "/" || (event.key === "Enter" && document.activeElement === view)) {
    event.preventDefault();
    letGo();
    input.focus();
    return true;
  }
  if (event.code in MOVES) {
    event.preventDefault();
    held.add(event.code);
    tell();
    return true;
  }
  const offer = offered.options.find(({ key }) => event.code === `Key${key}`);
  if (offer && !event.repeat) act(offer);
  // Other letters begin no sentence while somebody walks.
  return /^\p{L}$/u.test(event.key);
}

function isTyping() {
  const { activeElement } = document;
  return activeElement === input || activeElement instanceof HTMLSelectElement;
}

document.addEventListener("keyup", ({ code }) => {
  if (held.delete(code)) tell();
});
/** What is held down when the page goes out of sight is not seen to be let go. */
window.addEventListener("blur", letGo);
document.addEventListener("visibilitychange", () => document.hidden && letGo());
input.addEventListener("focus", letGo);

function letGo() {
  held.clear();
  stick = { forward: 0, turn: 0 };
  dragged = { turn: 0, pitch: 0 };
  tell();
}

/** What keys, stick and drag ask for together. */
function wanted(passedMs) {
  const sum = { forward: stick.forward, turn: stick.turn, pitch: 0 };
  for (const code of held) {
    const [axis, sign] = MOVES[code];
    sum[axis] += sign;
  }
  const limited = (value) => Math.max(-1, Math.min(1, value));
  const forward = limited(sum.forward);
  const seconds = Math.max(passedMs, RENEW_MS) / 1000;
  const [turn, pitch] = [dragged.turn / seconds, dragged.pitch / seconds];
  dragged = { turn: 0, pitch: 0 };
  return {
    forward_m_s: forward * (forward < 0 ? BACK_M_S : WALK_M_S),
    turn_rad_s: limited(sum.turn) * TURN_RAD_S + turn,
    pitch_rad_s: limited(sum.pitch) * PITCH_RAD_S + pitch,
  };
}

/** Tells what is wanted now; that nothing is wanted is told once. */
function tell() {
  if (!isDriving()) {
    moving = false;
    return;
  }
  const now = performance.now();
  const asked = wanted(now - toldAt);
  const moves = Object.values(asked).some((value) => value !== 0);
  if (!moves && !moving) return;
  moving = moves;
  toldAt = now;
  send({ type: "drive", ...still, ...asked });
}

setInterval(() => moving && performance.now() - toldAt >= RENEW_MS && tell(), RENEW_MS / 2);

// ---------------------------------------------------------------------------------------------- looking by dragging

let pressed = null;

view.addEventListener("pointerdown", (event) => {
  if (!isDriving() || event.button !== 0) return;
  pressed = { id: event.pointerId, x: event.clientX, y: event.clientY, drags: false };
});

view.addEventListener("pointermove", (event) => {
  if (pressed?.id !== event.pointerId || !isDriving()) return;
  const [dx, dy] = [event.clientX - pressed.x, event.clientY - pressed.y];
  if (!pressed.drags && Math.hypot(dx, dy) < DRAG_PX) return;
  if (!pressed.drags) view.setPointerCapture(event.pointerId);
  const perPixel = DRAG_RAD / view.getBoundingClientRect().height;
  Object.assign(pressed, { x: event.clientX, y: event.clientY, drags: true });
  // The picture is dragged, not the eye.
  dragged.turn += dx * perPixel;
  dragged.pitch += dy * perPixel;
  moving = true;
});

/** Whether the press that ends here was a drag, and so is no click. */
let wasDrag = false;
for (const end of ["pointerup", "pointercancel"]) {
  view.addEventListener(end, (event) => {
    if (pressed?.id !== event.pointerId) return;
    wasDrag = pressed.drags;
    pressed = null;
  });
}
view.addEventListener("click", (event) => {
  if (wasDrag) event.stopImmediatePropagation();
  wasDrag = false;
  if (isDriving()) view.focus({ preventScroll: true });
}, { capture: true });

// ---------------------------------------------------------------------------------------------- the stick

const pad = byId("stick");

function pushStick({ clientX, clientY }) {
  const box = pad.getBoundingClientRect();
  const reach = box.width / 2;
  let [x, y] = [(clientX - box.left) / reach - 1, (clientY - box.top) / reach - 1];
  const length = Math.max(Math.hypot(x, y), 1);
  [x, y] = [x / length, y / length];
  byId("knob").style.translate = `${x * reach * 0.6}px ${y * reach * 0.6}px`;
  // A thumb is not exact: a little off the middle is the middle.
  const beyond = (value) => Math.sign(value) * Math.max(0, Math.abs(value) - 0.15) / 0.85;
  stick = { forward: beyond(-y), turn: beyond(-x) };
  if (!moving) tell();
  moving = true;
}

pad.addEventListener("pointerdown", (event) => {
  event.preventDefault();
  pad.setPointerCapture(event.pointerId);
  pushStick(event);
});
pad.addEventListener("pointermove", (event) => pad.hasPointerCapture(event.pointerId) && pushStick(event));
for (const end of ["pointerup", "pointercancel"]) {
  pad.addEventListener(end, () => {
    stick = { forward: 0, turn: 0 };
    byId("knob").style.translate = "";
    tell();
  });
}

// ---------------------------------------------------------------------------------------------- the hand

/** What is before the body, or was clicked, and what can be done with it. */
export function takeAim(aim) {
  const keys = [...OFFER_KEYS];
  offered = { ...aim, options: aim.options.map((option) => ({ ...option, key: OWN_KEYS[option.deed] ?? keys.shift() })) };
  window.cohabit.aim = aim;
  byId("hud").classList.toggle("aims", aim.object !== null);
  byId("aim-name").textContent = aim.name ? capitalised(aim.name) : "";
  byId("aim-hint").textContent = aim.far ? text("come_closer") : "";
  byId("offers").replaceChildren(...offered.options.map((option) => {
    const button = element("button", option.key === OFFER_KEYS[0] ? "offer first" : "offer");
    button.type = "button";
    button.setAttribute("aria-keyshortcuts", option.key);
    button.append(element("kbd", "", option.key), element("span", "", option.label));
    // The focus stays where the keys are taken from.
    button.addEventListener("pointerdown", (event) => event.preventDefault());
    button.addEventListener("click", () => act(option));
    return button;
  }));
}

function act({ deed }) {
  if (isDriving()) send({ type: "act", deed, object: offered.object });
}

/** What came of a deed of one's own. */
export function takeActed({ ok, text: told }) {
  const line = byId("acted");
  line.textContent = told;
  line.classList.toggle("failed", !ok);
  clearTimeout(saidTimer);
  saidTimer = setTimeout(() => { line.textContent = ""; }, SAID_MS);
}

/** What the driven body holds. */
export function showHeld(state) {
  if (!isDriving() || !state) return;
  const all = [state.robot, ...state.others];
  const holding = all.find((one) => one?.body === driven.body)?.holding;
  byId("driver-holding").textContent = holding ? capitalised(holding) : text("nothing");
  byId("driver-holding").lang = holding ? "en" : language;
  byId("driver-holding").classList.toggle("none", !holding);
}

byId("walk-in").addEventListener("click", walkIn);
byId("leave").addEventListener("click", leave);
byId("walk-menu").addEventListener("keydown", (event) => {
  if (event.key !== "Escape") return;
  event.stopPropagation();
  closeMenu();
  byId("walk-in").focus();
});
