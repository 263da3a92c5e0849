// The part of the page in which a mission is put together from forms.

import { byId, button, element } from "./dom.js";
import { text } from "./texts.js";

const WORDS = { goal: "say-goal", story: "say-story", beginning: "say-beginning", ending: "say-ending" };

/** The part, which edits by `edit`, asks by `ask` and offers what there is of `choices`. */
export function missionPart({ choices, edit, say, ask }) {
  let form = null;
  let layout = null;
  let faults = [];
  /** Forms that are not in the file yet, each with its row. */
  const drafts = { objects: new Map(), goals: new Map() };
  /** Rows of what is in the file, with what they show: who types in one goes on when others change. */
  const kept = { objects: [], goals: [] };

  const option = (value, words = value) => new Option(words, value);
  const meaningOf = (key) => choices.states.find((state) => state.key === key);
  const roomName = (id) => layout?.rooms.find((room) => room.id === id)?.name ?? id;

  function labelled(words, input) {
    return element("label", "field", element("span", "", words), input);
  }

  function input(value, listId) {
    const made = element("input", "");
    made.type = "text";
    made.value = value ?? "";
    if (listId) made.setAttribute("list", listId);
    return made;
  }

  function select(options, value) {
    const made = element("select", "");
    made.append(...options);
    // What the file has stays to be chosen, whatever the page knows.
    if (value && ![...made.options].some((one) => one.value === value)) made.append(option(value));
    made.value = value ?? "";
    return made;
  }

  // States of objects, as parts of forms: a key, and a value that follows from it.

  function valueField(key, value) {
    const values = meaningOf(key)?.values ?? [];
    return values.length ? select(values.map((one) => option(one)), value || values[0]) : input(value, "things");
  }

  function statePart(state, withObject, onRemove) {
    const [object, key, value] = state;
    const parts = [];
    const named = withObject ? input(object, "things") : null;
    if (named) parts.push(labelled(text("state_object"), named));
    const keys = select([option("", text("no_state")), ...choices.states.map((one) => option(one.key))], key);
    const meaning = element("p", "soft", meaningOf(key)?.meaning ?? "");
    const field = element("span", "", text("state_value"));
    const label = element("label", "field", field, valueField(key, value));
    keys.addEventListener("change", () => {
      label.replaceChildren(field, valueField(keys.value, ""));
      meaning.textContent = meaningOf(keys.value)?.meaning ?? "";
    });
    const gone = button("quiet", text("remove_state"), onRemove);
    const made = element("div", "", element("div", "parts", ...parts, labelled(text("state"), keys), label, gone), meaning);
    made.read = () => [named?.value.trim() ?? "", keys.value, label.lastElementChild.value.trim()];
    return made;
  }

  /** The states of a form, of which there may be more. */
  function stateList(states, withObject) {
    const list = element("div", "rows");
    const add = (state) => {
      const made = statePart(state, withObject, () => made.remove());
      list.append(made);
      return made;
    };
    states.forEach(add);
    const more = button("quiet", text("more_states"), () => add(["", "", ""]).querySelector("input, select").focus());
    return { list, more, read: () => [...list.children].map((one) => one.read()) };
  }

  /** What is wrong with a part of the file; a form that is none yet has no part. */
  function faultsAt(at) {
    return at ? faults.filter((fault) => fault.at?.startsWith(`${at}/`) || fault.at === at) : [];
  }

  // Objects and goals: each a form of its own, which is sent as a whole.

  function row(title, at, fields, deeds, onSubmit) {
    const heading = element("h3", "", title);
    const own = faultsAt(at);
    const problems = own.map(({ message, remedy }) => element("p", "problem", remedy ? `${message} – ${remedy}` : message));
    const made = element("form", own.some((fault) => !fault.is_warning) ? "row is-wrong" : "row", heading, ...fields, ...problems, element("div", "actions", ...deeds));
    made.dataset.at = at;
    made.setAttribute("aria-label", title);
    made.addEventListener("submit", (event) => {
      event.preventDefault();
      onSubmit();
    });
    return element("li", "", made);
  }

  function submitButton() {
    const made = element("button", "chief", text("apply"));
    made.type = "submit";
    return made;
  }

  function objectRow(object, index) {
    const isNew = index === null;
    const name = input(object.name, "things");
    name.required = true;
    const rooms = [option("", text("any_room")), ...(layout?.rooms ?? []).map(({ id, name: words }) => option(id, `${words} (${id})`))];
    const room = select(rooms, object.room);
    const on = input(object.on, "holders");
    const states = stateList(object.states.map(([key, value]) => ["", key, value]), false);
    const sent = () => ({
      name: name.value.trim(),
      room: room.value || null,
      on: on.value.trim() || null,
      states: states.read().map(([, key, value]) => [key, value]).filter(([key]) => key),
    });
    const fields = [
      element("div", "parts", labelled(text("object_name"), name), labelled(text("object_room"), room), labelled(text("object_on"), on)),
      states.list,
    ];
    const title = isNew ? text("new_object") : text("object", { name: object.name });
    const remove = button("danger", text("remove"), () => (isNew ? dropDraft("objects", object) : edit({ do: "remove_object", index })));
    return row(title, isNew ? "" : `/scene/required_objects/${index}`, fields, [states.more, submitButton(), remove], () => {
      if (!isNew) return edit({ do: "set_object", index, object: sent() });
      const own = sent();
      forget("objects", object);
      return edit({ do: "add_object", object: own }, text("added"));
    });
  }

  function goalRow(goal, index) {
    const isNew = index === null;
    const description = input(goal.description);
    const states = stateList(goal.states.length ? goal.states : [["", "", ""]], true);
    const any = element("input", "");
    any.type = "checkbox";
    any.checked = goal.any;
    const others = form.goals.filter((other, at) => at !== index && other.number !== null);
    const after = others.map(({ number, description: words }) => {
      const box = element("input", "");
      box.type = "checkbox";
      box.checked = (goal.after ?? []).includes(number);
      box.value = number;
      return element("label", "check-line", box, element("span", "", text("after", { goal: words || number })));
    });
    const sent = () => ({
      description: description.value.trim(),
      states: states.read(),
      any: any.checked,
      after: after.map((label) => label.firstElementChild).filter((box) => box.checked).map((box) => Number(box.value)),
    });
    const fields = [
      labelled(text("goal_description"), description),
      states.list,
      element("label", "check-line", any, element("span", "", text("any"))),
      ...after,
    ];
    const title = isNew ? text("new_goal") : text("goal", { name: goal.description || goal.number });
    const remove = button("danger", text("remove"), () => (isNew ? dropDraft("goals", goal) : edit({ do: "remove_goal", index })));
    return row(title, isNew ? "" : `/task_goals/${index}`, fields, [states.more, submitButton(), remove], () => {
      if (!isNew) return edit({ do: "set_goal", index, goal: sent() });
      const own = sent();
      forget("goals", goal);
      return edit({ do: "add_goal", goal: own }, text("added"));
    });
  }

  function forget(what, draft) {
    drafts[what].get(draft)?.remove();
    drafts[what].delete(draft);
  }

  function dropDraft(what, draft) {
    forget(what, draft);
    byId(`more-${what}`).focus();
  }

  /** A new form, which has the focus. */
  function begin(what, draft) {
    const made = what === "objects" ? objectRow(draft, null) : goalRow(draft, null);
    drafts[what].set(draft, made);
    byId(what).append(made);
    made.querySelector("input").focus();
  }

  function showRowsOf(what, at, make) {
    const list = byId(what);
    const focused = [...list.children].findIndex((row) => row.contains(document.activeElement));
    // What rows offer follows from all of it.
    const around = [layout?.rooms, form.goals.map(({ number, description }) => [number, description])];
    kept[what] = form[what].map((item, index) => {
      const mark = JSON.stringify([item, faultsAt(`${at}/${index}`), around]);
      const before = kept[what][index];
      return before?.mark === mark ? before : { mark, row: make(item, index) };
    });
    list.replaceChildren(...kept[what].map(({ row: made }) => made), ...drafts[what].values());
    if (focused >= 0 && !list.contains(document.activeElement)) list.children[focused]?.querySelector("input")?.focus();
  }

  function showRows() {
    showRowsOf("objects", "/scene/required_objects", objectRow);
    showRowsOf("goals", "/task_goals", goalRow);
  }

  function showLists() {
    const placed = (layout?.things ?? []).map(({ instance, name, room, holds }) => ({ value: instance, words: `${name ?? ""}, ${room}`, holds }));
    const own = form.objects.map(({ name, room }) => ({ value: name, words: roomName(room) ?? "", holds: true }));
    const classes = choices.classes.map(({ id, name }) => ({ value: id, words: name, holds: false }));
    byId("things").replaceChildren(...[...own, ...placed, ...classes].map(({ value, words }) => option(value, words)));
    byId("holders").replaceChildren(...[...own, ...placed].filter(({ holds }) => holds).map(({ value, words }) => option(value, words)));
  }

  function show(state) {
    ({ faults } = state);
    byId("mission-part").inert = !state.form;
    if (!state.form) return;
    ({ form, layout } = state);
    for (const [what, id] of Object.entries(WORDS)) {
      if (document.activeElement !== byId(id)) byId(id).value = form[what] ?? "";
    }
    for (const field of document.querySelectorAll("#mission-part > section > [data-at], #mission-part .add > [data-at]")) {
      const own = faults.filter((fault) => fault.at?.startsWith(field.dataset.at));
      field.lastElementChild.setAttribute("aria-invalid", String(own.length > 0));
    }
    byId("which-plan").replaceChildren(...select(choices.plans.map((id) => option(id)), form.plan).options);
    byId("which-plan").value = form.plan ?? "";
    byId("start").replaceChildren(...select((layout?.rooms ?? []).map(({ id, name }) => option(id, `${name} (${id})`)), form.start).options);
    byId("start").value = form.start ?? "";
    showLists();
    showRows();
  }

  async function tryIt() {
    byId("try").disabled = true;
    byId("steps").replaceChildren();
    byId("tried").textContent = text("trying");
    try {
      const { tried, why } = await ask("try", null);
      byId("tried").textContent = tried ? text("is_solved", { count: tried.steps.length, seconds: tried.seconds }) : text("is_not_solved", { why });
      byId("steps").replaceChildren(...(tried?.steps ?? []).map((step) => element("li", "", step)));
    } finally {
      byId("try").disabled = false;
    }
  }

  byId("mission-part").hidden = false;
  for (const [what, id] of Object.entries(WORDS)) {
    byId(id).addEventListener("change", () => edit({ do: "say", what, words: byId(id).value }));
  }
  byId("which-plan").addEventListener("change", () => edit({ do: "plan", id: byId("which-plan").value }));
  byId("start").addEventListener("change", () => edit({ do: "start", room: byId("start").value }));
  byId("more-objects").addEventListener("click", () => begin("objects", { name: "", room: null, on: null, states: [] }));
  byId("more-goals").addEventListener("click", () => begin("goals", { description: "", states: [], any: false, after: [], number: null }));
  byId("try").addEventListener("click", () => tryIt().catch((error) => {
    byId("tried").textContent = text("offline");
    console.warn(error);
  }));

  /** What of the forms something that is wrong is about. */
  const placeOf = (fault) => [...document.querySelectorAll("#mission-part [data-at]")]
    .filter((one) => one.dataset.at && fault.at?.startsWith(one.dataset.at))
    .sort((one, other) => other.dataset.at.length - one.dataset.at.length)[0];

  return {
    show,
    canPoint: (fault) => placeOf(fault) !== undefined,
    point: (fault) => {
      const place = placeOf(fault);
      place.querySelector("input, select, textarea")?.focus();
      say(fault.message);
    },
    /** Where the plan can be looked at from. */
    eyes: (state) => (state.layout?.views ?? []).map(({ room, number }) => (
      { value: `${room}.${number}`, words: text("eye_room", { room: roomName(room), number }) }
    )),
  };
}
