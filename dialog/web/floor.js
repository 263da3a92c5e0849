// The floor plan: rooms, walls, furniture, and where everybody is.

import { byId, calm, capitalised, drawn } from "./dom.js";
import { text } from "./texts.js";

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
/** What bodies are called. */
const KINDS = { person: text("person"), robot: text("robot") };

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
  const width = (word) => word.length * LETTER * LABEL_M;
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
  const size = Math.min(1, room / Math.max(...lines.map(width)));
  return drawn("text", { class: "map-label", "data-room": id, transform: `translate(${x} ${y})${turn} scale(${size})` },
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
    this.plan = [];
  }

  build({ rooms, openings, furniture }) {
    this.plan = rooms;
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
        body.lastElementChild.textContent = KINDS[kind] ?? capitalised(kind);
        this.others.append(body);
      }
      body.setAttribute("transform", `translate(${x} ${-y}) rotate(${(-yaw * 180) / Math.PI})`);
    });
  }

  showNotes(notes) {
    const told = JSON.stringify(notes);
    if (!this.notes || told === this.notesShown) return;
    this.notesShown = told;
    this.notes.replaceChildren(...notes.map(({ x, y, read }) =>
      drawn("g", { class: read ? "map-note read" : "map-note", transform: `translate(${x} ${-y})` },
        drawn("rect", { x: -0.55, y: -0.55, width: 1.1, height: 1.1, rx: 0.14 }))));
  }

  /** Shows where a thing is; one with a number stays until the question it answers is past. */
  pointOut({ x, y, name, number }) {
    if (!this.pulses) return;
    if (number) this.mark(x, y, number);
    const label = drawn("text", { class: "map-name", y: -1.5 });
    label.textContent = name;
    const pulse = drawn("g", { class: "map-pulse", transform: `translate(${x} ${-y})` },
      drawn("circle", { r: 2.2 }), drawn("circle", { r: 2.2 }), drawn("circle", { r: 0.42 }), label);
    this.pulses.append(pulse);
    this.keepInside(label, x);
    setTimeout(() => pulse.remove(), HIGHLIGHT_MS);
  }

  mark(x, y, number) {
    for (const old of this.pulses.querySelectorAll(`.map-mark[data-number="${number}"]`)) old.remove();
    const label = drawn("text", { y: 0.42 });
    label.textContent = number;
    this.pulses.append(drawn("g", { class: "map-mark", "data-number": number, transform: `translate(${x} ${-y})` },
      drawn("circle", { r: 0.85 }), label));
  }

  forgetMarks() {
    for (const mark of this.pulses?.querySelectorAll(".map-mark") ?? []) mark.remove();
  }

  /** Shifts a name sideways so that it stays on the plan. */
  keepInside(label, x) {
    const { x: west, width } = this.svg.viewBox.baseVal;
    const half = label.getBBox().width / 2 + 0.3;
    const fit = Math.max(west + half, Math.min(west + width - half, x));
    label.setAttribute("x", fit - x);
  }
}

export const floor = new Floor(byId("map"));

export function enlargeMap(enlarged) {
  document.body.classList.toggle("map-large", enlarged);
  byId("map-toggle").setAttribute("aria-expanded", String(enlarged));
  byId("map-toggle").setAttribute("aria-label", enlarged ? text("plan_shrink") : text("plan_enlarge"));
}

byId("map-toggle").addEventListener("click", () => enlargeMap(!document.body.classList.contains("map-large")));
