// What the world is like: the score, the robot's line, the goals, how it ended.

import { byId, calm, capitalised, drawn, element, narrow } from "./dom.js";
import { floor } from "./floor.js";
import { endDoing, input, offerRoom, robotNow } from "./talk.js";
import { language, text } from "./texts.js";

let goalsShown = "";
let metBefore = null;
let endingShown = "running";
let wereOpen = false;

export function takeState(state) {
  window.cohabit.state = state;
  byId("chat").removeAttribute("aria-busy");
  showScore(state.score);
  showRobot(state);
  floor.follow(state.robot);
  if (state.robot) offerRoom(floor.plan, state.robot.room);
  floor.showOthers(state.others);
  floor.showNotes(state.notes);
  showGoals(state.goals);
  showEnding(state);
}

/** Where the robot is that is spoken with, and what it holds; of several, which one it is. */
function showRobot({ robot, others }) {
  const named = robotNow();
  const shown = others?.find(({ body }) => body === named?.body) ?? robot;
  const room = shown?.room_name ?? "–";
  const holding = shown?.holding ?? text("holds_nothing");
  byId("room").textContent = named ? `${named.name}: ${room}` : capitalised(room);
  byId("holding").textContent = capitalised(holding);
  byId("holding").lang = shown?.holding ? "en" : language;
  byId("holding").classList.toggle("none", !shown?.holding);
  byId("robot-line").textContent = robot ? text("robot_line", { room, holding }) : "";
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
    byId("score").textContent = score.toLocaleString(language);
    if (part < 1) requestAnimationFrame(count);
  };
  count(startedAt);
}

function showGoals(goals) {
  const told = JSON.stringify(goals);
  if (told === goalsShown) return;
  goalsShown = told;
  const met = goals.filter((goal) => goal.met).length;
  byId("goals-list").replaceChildren(...goals.map((goal, index) => {
    const item = element("li", goal.met ? "met" : goal.hidden ? "hidden-goal" : "");
    if (goal.met && metBefore && !metBefore[index]) item.classList.add("just-met");
    const mark = drawn("svg", { viewBox: "0 0 20 20", "aria-hidden": "true" },
      drawn("circle", { cx: 10, cy: 10, r: 8.25 }),
      drawn("path", { d: "M6 10.4l2.8 2.8L14.2 7.4", pathLength: 100 }));
    const words = element("span", "", goal.text);
    words.lang = "en";
    item.append(mark, words, element("span", "unseen", goal.met ? text("goal_reached_mark") : text("goal_open_mark")));
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
  byId("banner-title").textContent = ending === "complete" ? text("mission_complete") : text("mission_failed");
  const reached = goals.length === 1 ? [] : [text("goals_met", { met, all: goals.length })];
  const scored = document.body.classList.contains("no-score") ? [] : [text("points", { points: points.toLocaleString(language) })];
  byId("banner-text").textContent = [...reached, ...scored].join(" · ");
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

export function expandGoals(expanded) {
  byId("goals").classList.toggle("collapsed", !expanded);
  byId("goals-toggle").setAttribute("aria-expanded", String(expanded));
}

/** Makes room for who drives, and opens the goals again if they were open before. */
export function collapseGoals(forWhile) {
  const { classList } = byId("goals");
  if (forWhile) wereOpen ||= !classList.contains("collapsed");
  expandGoals(!forWhile && wereOpen);
  if (!forWhile) wereOpen = false;
}

/** On a narrow page the goals stand above the conversation, where nothing covers them; else in the picture. */
function placeGoals() {
  if (narrow.matches) document.querySelector(".talk").before(byId("goals"));
  else byId("view").after(byId("goals"));
}

// What does not fit is scrolled by the keyboard, too, also if it has grown within a place that has not.
const body = byId("goals-body");
const fitting = new ResizeObserver(() => {
  if (body.scrollHeight > body.clientHeight) body.tabIndex = 0;
  else body.removeAttribute("tabindex");
});
for (const part of [body, ...body.children]) fitting.observe(part);
byId("goals-toggle").addEventListener("click", () => expandGoals(byId("goals").classList.contains("collapsed")));
narrow.addEventListener("change", () => {
  placeGoals();
  expandGoals(!narrow.matches);
});
placeGoals();
