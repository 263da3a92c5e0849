// The live view: pictures as they come, which camera they are of, and what was clicked in them.

import { byId, capitalised, drawn, element } from "./dom.js";
import { floor } from "./floor.js";
import { keepChoice, keptChoice, send, showLink } from "./socket.js";
import { hearThrough } from "./sound.js";
import { language, text } from "./texts.js";

const HEADER_BYTES = 16;
const FRAME_KIND = 1;

export const view = byId("view");
const picture = view.getContext("2d", { alpha: false });
let waiting = null;
let drawing = false;
/** Whether the session knows of this connection that a picture was seen by it. */
let told = false;
let drawnAt = [];

export function takeFrame(buffer) {
  if (buffer.byteLength <= HEADER_BYTES) return;
  const [kind, index] = new Uint8Array(buffer, 0, 2);
  // What was under way when the view changed is of another camera.
  if (kind !== FRAME_KIND || index !== views.indexOf(looking)) return;
  waiting = buffer;
  if (!drawing) drawNewest();
}

/** Draws what came last; what came meanwhile and is no longer the newest is never decoded. */
async function drawNewest() {
  drawing = true;
  while (waiting) {
    const jpeg = new Blob([new Uint8Array(waiting, HEADER_BYTES)], { type: "image/jpeg" });
    const tick = Number(new DataView(waiting).getBigUint64(8, true));
    const from = looking;
    waiting = null;
    try {
      const bitmap = await createImageBitmap(jpeg);
      if (from === looking) draw(bitmap, tick);
      bitmap.close();
    } catch (problem) {
      console.warn("a frame could not be drawn", problem);
    }
  }
  drawing = false;
}

function draw(bitmap, tick) {
  if (view.width !== bitmap.width || view.height !== bitmap.height) {
    view.width = bitmap.width;
    view.height = bitmap.height;
  }
  picture.drawImage(bitmap, 0, 0);
  shown = { camera: looking.camera, tick };
  window.cohabit.view = looking.camera;
  drawnAt.push(performance.now());
  tellDrawn();
  window.cohabit.frames += 1;
  if (!told) {
    told = send({ type: "shown" });
    document.body.classList.add("seeing");
    showLink("open");
  }
}

/** The first changed frame of a turn is awaited; the session is told when it, or a later one, is on the screen. */
export function awaitFrame({ turn, frame }) {
  if (typeof frame !== "number") return;
  awaited = { turn, frame };
  tellDrawn();
}

function tellDrawn() {
  if (!awaited || !shown || shown.tick < awaited.frame) return;
  send({ type: "drawn", turn: awaited.turn });
  awaited = null;
}

const REMEMBERED = "cohabit-view";
const SEEN_MS = 2600;
/** Views of the first body, which have buttons of their own; the others share a list. */
const MAIN_VIEWS = {
  "spectator/0": "M10 3.2a2.3 2.3 0 1 1 0 4.6 2.3 2.3 0 0 1 0-4.6M4.6 16.8c.3-4 2.6-6 5.4-6s5.1 2 5.4 6",
  "eyes/0": "M1.8 10C4 6.3 6.8 4.6 10 4.6S16 6.3 18.2 10C16 13.7 13.2 15.4 10 15.4S4 13.7 1.8 10M10 7.6a2.4 2.4 0 1 0 0 4.8 2.4 2.4 0 0 0 0-4.8",
  "overhead/0": "M3 3.5h14v13H3zM3 9.5h6.5M11.5 3.5v7M11.5 13.5v3",
};

/** What the session calls the views of its one robot, and what this page does. */
const NAMES = { "Third person": text("view_behind"), "Robot's eyes": text("view_eyes"), "From above": text("view_above") };
const nameOf = ({ name }) => NAMES[name] ?? name;

let views = [];
let looking = null;
/** The picture on the screen: its camera and tick. */
let shown = null;
let awaited = null;
let seenTimer = 0;

export function buildViews(all) {
  views = all;
  // To the session this is another page each time that it connects.
  told = false;
  const icon = (path) => drawn("svg", { viewBox: "0 0 20 20", "aria-hidden": "true" }, drawn("path", { d: path }));
  byId("views-main").replaceChildren(...views.filter(({ camera }) => camera in MAIN_VIEWS).map((view) => {
    const button = element("button", "view-button");
    button.type = "button";
    button.title = `${nameOf(view)} (Alt+C)`;
    button.lang = view.name in NAMES ? language : "en";
    button.dataset.camera = view.camera;
    button.append(icon(MAIN_VIEWS[view.camera]), element("span", "view-name", nameOf(view)));
    button.addEventListener("click", () => lookThrough(view));
    return button;
  }));
  const others = views.filter(({ camera }) => !(camera in MAIN_VIEWS));
  const title = new Option(text("view_more"), "", true, true);
  title.disabled = true;
  byId("views-more").replaceChildren(title, ...others.map(({ camera, name }) => new Option(capitalised(name), camera)));
  byId("views-more").hidden = !others.length;
  byId("views").hidden = views.length < 2;
  const wanted = looking?.camera ?? keptChoice(REMEMBERED);
  looking = null;
  lookThrough(views.find(({ camera }) => camera === wanted) ?? views[0]);
}

