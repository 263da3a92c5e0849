// Voice: what a person says goes to the session as sound, what robots say comes back as sound, and all of it can be read.

import { byId, toast } from "./dom.js";
import { keepChoice, keptChoice, send, sendSound } from "./socket.js";
import { audio } from "./sound.js";
import { text as words } from "./texts.js";

const REMEMBERED = "cohabit-voice";
/** Sound goes to the session at this rate. */
const RATE = 16000;
const SPEECH_KIND = 2;
const SPEECH_HEADER_BYTES = 24;
/** A press that is shorter is a tap: then a pause ends what is said. */
const TAP_MS = 300;
/** A microphone that is not used for so long is let go. */
const IDLE_MS = 10_000;
/** What is said comes a little later than it could, so that no gap is heard, s. */
const LEAD_S = 0.05;
/** How long a notice about voice is shown. */
const NOTE_MS = 9000;

const input = byId("chat-input");
const mic = byId("mic");
const composer = byId("composer");

/** Off, or what listens: a key or button that is `held`, a `tap` until one sentence was said, or `open`. */
let mode = "off";
let stream = null;
let taking = null;
let pressedAt = 0;
let idleTimer = 0;
let noteTimer = 0;
/** What the session can do; nothing is known before it was asked. */
let engines = null;
/** What was heard and can be changed yet: its number, and when it is sent. */
let pending = null;
let settings = recall();
let isRecorded = false;

// ---------------------------------------------------------------------------------------------- what is shown

function show() {
  const isOn = mode !== "off";
  document.body.classList.toggle("listening", isOn);
  mic.setAttribute("aria-pressed", String(isOn));
  byId("open-mic").setAttribute("aria-pressed", String(mode === "open"));
  byId("hearing-text").dataset.waits = engines ? words("listening") : words("getting_ready");
  byId("aloud").setAttribute("aria-pressed", String(Boolean(settings.aloud)));
  byId("recorded").hidden = !isRecorded || !isOn;
  if (!isOn) showLevel(0);
  window.cohabit.voice = { ...window.cohabit.voice, mode, aloud: Boolean(settings.aloud), engines };
}

function showLevel(loudest) {
  // Loudness is heard by its logarithm: 50 dB below the loudest is silence.
  const level = loudest > 0 ? Math.max(0, 1 + (20 * Math.log10(loudest)) / 50) : 0;
  mic.style.setProperty("--level", level.toFixed(3));
  byId("level").style.setProperty("--level", level.toFixed(3));
}

function showHearing(text, kind = "") {
  byId("hearing").className = `hearing ${kind}`;
  byId("hearing-text").textContent = text;
  window.cohabit.voice = { ...window.cohabit.voice, hearing: text };
}

/** Says something about voice for a while, where what is heard is shown. */
function note(text) {
  showHearing(text, "note");
  clearTimeout(noteTimer);
  noteTimer = setTimeout(() => byId("hearing").classList.contains("note") && showHearing(""), NOTE_MS);
}

// ---------------------------------------------------------------------------------------------- the microphone

const CONSTRAINTS = { audio: { echoCancellation: true, noiseSuppression: true, autoGainControl: true, channelCount: 1 } };
const PROBLEMS = {
  NotAllowedError: words("microphone_forbidden"),
  NotFoundError: words("microphone_missing"),
  NotReadableError: words("microphone_busy"),
};

/** Takes the microphone, if nobody has; whether it is there. */
function takeMicrophone() {
  clearTimeout(idleTimer);
  taking ??= openMicrophone().catch((problem) => {
    taking = null;
    note(PROBLEMS[problem.name] ?? words("microphone_fails", { problem: problem.message }));
    return false;
  });
  return taking;
}

