// The page of a session: shows what the robot sees, says and has yet to do, and sends what a person types and drives.
// It knows the messages of the service's socket and nothing of the world behind them.

import { byId, limitTexts, narrow, toast } from "./dom.js";
import { buildDriving, showHeld, takeActed, takeAim, takeDriving, takeKey, takeSeat } from "./driving.js";
import { meetFaces, takeExpression } from "./face.js";
import { enlargeMap, floor } from "./floor.js";
import { expandGoals, takeState } from "./goals.js";
import { isSpeech, keepWatch, takeViewKey } from "./page.js";
import { buildReplay, takePlayer, takeReplayKey, takeRewind } from "./replay.js";
import { greeted, listen } from "./socket.js";
import { askWhenDue, buildSurvey, noteAnswered, takeAnswered } from "./survey.js";
import { forgetSounds, hearState, takeSound } from "./sound.js";
import { language, text } from "./texts.js";
import { clearChat, endDoing, input, say, takeLatency, meet, takeLine, takeProgress, takeTurn, takeYou } from "./talk.js";
import { forgetHeard, greetVoice, keepHeard, loseMicrophone, speakLine, stopListening, takeDeaf, takeHeard, takeHearing, takeHush, takeSpeech, takeVoice, takeVoiceKey } from "./voice.js";
import { awaitFrame, buildViews, takeFrame, takeMarks, takeSeen } from "./view.js";

/** What tests and curious people may read. */
window.cohabit = { frames: 0, state: null, latency: null, view: null, seen: null, driving: null, aim: null, marks: [], sounds: [], voice: {}, loseMicrophone };

/** What a session's page may leave out, as for participants of a study. */
const PARTS = ["figures", "microphone", "score"];

function leaveOut(hidden = []) {
  for (const part of PARTS) document.body.classList.toggle(`no-${part}`, hidden.includes(part));
}

function takeHello({ session, mission, map, views, drivable, robots, questionnaires, replay, voice, hidden, longest_text: longestText }) {
  greeted();
  leaveOut(hidden);
  limitTexts(longestText);
  byId("session").textContent = replay ? text("recorded_name", { session }) : session;
  document.title = mission.title ? `${mission.title} · Cohabit` : "Cohabit";
  byId("goals-title").textContent = mission.title || text("mission");
  byId("goals-title").lang = mission.title ? "en" : language;
  byId("goals-about").textContent = mission.description === mission.title ? "" : mission.description;
  floor.build(map);
  buildViews(views);
  buildDriving(drivable);
  meet(robots);
  meetFaces(robots);
  clearChat();
  endDoing();
  forgetSounds();
  greetVoice(voice);
  buildReplay(replay);
  buildSurvey(questionnaires);
}

/** Whatever has the focus, if no body is driven: Escape stops the robot, Alt+C changes the view, and a letter or a slash begins a sentence. */
document.addEventListener("keydown", (event) => {
  takeViewKey(event);
  if (event.isComposing || document.querySelector("dialog[open]") || takeVoiceKey(event) || takeReplayKey(event) || takeKey(event) || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "Escape" && !event.repeat) {
    enlargeMap(false);
    forgetHeard();
    say("stop");
  } else if (document.activeElement !== input && !(document.activeElement instanceof HTMLSelectElement) && /^[\p{L}\p{N}/]$/u.test(event.key)) {
    if (event.key === "/") event.preventDefault();
    input.focus();
  }
});

expandGoals(!narrow.matches);
keepWatch();
listen({
  you: (you) => {
    takeYou(you);
    takeSeat(you.seat);
    noteAnswered(you.answered);
  },
  hello: takeHello,
  state: (state) => {
    takeState(state);
    takePlayer(state);
    askWhenDue(state);
    showHeld(state);
    hearState(state);
  },
  chat: (line) => {
    if (!byId("chat").hasAttribute("aria-busy")) speakLine(line);
    takeLine(line);
  },
  expression: takeExpression,
  progress: takeProgress,
  turn: takeTurn,
  latency: (latency) => {
    takeLatency(latency);
    awaitFrame(latency);
  },
  seen: takeSeen,
  marks: takeMarks,
  driving: takeDriving,
  aim: takeAim,
  acted: takeActed,
  answered: takeAnswered,
  rewind: (past) => {
    forgetSounds();
    takeRewind(past);
  },
  sound: takeSound,
  highlight: (message) => floor.pointOut(message),
  error: (message) => toast(message.text, "en"),
  voice: takeVoice,
  hearing: takeHearing,
  heard: takeHeard,
  hush: takeHush,
  deaf: takeDeaf,
  binary: (buffer) => (isSpeech(buffer) ? takeSpeech(buffer) : takeFrame(buffer)),
  lost: () => {
    keepHeard();
    stopListening();
    endDoing();
    takeDriving({ body: null, text: "" });
  },
});
