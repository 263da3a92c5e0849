// The robots' faces, as small as a word: what each shows, beside its name.

import { byId, capitalised, drawn, element } from "./dom.js";
import { text } from "./texts.js";

const MOUTHS = {
  neutral: "M7 13.2h6",
  happy: "M6 11.8q4 4.4 8 0",
  sorry: "M6 14.4q4 -4 8 0",
  confused: "M6 13.6l2.7 -1.6l2.6 1.6l2.7 -1.6",
  thinking: "M10.5 13.2h3.5",
};

const LOOKS = {
  happy: text("looks_happy"),
  sorry: text("looks_sorry"),
  confused: text("looks_confused"),
  thinking: text("looks_thinking"),
};

/** What people call the robots, by their bodies. */
let names = new Map();
/** What their faces show, by their bodies. */
const shown = new Map();

export function meetFaces(robots) {
  names = new Map(robots.map(({ body, name }) => [body, capitalised(name)]));
  shown.clear();
  for (const { body } of robots) shown.set(body, "neutral");
  showFaces();
}

export function takeExpression({ body, expression }) {
  if (!names.has(body) || shown.get(body) === expression) return;
  shown.set(body, expression);
  showFaces();
}

export function faceOf(expression) {
  return drawn("svg", { class: `face face-${expression}`, viewBox: "0 0 20 20", "aria-hidden": "true" },
    drawn("circle", { cx: 10, cy: 10, r: 8 }),
    drawn("path", { class: "eyes", d: "M7 7.6v1.2M13 7.6v1.2" }),
    drawn("path", { d: MOUTHS[expression] ?? MOUTHS.neutral }));
}

function showFaces() {
  byId("faces").replaceChildren(...[...shown].map(([body, expression]) => {
    const looks = LOOKS[expression] ?? "";
    const one = element("span", "face-of");
    one.append(faceOf(expression), element("b", "", names.get(body)), element("span", "", looks));
    return one;
  }));
}