async function openMicrophone() {
  if (!navigator.mediaDevices?.getUserMedia || !window.AudioWorkletNode) {
    note(words("microphone_insecure"));
    taking = null;
    return false;
  }
  const opened = await navigator.mediaDevices.getUserMedia(CONSTRAINTS);
  const context = audio();
  await context.audioWorklet.addModule("/microphone.js");
  const source = context.createMediaStreamSource(opened);
  const node = new AudioWorkletNode(context, "microphone", { numberOfOutputs: 0 });
  node.port.onmessage = ({ data: { piece, loudest } }) => {
    if (mode === "off") return;
    showLevel(loudest);
    sendSound(piece);
  };
  source.connect(node);
  for (const track of opened.getAudioTracks()) track.addEventListener("ended", loseMicrophone);
  stream = { opened, source, node };
  return true;
}

/** The microphone was pulled out, or forbidden. */
export function loseMicrophone() {
  if (!stream) return;
  dropMicrophone();
  stopListening();
  note(words("microphone_gone"));
}

/** Lets the microphone go, so that the browser no longer shows it in use. */
function dropMicrophone() {
  for (const track of stream?.opened.getTracks() ?? []) {
    track.removeEventListener("ended", loseMicrophone);
    track.stop();
  }
  stream?.source.disconnect();
  stream?.node.port.close();
  stream = null;
  taking = null;
}

// ---------------------------------------------------------------------------------------------- listening

async function listen(wanted) {
  if (engines && !engines.hears) {
    tellLack();
    return;
  }
  mode = wanted;
  showHearing("");
  show();
  if (!(await takeMicrophone())) {
    stopListening();
    return;
  }
  if (settings.aloud === null) speakAloud(true);
  // The key may be up again, now that the browser has asked.
  if (mode === "off") letGo();
  else if (!send({ type: "listen", rate: RATE, held: mode === "held" })) stopListening();
}

/** Ends what is being said; the microphone stays for a moment, should more be said. */
export function stopListening() {
  if (mode === "off") return;
  mode = "off";
  send({ type: "listened" });
  clearHearing();
  show();
  letGo();
}

/** Nothing is heard any more; what people are to know of it stays. */
function clearHearing() {
  if (!byId("hearing").classList.contains("note")) showHearing("");
}

function letGo() {
  clearTimeout(idleTimer);
  idleTimer = setTimeout(() => mode === "off" && dropMicrophone(), IDLE_MS);
}

function press() {
  if (mode !== "off") return;
  forgetHeard();
  pressedAt = performance.now();
  listen("held");
}

function release() {
  if (mode !== "held") return;
  if (performance.now() - pressedAt < TAP_MS) {
    mode = "tap";
    send({ type: "listened" });
    show();
  } else {
    // What was said comes after: the session listens on until it has told it.
    mode = "off";
    send({ type: "listened" });
    show();
    letGo();
  }
}

/** What was heard so far is not said to its end, and may yet change. */
const unfinished = (text) => `${text.replace(/[\s.,;:!?…]+$/, "")}…`;

/** The session tells how far it has heard. */
export function takeHearing({ state, text, joins }) {
  // Who goes on with what can be changed yet has not said all of it.
  if (state === "began" && joins) holdHeard(true);
  else if (state === "nothing" && pending?.isHeld) waitToSend();
  else if (state === "stopped") forgetHeard();
  if (state === "partial") showHearing(unfinished(text), "partial");
  else if (state === "began") showHearing("…", "partial");
  else {
    if (state === "nothing" && mode === "tap") note(words("heard_nothing"));
    else clearHearing();
    if (mode === "tap") stopListening();
  }
}

/** What the session can hear and say. */
export function takeVoice(voice) {
  engines = voice;
  if (mode !== "off" && !voice.hears) {
    stopListening();
    dropMicrophone();
    tellLack();
  }
  show();
}

/** What is wrong, and for whom the machine is, what to do about it. */
function lack(what, remedy) {
  return document.body.classList.contains("no-figures") ? what : `${what} ${remedy}`;
}

function tellLack() {
  note(lack(words("cannot_hear"), words("cannot_hear_remedy")));
  byId("hearing").title = engines?.lacks.join("\n") ?? "";
}

