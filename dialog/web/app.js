// The page of a session: shows what the robot sees, says and has yet to do, and sends what a person types.
// It knows the messages of the service's socket and nothing of the world behind them.

const byId = (id) => document.getElementById(id);
const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
const narrow = window.matchMedia("(max-width: 820px)");

/** What tests and curious people may read. */
window.cohabit = { frames: 0, state: null, latency: null, view: null, seen: null };

function element(tag, className, text) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

function drawn(tag, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

const capitalised = (text) => text.charAt(0).toUpperCase() + text.slice(1);

// ---------------------------------------------------------------------------------------------- the socket

const FIRST_PAUSE_MS = 500;
const LONGEST_PAUSE_MS = 5000;
/** A session sends its state many times a second; this long without a word means that it hangs. */
const SILENCE_MS = 4000;

let socket = null;
let pauseMs = FIRST_PAUSE_MS;
let heardAt = 0;

function socketAddress() {
  const token = new URLSearchParams(location.search).get("token");
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  return `${scheme}://${location.host}/ws${token === null ? "" : `?token=${encodeURIComponent(token)}`}`;
}

function connect() {
  socket = new WebSocket(socketAddress());
  socket.binaryType = "arraybuffer";
  socket.onmessage = ({ data }) => {
    heardAt = performance.now();
    if (typeof data === "string") take(JSON.parse(data));
    else takeFrame(data);
  };
  socket.onclose = () => {
    showLink("lost");
    endDoing();
    setTimeout(connect, pauseMs);
    pauseMs = Math.min(pauseMs * 1.8, LONGEST_PAUSE_MS);
  };
}

function send(message) {
  if (socket?.readyState !== WebSocket.OPEN) return false;
  socket.send(JSON.stringify(message));
  return true;
}

const receivers = {
  hello: takeHello,
  state: takeState,
  chat: takeLine,
  progress: takeProgress,
  turn: takeTurn,
  latency: takeLatency,
  seen: takeSeen,
  highlight: (message) => floor.pointOut(message),
  error: (message) => toast(message.text),
};

function take(message) {
  receivers[message.type]?.(message);
}

function takeHello({ session, mission, map, views }) {
  pauseMs = FIRST_PAUSE_MS;
  showLink("open");
  byId("session").textContent = session;
  document.title = mission.title ? `${mission.title} · Cohabit` : "Cohabit";
  byId("goals-title").textContent = mission.title || "Mission";
  byId("goals-about").textContent = mission.description === mission.title ? "" : mission.description;
  floor.build(map);
  buildViews(views);
  clearChat();
  endDoing();
}

function showLink(link) {
  const { classList } = document.body;
  classList.remove("connecting", "open", "lost", "quiet");
  classList.add(link);
  const words = { connecting: "connecting", open: "connected", lost: "not connected", quiet: "no word from the session" };
  byId("link-text").textContent = words[link];
  const notices = {
    lost: "The session has ended or cannot be reached; trying again…",
    quiet: "The session has gone quiet; waiting for it…",
    open: window.cohabit.frames ? "" : "Waiting for the first picture…",
  };
  showNotice(notices[link] ?? "");
}

function showNotice(text) {
  byId("notice-text").textContent = text;
  byId("notice").hidden = !text;
}

function watchSilence() {
  if (socket?.readyState !== WebSocket.OPEN || !heardAt) return;
  const silent = performance.now() - heardAt > SILENCE_MS;
  const { classList } = document.body;
  if (silent && classList.contains("open")) showLink("quiet");
  else if (!silent && classList.contains("quiet")) showLink("open");
}

// ---------------------------------------------------------------------------------------------- the live view

const HEADER_BYTES = 16;
const FRAME_KIND = 1;

const view = byId("view");
const picture = view.getContext("2d", { alpha: false });
let waiting = null;
let drawing = false;
let told = false;
let drawnAt = [];

function takeFrame(buffer) {
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
  window.cohabit.frames += 1;
  if (!told) {
    told = send({ type: "shown" });
    document.body.classList.add("seeing");
    showLink("open");
  }
}

// ---------------------------------------------------------------------------------------------- the views

const REMEMBERED = "cohabit-view";
const SEEN_MS = 2600;
/** Views of the first body, which have buttons of their own; the others share a list. */
const MAIN_VIEWS = {
  "spectator/0": "M10 3.2a2.3 2.3 0 1 1 0 4.6 2.3 2.3 0 0 1 0-4.6M4.6 16.8c.3-4 2.6-6 5.4-6s5.1 2 5.4 6",
  "eyes/0": "M1.8 10C4 6.3 6.8 4.6 10 4.6S16 6.3 18.2 10C16 13.7 13.2 15.4 10 15.4S4 13.7 1.8 10M10 7.6a2.4 2.4 0 1 0 0 4.8 2.4 2.4 0 0 0 0-4.8",
  "overhead/0": "M3 3.5h14v13H3zM3 9.5h6.5M11.5 3.5v7M11.5 13.5v3",
};

let views = [];
let looking = null;
/** The picture on the screen: its camera and tick. */
let shown = null;
let seenTimer = 0;

function buildViews(all) {
  views = all;
  const icon = (path) => drawn("svg", { viewBox: "0 0 20 20", "aria-hidden": "true" }, drawn("path", { d: path }));
  byId("views-main").replaceChildren(...views.filter(({ camera }) => camera in MAIN_VIEWS).map((view) => {
    const button = element("button", "view-button");
    button.type = "button";
    button.title = `${view.name} (Alt+C)`;
    button.dataset.camera = view.camera;
    button.append(icon(MAIN_VIEWS[view.camera]), element("span", "view-name", view.name));
    button.addEventListener("click", () => lookThrough(view));
    return button;
  }));
  const others = views.filter(({ camera }) => !(camera in MAIN_VIEWS));
  const title = new Option("More", "", true, true);
  title.disabled = true;
  byId("views-more").replaceChildren(title, ...others.map(({ camera, name }) => new Option(capitalised(name), camera)));
  byId("views-more").hidden = !others.length;
  byId("views").hidden = views.length < 2;
  const wanted = looking?.camera ?? recallView();
  looking = null;
  lookThrough(views.find(({ camera }) => camera === wanted) ?? views[0]);
}

function lookThrough(view) {
  if (!view || view === looking) return;
  const first = looking === null;
  looking = view;
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
  if (!first) {
    rememberView(view.camera);
    byId("seen").textContent = view.name;
  }
}

function nextView() {
  if (views.length) lookThrough(views[(views.indexOf(looking) + 1) % views.length]);
}

/** A browser may refuse to keep anything; the view is then not remembered. */
function rememberView(camera) {
  try {
    localStorage.setItem(REMEMBERED, camera);
  } catch {}
}

function recallView() {
  try {
    return localStorage.getItem(REMEMBERED);
  } catch {
    return null;
  }
}

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

view.addEventListener("click", (event) => {
  const { x, y } = placeOf(event);
  if (!shown || Math.min(x, y) < 0 || Math.max(x, y) > 1) return;
  send({ type: "point", ...shown, x, y });
});

function takeSeen({ name, x, y, at }) {
  window.cohabit.seen = name;
  const label = byId("seen");
  const [frame, box] = [view.parentElement.getBoundingClientRect(), view.getBoundingClientRect()];
  const scale = Math.min(box.width / view.width, box.height / view.height);
  const left = box.left - frame.left + (box.width - view.width * scale) / 2 + x * view.width * scale;
  const top = box.top - frame.top + (box.height - view.height * scale) / 2 + y * view.height * scale;
  label.textContent = capitalised(name);
  label.classList.add("placed");
  const half = label.offsetWidth / 2 + 6;
  label.style.left = `${Math.max(half, Math.min(frame.width - half, left))}px`;
  label.style.top = `${Math.max(40, top)}px`;
  clearTimeout(seenTimer);
  seenTimer = setTimeout(hideSeen, SEEN_MS);
  if (at) floor.pointOut({ x: at[0], y: at[1], name });
}

function hideSeen() {
  byId("seen").classList.remove("placed");
  byId("seen").textContent = "";
}

function showRate() {
  const now = performance.now();
  drawnAt = drawnAt.filter((at) => now - at < 2000);
  byId("fps").textContent = window.cohabit.frames ? `${Math.round(drawnAt.length / 2)} fps` : "";
}

// ---------------------------------------------------------------------------------------------- state and goals

let goalsShown = "";
let metBefore = null;
let endingShown = "running";

function takeState(state) {
  window.cohabit.state = state;
  byId("chat").removeAttribute("aria-busy");
  showScore(state.score);
  showRobot(state.robot);
  floor.follow(state.robot);
  floor.showOthers(state.others);
  floor.showNotes(state.notes);
  showGoals(state.goals);
  showEnding(state);
}

function showRobot(robot) {
  const room = robot?.room_name ?? "–";
  const holding = robot?.holding ?? "nothing";
  byId("room").textContent = capitalised(room);
  byId("holding").textContent = capitalised(holding);
  byId("holding").classList.toggle("none", !robot?.holding);
  byId("robot-line").textContent = robot ? `${room} · holds ${holding}` : "";
  document.body.classList.toggle("busy", Boolean(robot?.busy));
}

let score = null;
let scoreWanted = null;

function showScore(wanted) {
  if (wanted === scoreWanted) return;
  const from = score ?? wanted;
  const startedAt = performance.now();
  scoreWanted = wanted;
  const count = (now) => {
    if (scoreWanted !== wanted) return;
    const part = calm.matches ? 1 : Math.min((now - startedAt) / 350, 1);
    score = Math.round(from + (wanted - from) * part);
    byId("score").textContent = score.toLocaleString("en");
    if (part < 1) requestAnimationFrame(count);
  };
  count(startedAt);
}

function showGoals(goals) {
  const text = JSON.stringify(goals);
  if (text === goalsShown) return;
  goalsShown = text;
  const met = goals.filter((goal) => goal.met).length;
  byId("goals-list").replaceChildren(...goals.map((goal, index) => {
    const item = element("li", goal.met ? "met" : goal.hidden ? "hidden-goal" : "");
    if (goal.met && metBefore && !metBefore[index]) item.classList.add("just-met");
    const mark = drawn("svg", { viewBox: "0 0 20 20", "aria-hidden": "true" },
      drawn("circle", { cx: 10, cy: 10, r: 8.25 }),
      drawn("path", { d: "M6 10.4l2.8 2.8L14.2 7.4", pathLength: 100 }));
    item.append(mark, element("span", "", goal.text), element("span", "unseen", goal.met ? " (reached)" : " (open)"));
    return item;
  }));
  byId("goals-count").textContent = goals.length ? `${met}/${goals.length}` : "";
  byId("goals-ring").style.strokeDasharray = `${goals.length ? (met / goals.length) * 100 : 0} 100`;
  metBefore = goals.map((goal) => goal.met);
}

function showEnding({ ending, goals, score: points }) {
  if (ending === endingShown) return;
  endingShown = ending;
  const banner = byId("banner");
  banner.hidden = ending === "running";
  banner.classList.toggle("failed", ending === "failed");
  if (banner.hidden) return;
  const met = goals.filter((goal) => goal.met).length;
  byId("banner-title").textContent = ending === "complete" ? "Mission complete" : "Mission failed";
  const reached = goals.length === 1 ? "" : `${met} of ${goals.length} goals · `;
  byId("banner-text").textContent = `${reached}score ${points.toLocaleString("en")}`;
  byId("sparks").replaceChildren(...(ending === "complete" && !calm.matches ? sparks() : []));
  endDoing();
}

function sparks() {
  const colours = ["#63d4b5", "#f4d06f", "#8fb7ff", "#f2a7c3"];
  return Array.from({ length: 22 }, (_, index) => {
    const spark = element("i");
    spark.style.left = `${(index * 37 + 11) % 100}%`;
    spark.style.background = colours[index % colours.length];
    spark.style.animationDelay = `${(index * 0.13).toFixed(2)}s`;
    return spark;
  });
}

byId("banner-close").addEventListener("click", () => {
  byId("banner").hidden = true;
  input.focus();
});

function expandGoals(expanded) {
  byId("goals").classList.toggle("collapsed", !expanded);
  byId("goals-toggle").setAttribute("aria-expanded", String(expanded));
}

byId("goals-toggle").addEventListener("click", () => expandGoals(byId("goals").classList.contains("collapsed")));
narrow.addEventListener("change", () => expandGoals(!narrow.matches));

// ---------------------------------------------------------------------------------------------- the floor plan

/** Space round the plan, m. */
const MARGIN_M = 0.7;
/** How far from a wall's line an opening may lie to be in it, m. */
const ON_WALL_M = 0.25;
const LABEL_M = 1.14;
/** Width of a letter of a label as a part of its height. */
const LETTER = 0.56;
const LINE_M = 1.24;
/** How quickly the arrow nears the robot's pose: the time to come 63 % of the way. */
const SETTLE_MS = 90;
const HIGHLIGHT_MS = 4000;

/** Takes the stretches `gaps` out of the stretch from `start` to `end`. */
function without(start, end, gaps) {
  let rest = [[start, end]];
  for (const [from, to] of gaps) {
    rest = rest.flatMap(([a, b]) => [[a, Math.min(b, from)], [Math.max(a, to), b]].filter(([c, d]) => d - c > 1e-6));
  }
  return rest;
}

/** The walls of a room as an SVG path: its rectangles' edges less those inside the room, less its openings. */
function wallsOf({ rects }, openings) {
  const strokes = [];
  rects.forEach(([west, south, east, north], self) => {
    const others = rects.filter((_, index) => index !== self);
    for (const y of [south, north]) {
      const inside = others.filter(([, s, , n]) => s <= y && y <= n).map(([w, , e]) => [w, e]);
      for (const [a, b] of without(west, east, inside.concat(gapsIn("x", y, openings)))) strokes.push(`M${a} ${-y}H${b}`);
    }
    for (const x of [west, east]) {
      const inside = others.filter(([w, , e]) => w <= x && x <= e).map(([, s, , n]) => [s, n]);
      for (const [a, b] of without(south, north, inside.concat(gapsIn("y", x, openings)))) strokes.push(`M${x} ${-a}V${-b}`);
    }
  });
  return strokes.join("");
}

function gapsIn(along, at, openings) {
  const [run, line] = along === "x" ? ["x", "y"] : ["y", "x"];
  return openings
    .filter((opening) => opening.along === along && Math.abs(opening[line] - at) < ON_WALL_M)
    .map((opening) => [opening[run] - opening.width / 2, opening[run] + opening.width / 2]);
}

/** A room's name in its largest rectangle: broken into lines, or turned, where it is narrow. */
function labelOf({ id, name, rects }) {
  const area = ([w, s, e, n]) => (e - w) * (n - s);
  const [west, south, east, north] = rects.reduce((a, b) => (area(b) > area(a) ? b : a));
  const width = (text) => text.length * LETTER * LABEL_M;
  const words = capitalised(name).split(" ");
  const longest = Math.max(...words.map(width));
  const turned = longest > east - west - 0.5 && north - south > east - west;
  const room = (turned ? north - south : east - west) - 0.8;
  const lines = [];
  for (const word of words) {
    const together = lines.length ? `${lines.at(-1)} ${word}` : word;
    if (lines.length && width(together) <= room) lines[lines.length - 1] = together;
    else lines.push(word);
  }
  const [x, y] = [(west + east) / 2, -(south + north) / 2];
  const turn = turned ? ` rotate(-90)` : "";
  return drawn("text", { class: "map-label", "data-room": id, transform: `translate(${x} ${y})${turn}` },
    ...lines.map((line, index) => {
      const span = drawn("tspan", { x: 0, y: (index - (lines.length - 1) / 2) * LINE_M + LABEL_M * 0.35 });
      span.textContent = line;
      return span;
    }));
}

class Floor {
  constructor(svg) {
    this.svg = svg;
    this.rooms = new Map();
    this.pose = null;
    this.wanted = null;
    this.steppedAt = 0;
    this.moving = false;
    this.notesShown = "";
  }

  build({ rooms, openings, furniture }) {
    const rects = rooms.flatMap((room) => room.rects);
    const [west, south] = [0, 1].map((side) => Math.min(...rects.map((rect) => rect[side])) - MARGIN_M);
    const [east, north] = [2, 3].map((side) => Math.max(...rects.map((rect) => rect[side])) + MARGIN_M);
    this.svg.setAttribute("viewBox", `${west} ${-north} ${east - west} ${north - south}`);
    this.svg.style.aspectRatio = `${east - west} / ${north - south}`;
    this.rooms = new Map(rooms.map((room) => {
      const tiles = room.rects.map(([w, s, e, n]) => drawn("rect", { x: w, y: -n, width: e - w, height: n - s }));
      return [room.id, drawn("g", { class: "map-room", fill: room.floor }, ...tiles)];
    }));
    const outlines = furniture.map((corners) => `M${corners.map(([x, y]) => `${x} ${-y}`).join("L")}Z`);
    this.others = drawn("g", {});
    this.notes = drawn("g", {});
    this.notesShown = "";
    this.pulses = drawn("g", {});
    this.robot = drawn("g", { class: "map-robot", visibility: "hidden" },
      drawn("path", { class: "map-sight", d: "M0 0L4.1 -2.6A4.86 4.86 0 0 1 4.1 2.6Z" }),
      drawn("circle", { class: "map-halo", r: 1.05 }),
      drawn("path", { class: "map-arrow", d: "M.82 0L-.6 .62L-.3 0L-.6 -.62Z" }));
    this.svg.replaceChildren(
      ...this.rooms.values(),
      drawn("path", { class: "map-furniture", d: outlines.join("") }),
      drawn("path", { class: "map-walls", d: rooms.map((room) => wallsOf(room, openings)).join("") }),
      ...rooms.map(labelOf),
      this.notes, this.others, this.robot, this.pulses);
    this.pose = null;
  }

  follow(robot) {
    this.robot?.setAttribute("visibility", robot ? "visible" : "hidden");
    for (const [id, room] of this.rooms) room.classList.toggle("here", id === robot?.room);
    if (!robot) return;
    this.wanted = robot;
    if (!this.pose || calm.matches) {
      this.pose = { x: robot.x, y: robot.y, yaw: robot.yaw };
      this.place();
    } else if (!this.moving) {
      this.moving = true;
      this.steppedAt = performance.now();
      requestAnimationFrame((now) => this.step(now));
    }
  }

  step(now) {
    if (!this.pose) {
      this.moving = false;
      return;
    }
    const part = 1 - Math.exp(-Math.max(now - this.steppedAt, 0) / SETTLE_MS);
    this.steppedAt = now;
    const turn = this.wanted.yaw - this.pose.yaw;
    const left = [this.wanted.x - this.pose.x, this.wanted.y - this.pose.y, Math.atan2(Math.sin(turn), Math.cos(turn))];
    this.pose.x += left[0] * part;
    this.pose.y += left[1] * part;
    this.pose.yaw += left[2] * part;
    this.place();
    this.moving = Math.hypot(...left) > 0.005;
    if (this.moving) requestAnimationFrame((next) => this.step(next));
  }

  place() {
    const { x, y, yaw } = this.pose;
    this.robot.setAttribute("transform", `translate(${x} ${-y}) rotate(${(-yaw * 180) / Math.PI})`);
  }

  showOthers(others) {
    if (!this.others) return;
    while (this.others.childElementCount > others.length) this.others.lastElementChild.remove();
    others.forEach(({ kind, x, y, yaw }, index) => {
      let body = this.others.children[index];
      if (!body) {
        body = drawn("g", { class: `map-body map-${kind}` },
          drawn("circle", { class: "map-halo", r: 0.85 }),
          drawn("path", { class: "map-arrow", d: "M.66 0L-.48 .5L-.24 0L-.48 -.5Z" }));
        body.append(drawn("title", {}));
        body.lastElementChild.textContent = capitalised(kind);
        this.others.append(body);
      }
      body.setAttribute("transform", `translate(${x} ${-y}) rotate(${(-yaw * 180) / Math.PI})`);
    });
  }

  showNotes(notes) {
    const text = JSON.stringify(notes);
    if (!this.notes || text === this.notesShown) return;
    this.notesShown = text;
    this.notes.replaceChildren(...notes.map(({ x, y, read }) =>
      drawn("g", { class: read ? "map-note read" : "map-note", transform: `translate(${x} ${-y})` },
        drawn("rect", { x: -0.55, y: -0.55, width: 1.1, height: 1.1, rx: 0.14 }))));
  }

  pointOut({ x, y, name }) {
    if (!this.pulses) return;
    const label = drawn("text", { class: "map-name", y: -1.5 });
    label.textContent = name;
    const pulse = drawn("g", { class: "map-pulse", transform: `translate(${x} ${-y})` },
      drawn("circle", { r: 2.2 }), drawn("circle", { r: 2.2 }), drawn("circle", { r: 0.42 }), label);
    this.pulses.append(pulse);
    this.keepInside(label, x);
    setTimeout(() => pulse.remove(), HIGHLIGHT_MS);
  }

  /** Shifts a name sideways so that it stays on the plan. */
  keepInside(label, x) {
    const { x: west, width } = this.svg.viewBox.baseVal;
    const half = label.getBBox().width / 2 + 0.3;
    const fit = Math.max(west + half, Math.min(west + width - half, x));
    label.setAttribute("x", fit - x);
  }
}

const floor = new Floor(byId("map"));

function enlargeMap(enlarged) {
  document.body.classList.toggle("map-large", enlarged);
  byId("map-toggle").setAttribute("aria-expanded", String(enlarged));
  byId("map-toggle").setAttribute("aria-label", enlarged ? "Shrink the floor plan" : "Enlarge the floor plan");
}

byId("map-toggle").addEventListener("click", () => enlargeMap(!document.body.classList.contains("map-large")));

// ---------------------------------------------------------------------------------------------- the conversation

/** So near its end, the log follows what is said, px. */
const NEAR_END_PX = 60;
const NEW_GOAL = /^New goal:\s*/;

const log = byId("chat");
const input = byId("chat-input");
let lastFrom = "";
let unseenLines = false;

function clearChat() {
  log.setAttribute("aria-busy", "true");
  log.replaceChildren();
  lastFrom = "";
  byId("chips").hidden = false;
}

function takeLine(line) {
  const atEnd = log.scrollHeight - log.scrollTop - log.clientHeight < NEAR_END_PX;
  const replayed = log.hasAttribute("aria-busy");
  const bubble = lineOf(line);
  if (line.from === lastFrom) bubble.classList.add("follows");
  if (!replayed) bubble.classList.add("fresh");
  lastFrom = line.from;
  log.append(bubble);
  if (line.from !== "game") input.placeholder = line.kind === "question" ? "Answer the robot" : "Tell the robot what to do";
  if (line.from === "person") {
    remember(line.text);
    byId("chips").hidden = true;
  }
  if (atEnd || replayed || line.from === "person") toNewest();
  else {
    unseenLines = true;
    showToNewest();
  }
}

function lineOf({ from, kind, text }) {
  const bubble = element("div", `line from-${from} kind-${kind}`);
  const speaker = { person: "You: ", robot: "Robot: ", game: "" }[from] ?? "";
  if (speaker) bubble.append(element("span", "unseen", speaker));
  if (from === "game" && kind === "goal") {
    const added = NEW_GOAL.test(text);
    bubble.classList.toggle("new-goal", added);
    bubble.append(element("b", "line-label", added ? "New goal" : "✓ Goal reached"));
    text = text.replace(NEW_GOAL, "");
  } else if (from === "game" && kind === "note") {
    bubble.append(element("b", "line-label", "Sticky note"));
  } else if (from === "game" && kind === "ending") {
    bubble.classList.toggle("failed", /fail/i.test(text));
  }
  bubble.append(element("span", "line-text", text));
  return bubble;
}

function toNewest() {
  log.scrollTop = log.scrollHeight;
  unseenLines = false;
  showToNewest();
}

function showToNewest() {
  byId("to-newest").hidden = !unseenLines;
}

log.addEventListener("scroll", () => {
  if (log.scrollHeight - log.scrollTop - log.clientHeight < NEAR_END_PX) {
    unseenLines = false;
    showToNewest();
  }
}, { passive: true });
byId("to-newest").addEventListener("click", toNewest);
// The log loses height when the keyboard of a phone opens or the chips appear: its end stays in sight.
new ResizeObserver(() => {
  if (!unseenLines) log.scrollTop = log.scrollHeight;
}).observe(log);

/** More steps than these are not drawn one by one. */
const MOST_STEPS = 24;

let doingTurn = 0;

function takeProgress({ turn, step, steps, text }) {
  doingTurn = turn;
  const several = steps > 1;
  byId("doing").classList.remove("idle");
  byId("doing-text").textContent = capitalised(text);
  byId("doing-count").textContent = several ? `${step} of ${steps}` : "";
  const marks = Array.from({ length: several && steps <= MOST_STEPS ? steps : 0 }, (_, index) =>
    element("i", index + 1 < step ? "past" : index + 1 === step ? "now" : ""));
  byId("doing-steps").replaceChildren(...marks);
}

function takeTurn({ turn, ended }) {
  if (ended && turn >= doingTurn) endDoing();
}

function endDoing() {
  doingTurn = 0;
  byId("doing").classList.add("idle");
  const idle = { running: "Ready", complete: "All done", failed: "The mission is over" };
  byId("doing-text").textContent = document.body.classList.contains("lost") ? "Waiting for the session" : idle[endingShown];
  byId("doing-count").textContent = "";
  byId("doing-steps").replaceChildren();
}

function takeLatency(latency) {
  window.cohabit.latency = latency;
  const words = { understood: latency.understood_ms, moving: latency.moved_ms, seen: latency.shown_ms };
  const parts = Object.entries(words).filter(([, ms]) => typeof ms === "number");
  byId("latency").textContent = parts.map(([word, ms]) => `${word} ${inMilliseconds(ms)}`).join(" · ");
}

function inMilliseconds(ms) {
  return `${ms < 1 ? ms.toFixed(1) : Math.round(ms)} ms`;
}

// ---------------------------------------------------------------------------------------------- what a person types

const said = [];
let recalled = 0;
let draft = "";

function remember(text) {
  if (said.at(-1) !== text) said.push(text);
  recalled = said.length;
}

function say(text) {
  if (send({ type: "say", text })) {
    remember(text);
    return true;
  }
  toast("There is no connection at the moment; please try again in a while.");
  return false;
}

function recall(step) {
  const next = recalled + step;
  if (next < 0 || next > said.length) return;
  if (recalled === said.length) draft = input.value;
  recalled = next;
  input.value = next === said.length ? draft : said[next];
  input.setSelectionRange(input.value.length, input.value.length);
}

byId("composer").addEventListener("submit", (event) => {
  event.preventDefault();
  const text = input.value.trim();
  if (text && say(text)) {
    input.value = "";
    draft = "";
  }
  input.focus();
});

input.addEventListener("keydown", (event) => {
  if (event.isComposing || (event.key !== "ArrowUp" && event.key !== "ArrowDown")) return;
  event.preventDefault();
  recall(event.key === "ArrowUp" ? -1 : 1);
});

byId("chips").addEventListener("click", ({ target }) => {
  if (!(target instanceof HTMLButtonElement)) return;
  say(target.textContent);
  if (!narrow.matches) input.focus();
});
byId("stop").addEventListener("click", () => say("stop"));

/** Whatever has the focus: Escape stops the robot, Alt+C changes the view, and a letter or a slash begins a sentence. */
document.addEventListener("keydown", (event) => {
  if (event.altKey && event.code === "KeyC" && !event.ctrlKey && !event.metaKey) {
    event.preventDefault();
    nextView();
  }
  if (event.isComposing || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "Escape" && !event.repeat) {
    enlargeMap(false);
    say("stop");
  } else if (document.activeElement !== input && !(document.activeElement instanceof HTMLSelectElement) && /^[\p{L}\p{N}/]$/u.test(event.key)) {
    if (event.key === "/") event.preventDefault();
    input.focus();
  }
});

const TOAST_MS = 5000;

function toast(text) {
  const shown = element("p", "toast", text);
  byId("toasts").replaceChildren(shown);
  setTimeout(() => shown.remove(), TOAST_MS);
}

// ---------------------------------------------------------------------------------------------- the beginning

expandGoals(!narrow.matches);
setInterval(() => {
  showRate();
  watchSilence();
}, 500);
connect();