/** Shows the frames of a view; the next page of the session begins with it if it was chosen. */
export function lookThrough(view, chosen = true) {
  if (!view || view === looking) return;
  const first = looking === null;
  looking = view;
  hearThrough(view.camera);
  waiting = null;
  // A session shows its first view unasked.
  if (!first || view !== views[0]) send({ type: "view", camera: view.camera });
  for (const button of byId("views-main").children) {
    button.setAttribute("aria-pressed", String(button.dataset.camera === view.camera));
  }
  const listed = view.camera in MAIN_VIEWS ? "" : view.camera;
  byId("views-more").value = listed;
  byId("views-more").classList.toggle("chosen", Boolean(listed));
  hideSeen();
  byId("marks").replaceChildren();
  if (!first) {
    if (chosen) keepChoice(REMEMBERED, view.camera);
    byId("seen").textContent = nameOf(view);
    byId("seen").lang = view.name in NAMES ? language : "en";
  }
}

export function nextView() {
  if (views.length) lookThrough(views[(views.indexOf(looking) + 1) % views.length]);
}

export function lookThroughCamera(camera) {
  lookThrough(views.find((one) => one.camera === camera), false);
}

export const isLookingThrough = (camera) => looking?.camera === camera;

byId("views-more").addEventListener("change", ({ target }) => lookThrough(views.find(({ camera }) => camera === target.value)));

/** Where in the picture, which may be narrower or lower than the canvas's place, a click falls: 0 to 1. */
function placeOf({ clientX, clientY }) {
  const box = view.getBoundingClientRect();
  const scale = Math.min(box.width / view.width, box.height / view.height);
  const [width, height] = [view.width * scale, view.height * scale];
  return {
    x: (clientX - box.left - (box.width - width) / 2) / width,
    y: (clientY - box.top - (box.height - height) / 2) / height,
  };
}

/** What is sent with where somebody points, besides. */
let besides = () => ({});

export function pointWith(told) {
  besides = told;
}

view.addEventListener("click", (event) => {
  const { x, y } = placeOf(event);
  if (!shown || Math.min(x, y) < 0 || Math.max(x, y) > 1) return;
  send({ type: "point", ...shown, x, y, ...besides() });
});

export function takeSeen({ name, x, y, at }) {
  window.cohabit.seen = name;
  const label = byId("seen");
  const frame = view.parentElement.getBoundingClientRect();
  const [left, top] = onScreen(x, y);
  label.textContent = capitalised(name);
  label.lang = "en";
  label.classList.add("placed");
  const half = label.offsetWidth / 2 + 6;
  label.style.left = `${Math.max(half, Math.min(frame.width - half, left))}px`;
  label.style.top = `${Math.max(40, top)}px`;
  clearTimeout(seenTimer);
  seenTimer = setTimeout(hideSeen, SEEN_MS);
  if (at) floor.pointOut({ x: at[0], y: at[1], name });
}

/** Numbers over the things that the robot asks about, where they are in the picture. */
export function takeMarks({ camera, marks }) {
  window.cohabit.marks = marks;
  const shown = camera === looking?.camera ? marks : [];
  byId("marks").replaceChildren(...shown.map(({ number, x, y }) => {
    const mark = element("span", "mark", String(number));
    const [left, top] = onScreen(x, y);
    mark.style.left = `${left}px`;
    mark.style.top = `${Math.max(14, top)}px`;
    return mark;
  }));
}

/** Where a place of the picture, 0 to 1 from the left and from the top, is in the frame around it, px. */
function onScreen(x, y) {
  const [frame, box] = [view.parentElement.getBoundingClientRect(), view.getBoundingClientRect()];
  const scale = Math.min(box.width / view.width, box.height / view.height);
  return [
    box.left - frame.left + (box.width - view.width * scale) / 2 + x * view.width * scale,
    box.top - frame.top + (box.height - view.height * scale) / 2 + y * view.height * scale,
  ];
}

export function hideSeen() {
  byId("seen").classList.remove("placed");
  byId("seen").textContent = "";
}

export function showRate() {
  const now = performance.now();
  drawnAt = drawnAt.filter((at) => now - at < 2000);
  byId("fps").textContent = window.cohabit.frames ? `${Math.round(drawnAt.length / 2)} fps` : "";
}