/** The session listens no more: it has said why. */
export function takeDeaf() {
  mode = "off";
  show();
  showHearing("");
  letGo();
}

// ---------------------------------------------------------------------------------------------- what was heard

/** What was heard can be changed for a moment, then it is said. */
export function takeHeard({ number, text, edit_ms: editMs }) {
  if (mode === "tap") stopListening();
  settleHeard();
  showHearing("");
  // Who types something else is not interrupted.
  const isFree = input.value.trim() === "";
  pending = { number, text, isShown: isFree, isChanged: false, isHeld: false, goesOn: false, editMs, timer: 0 };
  waitToSend();
  if (!isFree) {
    showHearing(text, "partial");
    return;
  }
  input.value = text;
  input.setSelectionRange(text.length, text.length);
}

/** More was heard: what was before it is a part of it, or is said now; what somebody is changing stays as if it had been typed. */
function settleHeard() {
  if (!pending) return;
  if (pending.goesOn) forgetHeard(false);
  else if (pending.isChanged) endEditing();
  else sendHeard(pending.isShown ? input.value : pending.text, false);
}

/** What was heard is sent in a moment, unless somebody changes it or goes on. */
function waitToSend() {
  if (!pending) return;
  pending.goesOn = false;
  if (pending.isChanged) return;
  const { text, isShown, editMs } = pending;
  pending.isHeld = false;
  clearTimeout(pending.timer);
  pending.timer = setTimeout(() => sendHeard(isShown ? input.value : text, false), editMs);
  if (!isShown) return;
  composer.style.setProperty("--edit", `${editMs}ms`);
  composer.classList.add("editing");
}

/** What was heard waits until the rest of it was said, if somebody goes on, or until it was changed. */
function holdHeard(goesOn = false) {
  if (!pending) return;
  pending.isHeld = true;
  pending.goesOn ||= goesOn;
  clearTimeout(pending.timer);
  composer.classList.remove("editing");
}

/** Sends what was heard, as it reads now; `sure`, if somebody did that. Whether anything was sent. */
export function sendHeard(text, sure = true) {
  // What somebody types is something else, unless what was heard is shown there.
  if (!pending || (sure && !pending.isShown)) return false;
  const { number, isShown } = pending;
  endEditing();
  if (isShown) input.value = "";
  send({ type: "heard", number, text: text.trim() || null, sure });
  return true;
}

/** Forgets what was heard. */
export function forgetHeard(tells = true) {
  if (!pending) return;
  const { number, isShown } = pending;
  endEditing();
  if (isShown) input.value = "";
  if (tells) send({ type: "heard", number, text: null, sure: true });
}

/** The session that heard it is gone, and a new one knows nothing of it: what is shown stays as if it had been typed. */
export function keepHeard() {
  if (!pending) return;
  const { isShown } = pending;
  endEditing();
  if (isShown) return;
  showHearing("");
  toast(words("no_connection"));
}

function endEditing() {
  clearTimeout(pending.timer);
  pending = null;
  composer.classList.remove("editing");
}

// Who changes it has all the time.
input.addEventListener("input", () => {
  if (!pending?.isShown) return;
  pending.isChanged = true;
  holdHeard();
});

// ---------------------------------------------------------------------------------------------- what robots say

let playsUntil = 0;
let playing = new Set();
let hushed = 0;
let sounded = 0;

/** A piece of what a robot says. */
export function takeSpeech(buffer) {
  if (!settings.aloud || buffer.byteLength <= SPEECH_HEADER_BYTES) return;
  const header = new DataView(buffer, 0, SPEECH_HEADER_BYTES);
  const [rate, turn, saying] = [header.getUint32(4, true), Number(header.getBigUint64(8, true)), Number(header.getBigUint64(16, true))];
  const context = audio();
  if (header.getUint8(0) !== SPEECH_KIND || saying <= hushed || context.state !== "running") return;
  const samples = new Int16Array(buffer, SPEECH_HEADER_BYTES);
  const piece = new AudioBuffer({ length: samples.length, sampleRate: rate });
  const values = piece.getChannelData(0);
  for (let at = 0; at < samples.length; at += 1) values[at] = samples[at] / 32768;
  const source = new AudioBufferSourceNode(context, { buffer: piece });
  source.connect(context.destination);
  playsUntil = Math.max(playsUntil, context.currentTime + LEAD_S);
  source.start(playsUntil);
  playsUntil += piece.duration;
  playing.add(source);
  source.onended = () => playing.delete(source);
  tellSounded(turn);
  window.cohabit.voice = { ...window.cohabit.voice, spoken: (window.cohabit.voice?.spoken ?? 0) + samples.length / rate };
}

