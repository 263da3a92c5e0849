// The part of the page in which a floor plan is drawn, by mouse or by keyboard alone.

import { byId, button, element } from "./dom.js";
import { draw, ghost, keyOf, nameOf, pointAt } from "./drawing.js";
import { text } from "./texts.js";

const LATTICE_M = 0.05;
const STEP_M = 0.05;
const FAR_STEP_M = 0.5;
const QUARTER_DEG = 90;
const SMALL_TURN_DEG = 15;
/** What is dragged less far stays where it is, m. */
const LEAST_DRAG_M = 0.03;
const WHOLE = "plan:";

const onLattice = (at) => Math.round(at / LATTICE_M) * LATTICE_M;
const rounded = (value) => Number(value.toFixed(3));
const box = ([x, y], [x2, y2]) => [[x, y], [x2, y], [x2, y2], [x, y2]];

/** The part, which edits by `edit` and offers what there is of `choices`. */
export function planPart({ choices, edit, say }) {
  const svg = byId("plan");
  let layout = null;
  let faults = [];
  let chosen = WHOLE;
  /** What the pointer is moving. */
  let drag = null;
  /** Of what the fields are. */
  let shownFor = null;

  const tool = () => document.querySelector("input[name=tool]:checked").value;
  const find = {
    room: (id) => layout.rooms.find((room) => room.id === id),
    opening: (index) => layout.openings[index],
    thing: (instance) => layout.things.find((thing) => thing.instance === instance),
    view: (room, number) => layout.views.find((view) => view.room === room && view.number === Number(number)),
    note: (index) => layout.notes[index],
  };

  function lookUp(key) {
    const [what, one, number] = key.split(":");
    return { what, one, item: find[what]?.(one, number) };
  }

  function choose(key, isSaid = true) {
    chosen = key;
    byId("items").value = key;
    redraw();
    showFields();
    if (isSaid && key !== WHOLE) say(nameOf(layout, key));
  }

  function redraw() {
    if (layout) draw(svg, layout, faults, chosen);
  }

  function allKeys() {
    return [
      ...layout.rooms.map(keyOf.room),
      ...layout.openings.map((_, index) => keyOf.opening(index)),
      ...layout.things.map(keyOf.thing),
      ...layout.views.map(keyOf.view),
      ...layout.notes.map((_, index) => keyOf.note(index)),
    ];
  }

  function show(state) {
    ({ faults } = state);
    const before = new Set(layout ? layout.things.map(keyOf.thing).concat(layout.rooms.map(keyOf.room)) : []);
    const isFirst = layout === null;
    layout = state.layout ?? layout;
    if (!layout) return;
    const keys = allKeys();
    // What was added just now is what is moved next.
    const added = isFirst ? undefined : keys.find((key) => /^(thing|room):/.test(key) && !before.has(key));
    if (added) chosen = added;
    if (chosen !== WHOLE && !keys.includes(chosen)) chosen = WHOLE;
    const options = [new Option(text("item_plan"), WHOLE), ...keys.map((key) => new Option(nameOf(layout, key), key))];
    byId("items").replaceChildren(...options);
    byId("items").value = chosen;
    redraw();
    showFields();
    showRooms();
  }

  /** Rooms that the plan does not have yet. */
  function showRooms() {
    const free = choices.rooms.filter(({ id }) => !find.room(id));
    const before = byId("new-room").value;
    byId("new-room").replaceChildren(...free.map(({ id, name }) => new Option(`${name} (${id})`, id)));
    if (free.some(({ id }) => id === before)) byId("new-room").value = before;
  }

  function showClasses() {
    const words = byId("search").value.toLowerCase().split(/\s+/).filter(Boolean);
    const isMeant = ({ id, name }) => words.every((word) => `${name} ${id}`.toLowerCase().includes(word));
    const options = choices.classes.filter(isMeant).map(({ id, name }) => new Option(`${name} (${id})`, id));
    byId("new-thing").replaceChildren(...options);
  }

  // What is chosen, in figures.

  const number = (id, words, value, step = "any") => ({ id, words, type: "number", value: rounded(value), step });

  function fieldsOf() {
    const { what, item } = lookUp(chosen);
    if (chosen === WHOLE) return [number("height", text("wall_height_m"), layout.wall_height_m)];
    if (!item) return [];
    if (what === "thing") {
      const [x, y, z] = item.world_m;
      const place = [number("east", text("east_m"), x), number("north", text("north_m"), y)];
      if (!item.on) place.push(number("up", text("up_m"), z));
      return [...place, number("yaw", text("yaw_deg"), item.yaw_deg)];
    }
    if (what === "opening") {
      const [x, y] = item.at_m;
      return [number("east", text("east_m"), x), number("north", text("north_m"), y), number("width", text("width_m"), item.width_m)];
    }
    if (what === "view") {
      const [x, y] = item.at_m;
      return [number("east", text("east_m"), x), number("north", text("north_m"), y), number("yaw", text("yaw_deg"), item.yaw_deg)];
    }
    if (what !== "room") return [];
    const sides = item.rects_m.length === 1 ? item.rects_m[0] : [];
    const names = [text("west_side_m"), text("south_side_m"), text("east_side_m"), text("north_side_m")];
    const surface = (id, words, color, finish) => [
      { id, words, type: "select", value: finish.material },
      { id: `${id}-color`, words: color, type: "color", value: finish.color },
    ];
    return [
      ...sides.map((at, side) => number(`side${side}`, names[side], at)),
      ...surface("floor", text("floor_material"), text("floor_color"), item.floor),
      ...surface("wall", text("wall_material"), text("wall_color"), item.wall),
    ];
  }

  function makeField({ id, words, type, value, step }) {
    let input;
    if (type === "select") {
      input = element("select", "");
      const materials = new Set([value, ...choices.materials]);
      input.append(...[...materials].map((one) => new Option(one, one)));
    } else {
      input = element("input", "");
      input.type = type;
      if (step) input.step = step;
    }
    input.id = `field-${id}`;
    input.value = value;
    return element("label", "field", element("span", "", words), input);
  }

  function showFields() {
    const specs = fieldsOf();
    const mark = [chosen, ...specs.map(({ id }) => id)].join(" ");
    if (shownFor === mark) {
      // Who is typing goes on with it.
      for (const { id, value } of specs) {
        const input = byId(`field-${id}`);
        if (document.activeElement !== input) input.value = value;
      }
      return;
    }
    shownFor = mark;
    const apply = element("button", "quiet", text("apply"));
    apply.type = "submit";
    byId("fields").replaceChildren(...specs.map(makeField), ...(specs.length ? [apply] : []));
    const { what } = lookUp(chosen);
    const deeds = [];
    if (what === "thing" || what === "view") deeds.push(button("quiet", text("turn"), () => turn(QUARTER_DEG)));
    if (chosen !== WHOLE) deeds.push(button("danger", text("remove"), remove));
    byId("deeds").replaceChildren(...deeds);
  }

  const valueOf = (id) => byId(`field-${id}`)?.value;
  const numberOf = (id) => Number(valueOf(id));

  function apply() {
    const { what, one, item } = lookUp(chosen);
    const at = [numberOf("east"), numberOf("north")];
    if (chosen === WHOLE) return edit({ do: "height", wall_height_m: numberOf("height") });
    if (what === "thing") return applyThing(item, at);
    if (what === "opening") return edit({ do: "set_opening", index: Number(one), at_m: at, width_m: numberOf("width") });
    if (what === "view") return edit({ do: "set_view", room: item.room, number: item.number, at_m: at, yaw_deg: numberOf("yaw") });
    return what === "room" ? applyRoom(item) : undefined;
  }

  function applyThing(thing, at) {
    const { instance, at_m } = thing;
    const yaw_deg = numberOf("yaw");
    if (!thing.on) return edit({ do: "set_thing", instance, at_m: [...at, numberOf("up")], yaw_deg });
    const isMoved = at.some((value, axis) => rounded(thing.world_m[axis]) !== value);
    if (yaw_deg !== rounded(thing.yaw_deg)) edit({ do: "set_thing", instance, at_m, yaw_deg });
    return isMoved ? edit({ do: "drop_thing", instance, at_m: at }) : undefined;
  }

  function applyRoom(room) {
    if (room.rects_m.length === 1) {
      const sides = [0, 1, 2, 3].map((side) => numberOf(`side${side}`));
      if (sides.some((at, side) => at !== rounded(room.rects_m[0][side]))) edit({ do: "set_room", room: room.id, rects_m: [sides] });
    }
    for (const surface of ["floor", "wall"]) {
      const [material, color] = [valueOf(surface), valueOf(`${surface}-color`)];
      if (material !== room[surface].material || color !== room[surface].color) {
        edit({ do: "finish", room: room.id, surface, material, color });
      }
    }
  }

  // What is done to what is chosen.

  function turn(by_deg) {
    const { what, item } = lookUp(chosen);
    if (!item) return;
    const yaw_deg = item.yaw_deg + by_deg;
    if (what === "thing") edit({ do: "set_thing", instance: item.instance, at_m: item.at_m, yaw_deg });
    if (what === "view") edit({ do: "set_view", room: item.room, number: item.number, at_m: item.at_m, yaw_deg });
  }

  function remove() {
    const { what, one, item } = lookUp(chosen);
    if (!item) return;
    const which = {
      room: { room: one },
      opening: { index: Number(one) },
      thing: { instance: one },
      view: { room: item.room, number: item.number },
      note: { index: Number(one) },
    }[what];
    const said = `${text("remove")}: ${nameOf(layout, chosen)}`;
    chosen = WHOLE;
    edit({ do: "remove", what, ...which }, said);
    svg.focus();
  }

  /** Moves what is chosen by the keyboard. */
  function nudge([x, y]) {
    const { what, item, one } = lookUp(chosen);
    if (!item) return;
    const [east, north] = (item.world_m ?? item.at_m ?? [0, 0]).map(rounded);
    const to = [rounded(east + x), rounded(north + y)];
    if (what === "thing" && item.on) edit({ do: "drop_thing", instance: item.instance, at_m: to });
    else if (what === "thing") edit({ do: "set_thing", instance: item.instance, at_m: [...to, item.at_m[2]], yaw_deg: item.yaw_deg });
    else if (what === "opening") edit({ do: "set_opening", index: Number(one), at_m: to, width_m: item.width_m });
    else if (what === "view") edit({ do: "set_view", room: item.room, number: item.number, at_m: to, yaw_deg: item.yaw_deg });
    // Rooms lie on a lattice of their own.
    else if (what === "room") edit({ do: "move_room", room: item.id, by_m: [Math.sign(x) * FAR_STEP_M, Math.sign(y) * FAR_STEP_M] });
    say(`${nameOf(layout, chosen)}: ${to.join(", ")}`);
  }

  const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

  function onKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const move = MOVES[event.key];
    if (move) nudge(move.map((way) => way * (event.shiftKey ? FAR_STEP_M : STEP_M)));
    else if (event.key.toLowerCase() === "r") turn(event.shiftKey ? SMALL_TURN_DEG : QUARTER_DEG);
    else if (event.key === "Delete" || event.key === "Backspace") remove();
    else return;
    event.preventDefault();
  }

  // The pointer.

  function onDown(event) {
    if (event.button !== 0 || !layout) return;
    const from = pointAt(svg, event);
    svg.focus({ preventScroll: true });
    if (tool() !== "select") {
      drag = { kind: "add", from, to: from };
    } else if (event.target.dataset.side !== undefined) {
      drag = { kind: "side", from, to: from, side: Number(event.target.dataset.side) };
    } else if (event.target.dataset.key) {
      choose(event.target.dataset.key);
      drag = { kind: "move", from, to: from };
    } else {
      choose(WHOLE);
      return;
    }
    svg.setPointerCapture(event.pointerId);
    event.preventDefault();
  }

  function cornersOf(by) {
    const { what, item } = lookUp(chosen);
    if (what === "thing") return item.corners_m?.map(([x, y]) => [x + by[0], y + by[1]]);
    if (what === "room") {
      const [west, south, east, north] = item.rects_m[0];
      return box([west + by[0], south + by[1]], [east + by[0], north + by[1]]);
    }
    const [x, y] = item.at_m;
    return box([x + by[0] - 0.15, y + by[1] - 0.15], [x + by[0] + 0.15, y + by[1] + 0.15]);
  }

  const movedBy = () => drag.to.map((at, axis) => onLattice(at - drag.from[axis]));

  function sides() {
    const { item } = lookUp(chosen);
    return item.rects_m[0].map((at, side) => (side === drag.side ? drag.to[side % 2] : at));
  }

  function onMove(event) {
    if (!drag) return;
    drag.to = pointAt(svg, event);
    if (drag.kind === "move") ghost(svg, cornersOf(movedBy()));
    else if (drag.kind === "side") ghost(svg, box(sides().slice(0, 2), sides().slice(2)));
    else if (tool() === "room") ghost(svg, box(drag.from, drag.to));
  }

  function onUp() {
    if (!drag) return;
    ghost(svg, null);
    const by = movedBy();
    const isMoved = Math.hypot(...by) >= LEAST_DRAG_M;
    if (drag.kind === "add") addAt(drag.from, drag.to);
    else if (drag.kind === "side") edit({ do: "set_room", room: lookUp(chosen).item.id, rects_m: [sides().map(rounded)] });
    else if (isMoved) drop(by);
    drag = null;
  }

  function drop(by) {
    const { what, one, item } = lookUp(chosen);
    const moved = (at) => at.slice(0, 2).map((value, axis) => rounded(value + by[axis]));
    if (what === "thing") edit({ do: "drop_thing", instance: one, at_m: moved(item.world_m) });
    else if (what === "room") edit({ do: "move_room", room: one, by_m: by });
    else if (what === "opening") edit({ do: "set_opening", index: Number(one), at_m: moved(item.at_m), width_m: item.width_m });
    else if (what === "view") edit({ do: "set_view", room: item.room, number: item.number, at_m: moved(item.at_m), yaw_deg: item.yaw_deg });
  }

  // What is added.

  function addAt(from, to) {
    const kind = tool();
    const at_m = from.map(rounded);
    if (kind === "room") {
      const room = byId("new-room").value;
      return edit({ do: "add_room", room, rect_m: [...at_m, ...to.map(rounded)] });
    }
    if (kind === "thing") return edit({ do: "add_thing", class: byId("new-thing").value, at_m });
    return edit({ do: "add_opening", kind, at_m });
  }

  function onTool() {
    const kind = tool();
    byId("add").hidden = kind === "select";
    for (const id of ["room-field", "x2-field", "y2-field"]) byId(id).hidden = kind !== "room";
    for (const id of ["search-field", "thing-field"]) byId(id).hidden = kind !== "thing";
    for (const id of ["x2", "y2"]) byId(id).required = kind === "room";
  }

  function onAdd(event) {
    event.preventDefault();
    const point = (x, y) => [Number(byId(x).value), Number(byId(y).value)];
    addAt(point("x", "y"), tool() === "room" ? point("x2", "y2") : point("x", "y"));
  }

  byId("plan-part").hidden = false;
  svg.addEventListener("keydown", onKey);
  svg.addEventListener("pointerdown", onDown);
  svg.addEventListener("pointermove", onMove);
  svg.addEventListener("pointerup", onUp);
  svg.addEventListener("pointercancel", () => { drag = null; ghost(svg, null); });
  byId("items").addEventListener("change", () => choose(byId("items").value, false));
  byId("fields").addEventListener("submit", (event) => { event.preventDefault(); apply(); });
  byId("add").addEventListener("submit", onAdd);
  byId("search").addEventListener("input", showClasses);
  for (const input of document.querySelectorAll("input[name=tool]")) input.addEventListener("change", onTool);
  showClasses();
  onTool();

  const keyOfFault = (fault) => {
    const thing = (fault.things ?? []).find((instance) => find.thing(instance));
    if (thing) return `thing:${thing}`;
    return fault.room && find.room(fault.room) ? `room:${fault.room}` : null;
  };

  return {
    show,
    canPoint: (fault) => Boolean(layout && keyOfFault(fault)),
    point: (fault) => {
      choose(keyOfFault(fault));
      svg.focus();
    },
    /** Where the plan can be looked at from. */
    eyes: (state) => {
      const views = state.layout?.views ?? [];
      const rooms = state.layout?.rooms ?? [];
      const name = (id) => rooms.find((room) => room.id === id)?.name ?? id;
      const own = views.map(({ room, number: which }) => ({ value: `${room}.${which}`, words: text("eye_room", { room: name(room), number: which }) }));
      const bare = rooms.filter(({ id }) => views.every(({ room }) => room !== id));
      return [...own, ...bare.map(({ id, name: words }) => ({ value: `${id}.0`, words }))];
    },
  };
}
