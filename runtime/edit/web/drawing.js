// A floor plan as a drawing: metres, x to the right and y up.

import { text } from "./texts.js";

const NAMESPACE = "http://www.w3.org/2000/svg";
const MARGIN_M = 1;
/** Half of the mark of a viewpoint, m. */
const MARK_M = 0.14;

function shape(tag, attributes, ...children) {
  const made = document.createElementNS(NAMESPACE, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

const points = (corners) => corners.map(([x, y]) => `${x},${-y}`).join(" ");
const line = (attributes, [x1, y1], [x2, y2]) => shape("line", { ...attributes, x1, y1: -y1, x2, y2: -y2 });

/** The key by which something of a plan is chosen. */
export const keyOf = {
  room: (room) => `room:${room.id}`,
  opening: (index) => `opening:${index}`,
  thing: (thing) => `thing:${thing.instance}`,
  view: (view) => `view:${view.room}:${view.number}`,
  note: (index) => `note:${index}`,
};

function grid([west, south, east, north]) {
  const lines = [];
  for (let x = Math.ceil(west); x <= east; x += 1) lines.push(line({ class: "grid" }, [x, south], [x, north]));
  for (let y = Math.ceil(south); y <= north; y += 1) lines.push(line({ class: "grid" }, [west, y], [east, y]));
  return lines;
}

function drawRoom(room, mark) {
  const key = keyOf.room(room);
  const shapes = room.rects_m.map(([west, south, east, north]) => shape("rect", {
    class: mark("room", key), "data-key": key, x: west, y: -north, width: Math.max(0, east - west), height: Math.max(0, north - south), fill: room.floor.color,
  }));
  const [west, south, east, north] = room.rects_m[0] ?? [0, 0, 0, 0];
  shapes.push(shape("text", { x: (west + east) / 2, y: -(south + north) / 2, "font-size": 0.32 }, room.name));
  return shapes;
}

function drawOpening(opening, index, mark) {
  const half = opening.width_m / 2;
  const [x, y] = opening.at_m;
  const ends = opening.runs === "x" ? [[x - half, y], [x + half, y]] : [[x, y - half], [x, y + half]];
  const key = keyOf.opening(index);
  return line({ class: mark(`gap ${opening.kind}`, key), "data-key": key }, ...ends);
}

function drawThing(thing, mark) {
  if (!thing.corners_m) return [];
  const key = keyOf.thing(thing);
  const kind = thing.on ? "thing small" : "thing";
  const [one, , , two] = thing.corners_m;
  return [
    shape("polygon", { class: mark(kind, key), "data-key": key, points: points(thing.corners_m) }),
    line({ class: "front" }, one, two),
  ];
}

function drawView(view, mark) {
  const [x, y] = view.at_m;
  const yaw = (view.yaw_deg * Math.PI) / 180;
  const at = (turn, far) => [x + Math.cos(yaw + turn) * far, y + Math.sin(yaw + turn) * far];
  const key = keyOf.view(view);
  return shape("polygon", { class: mark("view", key), "data-key": key, points: points([at(0, 2 * MARK_M), at(2.5, MARK_M), at(-2.5, MARK_M)]) });
}

function drawCross([x, y]) {
  const far = 0.2;
  return [[[x - far, y - far], [x + far, y + far]], [[x - far, y + far], [x + far, y - far]]]
    .map(([from, to]) => line({ class: "cross" }, from, to));
}

/** The sides of a room of one rectangle, by which it is drawn larger: which side, and where its handle is. */
export function handlesOf(room) {
  if (room.rects_m.length !== 1) return [];
  const [west, south, east, north] = room.rects_m[0];
  const [x, y] = [(west + east) / 2, (south + north) / 2];
  return [{ side: 0, at: [west, y] }, { side: 1, at: [x, south] }, { side: 2, at: [east, y] }, { side: 3, at: [x, north] }];
}

/** Draws a plan into an `svg` anew. What is chosen, and what something is wrong with, is marked. */
export function draw(svg, layout, faults, chosen) {
  const [west, south, east, north] = layout.bounds_m;
  const bounds = [west - MARGIN_M, south - MARGIN_M, east + MARGIN_M, north + MARGIN_M];
  svg.setAttribute("viewBox", `${bounds[0]} ${-bounds[3]} ${bounds[2] - bounds[0]} ${bounds[3] - bounds[1]}`);
  const wrong = new Set();
  for (const fault of faults) {
    for (const instance of fault.things ?? []) wrong.add(`thing:${instance}`);
    if (fault.room && !fault.at_m) wrong.add(`room:${fault.room}`);
  }
  const mark = (kind, key) => `${kind}${wrong.has(key) ? " wrong" : ""}${key === chosen ? " chosen" : ""}`;
  const isHeld = (thing) => thing.on !== null;
  const byHeight = [...layout.things].sort((one, other) => one.world_m[2] - other.world_m[2]);
  const room = layout.rooms.find((one) => keyOf.room(one) === chosen);
  const handles = room ? handlesOf(room) : [];
  svg.replaceChildren(
    ...grid(bounds),
    ...layout.rooms.flatMap((one) => drawRoom(one, mark)),
    ...layout.openings.map((one, index) => drawOpening(one, index, mark)),
    ...byHeight.filter((thing) => !isHeld(thing)).flatMap((thing) => drawThing(thing, mark)),
    ...byHeight.filter(isHeld).flatMap((thing) => drawThing(thing, mark)),
    ...layout.views.map((view) => drawView(view, mark)),
    ...layout.notes.map((note, index) => shape("circle", {
      class: mark("note", keyOf.note(index)), "data-key": keyOf.note(index), cx: note.at_m[0], cy: -note.at_m[1], r: 0.09,
    })),
    ...faults.filter((fault) => fault.at_m).flatMap((fault) => drawCross(fault.at_m)),
    ...handles.map(({ side, at: [x, y] }) => shape("circle", { class: "handle", "data-side": side, cx: x, cy: -y, r: 0.16 })),
  );
}

/** The point of a plan at which a pointer is, m. */
export function pointAt(svg, event) {
  const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  return [x, -y];
}

/** Shows where something would be; nothing, without corners. */
export function ghost(svg, corners) {
  svg.querySelector(".ghost")?.remove();
  if (corners) svg.append(shape("polygon", { class: "ghost", points: points(corners) }));
}

/** What something of a plan is called. */
export function nameOf(layout, key) {
  const [what, one, number] = key.split(":");
  const room = (id) => layout.rooms.find((room) => room.id === id)?.name ?? id;
  if (what === "room") return text("item_room", { name: room(one) });
  if (what === "view") return text("item_view", { room: room(one), number });
  if (what === "note") return text("item_note", { room: room(layout.notes[one]?.room) });
  if (what === "opening") {
    const { kind, between } = layout.openings[one];
    const values = { one: room(between[0]), other: room(between[1]) };
    if (kind === "door") return text("item_door", values);
    return kind === "passage" ? text("item_passage", values) : text("item_window", values);
  }
  const thing = layout.things.find(({ instance }) => instance === one);
  const values = { name: thing.name ?? "", instance: one, room: room(thing.room), on: thing.on };
  return thing.on ? text("item_thing_on", values) : text("item_thing", values);
}