function tellSounded(turn) {
  if (!turn || turn === sounded) return;
  sounded = turn;
  send({ type: "sounded", turn });
}

/** Nothing more of what was being said is to be heard. */
export function takeHush({ saying }) {
  hushed = Math.max(hushed, saying);
  for (const source of playing) source.stop();
  playing.clear();
  playsUntil = 0;
  window.speechSynthesis?.cancel();
}

/** A robot said something: where the session has no voice, the browser's own says it. */
export function speakLine({ from, text, turn }) {
  if (!settings.aloud || from !== "robot" || engines?.speaks !== false || !window.speechSynthesis) return;
  const said = new SpeechSynthesisUtterance(text.replace(/["*_`]/g, " "));
  said.lang = "en";
  said.onstart = () => {
    send({ type: "own_voice", text });
    tellSounded(turn);
  };
  said.onend = () => send({ type: "own_voice", text: null });
  window.speechSynthesis.speak(said);
}

function speakAloud(on) {
  settings = { ...settings, aloud: on };
  keepChoice(REMEMBERED, settings);
  send({ type: "aloud", on });
  if (!on) takeHush({ saying: hushed });
  show();
}

/** A browser may refuse to keep anything; robots are then silent until somebody speaks to them. */
function recall() {
  const aloud = keptChoice(REMEMBERED)?.aloud;
  return { aloud: typeof aloud === "boolean" ? aloud : null };
}

// ---------------------------------------------------------------------------------------------- keys and buttons

/** A session has greeted this page. */
export function greetVoice(voice) {
  byId("voice-bar").hidden = !voice;
  for (const listens of [mic, byId("open-mic")]) listens.hidden = !voice?.has_microphone;
  isRecorded = Boolean(voice?.is_recorded);
  hushed = 0;
  engines = null;
  mode = "off";
  if (voice && settings.aloud) send({ type: "aloud", on: true });
  show();
}

/** Takes Alt+V, which is held to speak, wherever the focus is; whether it was that. */
export function takeVoiceKey(event) {
  if (!event.altKey || event.code !== "KeyV" || event.ctrlKey || event.metaKey || mic.hidden) return false;
  event.preventDefault();
  if (!event.repeat) press();
  return true;
}

document.addEventListener("keyup", ({ code, key }) => {
  if (code === "KeyV" || key === "Alt") release();
});
window.addEventListener("blur", release);
mic.addEventListener("pointerdown", (event) => {
  if (event.button !== 0) return;
  event.preventDefault();
  mic.setPointerCapture(event.pointerId);
  if (mode === "off") press();
  else stopListening();
});
for (const end of ["pointerup", "pointercancel"]) mic.addEventListener(end, release);
// A keyboard or a screen reader clicks without a pointer: that is a tap.
mic.addEventListener("click", ({ detail }) => {
  if (detail !== 0) return;
  if (mode === "off") listen("tap");
  else stopListening();
});
byId("open-mic").addEventListener("click", () => {
  if (mode === "open") stopListening();
  else {
    if (mode !== "off") stopListening();
    listen("open");
  }
});
byId("aloud").addEventListener("click", () => {
  audio();
  speakAloud(!settings.aloud);
  if (settings.aloud && engines?.speaks === false && !window.speechSynthesis?.getVoices().length) toast(lack(words("cannot_speak"), words("cannot_speak_remedy")));
});
