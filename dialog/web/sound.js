// What can be heard of the world: made of tones and noise as it happens, and placed where it happens, as the body hears it
// whose eyes this page looks through.

import { byId } from "./dom.js";
import { text } from "./texts.js";

/** How loud, 0 to 1, and whether at all: remembered by the browser. */
const REMEMBERED = "cohabit-sound";
/** Sounds of one kind from one place come no faster than this, ms. */
const AGAIN_MS = 90;
/** More than these are not played at once. */
const MOST_AT_ONCE = 24;
/** As loud as it is made at this distance, and half as loud at twice of it, m. */
const NEAR_M = 1.6;
/** Way from one step to the next, m; and what is too far to have been walked between two states. */
const STRIDE_M = 0.62;
const LEAP_M = 1.5;
/** Ears are so high above the floor, m. */
const EARS_M = 1.4;
/** Sounds that tests and curious people may read. */
const TOLD = 60;

/**
 * Of what each sound is made, layer by layer: what swings (`noise`, or the shape of a wave), from which to which pitch (of
 * noise, of the band that passes), how wide that band is, when it begins and how long it lasts (s), how loud it is, how
 * long it rises (s), and how often it comes and how far apart.
 */
const RECIPES = {
  step: [{ of: "noise", hz: [240, 90], wide: 0.9, lasts: 0.09, loud: 0.55 }, { of: "sine", hz: [95, 50], lasts: 0.07, loud: 0.3 }],
  roll: [{ of: "noise", hz: [420, 340], wide: 3, lasts: 0.16, loud: 0.1, rises: 0.05 }, { of: "triangle", hz: [118, 112], lasts: 0.16, loud: 0.09, rises: 0.05 }],
  door_open: [{ of: "noise", hz: [1900, 1300], wide: 4, lasts: 0.05, loud: 0.5 }, { of: "sawtooth", hz: [210, 330], band: 900, lasts: 0.5, loud: 0.06, at: 0.05, rises: 0.12 }, { of: "noise", hz: [500, 900], wide: 1.2, lasts: 0.5, loud: 0.16, at: 0.05, rises: 0.2 }],
  door_close: [{ of: "noise", hz: [800, 400], wide: 1.2, lasts: 0.3, loud: 0.14, rises: 0.2 }, { of: "sine", hz: [120, 52], lasts: 0.22, loud: 0.9, at: 0.28 }, { of: "noise", hz: [1400, 500], wide: 1, lasts: 0.09, loud: 0.6, at: 0.28 }],
  drawer_open: [{ of: "noise", hz: [1100, 2100], wide: 1.6, lasts: 0.42, loud: 0.3, rises: 0.1 }, { of: "noise", hz: [700, 500], wide: 2, lasts: 0.06, loud: 0.55, at: 0.4 }],
  drawer_close: [{ of: "noise", hz: [2000, 900], wide: 1.6, lasts: 0.32, loud: 0.28, rises: 0.05 }, { of: "sine", hz: [180, 80], lasts: 0.12, loud: 0.7, at: 0.3 }, { of: "noise", hz: [900, 500], wide: 1, lasts: 0.06, loud: 0.5, at: 0.3 }],
  fridge_open: [{ of: "noise", hz: [300, 1500], wide: 1, lasts: 0.14, loud: 0.55 }, { of: "sine", hz: [58, 60], lasts: 1.1, loud: 0.18, at: 0.1, rises: 0.3 }, { of: "noise", hz: [2600, 3200], wide: 6, lasts: 0.5, loud: 0.07, at: 0.1, rises: 0.2 }],
  fridge_close: [{ of: "sine", hz: [105, 48], lasts: 0.2, loud: 0.9 }, { of: "noise", hz: [700, 260], wide: 0.9, lasts: 0.16, loud: 0.5 }],
  click: [{ of: "noise", hz: [3200, 2400], wide: 3, lasts: 0.025, loud: 0.7 }, { of: "square", hz: [1500, 900], lasts: 0.02, loud: 0.12 }, { of: "noise", hz: [1900, 1500], wide: 3, lasts: 0.02, loud: 0.35, at: 0.06 }],
  microwave: [{ of: "sawtooth", hz: [100, 100], band: 420, lasts: 2.6, loud: 0.22, rises: 0.25 }, { of: "noise", hz: [700, 720], wide: 2, lasts: 2.6, loud: 0.16, rises: 0.3 }, { of: "sine", hz: [1976, 1976], lasts: 0.28, loud: 0.3, at: 2.75, times: 3, apart: 0.42 }],
  coffee: [{ of: "noise", hz: [420, 640], wide: 1.4, lasts: 2.4, loud: 0.3, rises: 0.6 }, { of: "sine", hz: [170, 260], lasts: 0.13, loud: 0.22, at: 0.3, times: 11, apart: 0.19 }, { of: "noise", hz: [4200, 5200], wide: 2, lasts: 0.8, loud: 0.1, at: 1.9, rises: 0.3 }],
  toaster: [{ of: "noise", hz: [1200, 800], wide: 2, lasts: 0.06, loud: 0.6 }, { of: "sine", hz: [120, 120], lasts: 1.4, loud: 0.07, at: 0.1, rises: 0.2 }, { of: "triangle", hz: [620, 900], lasts: 0.16, loud: 0.4, at: 1.55 }, { of: "noise", hz: [2600, 1400], wide: 2, lasts: 0.05, loud: 0.6, at: 1.55 }],
  printer: [{ of: "square", hz: [260, 300], band: 1200, lasts: 0.16, loud: 0.1, times: 8, apart: 0.27 }, { of: "noise", hz: [1700, 2100], wide: 4, lasts: 0.13, loud: 0.16, at: 0.14, times: 8, apart: 0.27 }],
  time_machine: [{ of: "sine", hz: [90, 760], lasts: 2.4, loud: 0.3, rises: 0.5 }, { of: "triangle", hz: [1500, 180], lasts: 2.4, loud: 0.13, rises: 0.8 }, { of: "noise", hz: [240, 3600], wide: 1.6, lasts: 2.4, loud: 0.2, rises: 1.4 }, { of: "sine", hz: [66, 40], lasts: 0.5, loud: 0.7, at: 2.35 }],
  robot_arm: [{ of: "sawtooth", hz: [180, 420], band: 1400, lasts: 0.7, loud: 0.12, rises: 0.1 }, { of: "sawtooth", hz: [420, 150], band: 1400, lasts: 0.7, loud: 0.12, at: 0.8, rises: 0.1 }],
  vending: [{ of: "sawtooth", hz: [85, 80], band: 500, lasts: 1, loud: 0.16, rises: 0.1 }, { of: "noise", hz: [900, 240], wide: 0.9, lasts: 0.22, loud: 0.9, at: 1.1, times: 2, apart: 0.16 }],
  machine: [{ of: "sawtooth", hz: [70, 140], band: 600, lasts: 1.5, loud: 0.2, rises: 0.3 }, { of: "noise", hz: [600, 1100], wide: 1.4, lasts: 1.5, loud: 0.16, rises: 0.4 }],
  laser: [{ of: "sawtooth", hz: [1900, 260], band: 3200, lasts: 0.5, loud: 0.3 }, { of: "square", hz: [950, 130], band: 2600, lasts: 0.5, loud: 0.14 }, { of: "noise", hz: [5200, 1800], wide: 2, lasts: 0.65, loud: 0.16, at: 0.05 }],
  freeze_ray: [{ of: "sine", hz: [520, 1900], lasts: 0.9, loud: 0.22, rises: 0.2 }, { of: "noise", hz: [6500, 3200], wide: 1.4, lasts: 1.3, loud: 0.28, rises: 0.15 }, { of: "sine", hz: [2637, 2637], lasts: 0.3, loud: 0.1, at: 0.85 }, { of: "sine", hz: [3520, 3520], lasts: 0.4, loud: 0.08, at: 1 }, { of: "sine", hz: [4699, 4699], lasts: 0.5, loud: 0.06, at: 1.15 }],
  pour: [{ of: "noise", hz: [900, 1700], wide: 2.2, lasts: 1, loud: 0.26, rises: 0.15 }, { of: "sine", hz: [420, 760], lasts: 0.08, loud: 0.16, at: 0.1, times: 9, apart: 0.1 }],
  break: [{ of: "noise", hz: [5200, 2600], wide: 0.8, lasts: 0.35, loud: 0.95 }, { of: "sine", hz: [3136, 3000], lasts: 0.22, loud: 0.2, at: 0.03 }, { of: "sine", hz: [4435, 4300], lasts: 0.18, loud: 0.16, at: 0.09, times: 4, apart: 0.075 }, { of: "sine", hz: [150, 70], lasts: 0.12, loud: 0.5 }],
  alarm: [{ of: "square", hz: [880, 880], band: 2600, lasts: 0.3, loud: 0.26, times: 4, apart: 0.7 }, { of: "square", hz: [660, 660], band: 2600, lasts: 0.3, loud: 0.26, at: 0.34, times: 4, apart: 0.7 }],
  spark: [{ of: "noise", hz: [6000, 900], wide: 0.7, lasts: 0.05, loud: 0.9, times: 6, apart: 0.07 }, { of: "sawtooth", hz: [120, 60], band: 2400, lasts: 0.5, loud: 0.4 }],
  goal: [{ of: "sine", hz: [784, 784], lasts: 0.5, loud: 0.22 }, { of: "sine", hz: [1047, 1047], lasts: 0.55, loud: 0.22, at: 0.11 }, { of: "sine", hz: [1319, 1319], lasts: 0.9, loud: 0.22, at: 0.22 }, { of: "triangle", hz: [2638, 2638], lasts: 0.5, loud: 0.04, at: 0.22 }],
  complete: [523, 659, 784, 1047, 1319].map((hz, index) => ({ of: "triangle", hz: [hz, hz], lasts: 1.3 - index * 0.1, loud: 0.2, at: index * 0.13 })),
  failed: [{ of: "triangle", hz: [392, 370], lasts: 0.5, loud: 0.26 }, { of: "triangle", hz: [294, 262], lasts: 1.1, loud: 0.26, at: 0.4 }],
};

/** Which of them it is, by what is heard and what the class of the thing is called, the first that fits. */
const KINDS = {
  open: [[/^Fridge/, "fridge_open"], [/Drawer|PaperTray|Box|Bin|Trash/i, "drawer_open"], [/./, "door_open"]],
  close: [[/^Fridge/, "fridge_close"], [/Drawer|PaperTray|Box|Bin|Trash/i, "drawer_close"], [/./, "door_close"]],
  machine: [
    [/^Microwave/, "microwave"], [/^Coffee|^WaterCooler/, "coffee"], [/^Toaster/, "toaster"], [/^Printer/, "printer"],
    [/^Yesterday|^Portal|^Embig|^Gravity/, "time_machine"], [/^RoboticArm|^ForkLift/, "robot_arm"], [/^Vending/, "vending"], [/./, "machine"],
  ],
  ray: [[/Freeze/, "freeze_ray"], [/./, "laser"]],
  click: [[/./, "click"]],
  break: [[/./, "break"]],
  pour: [[/./, "pour"]],
  alarm: [[/./, "alarm"]],
  spark: [[/./, "spark"]],
};

let context = null;
let master = null;
let noise = null;
let playing = 0;
/** Where the ears are: m on the floor, and the heading, rad. */
let ears = { x: 0, y: 0, yaw: 0 };
let earsOf = 0;
const lastPlayed = new Map();
const walked = new Map();
let metBefore = null;
let endingBefore = null;
let settings = recall();

// ---------------------------------------------------------------------------------------------- what is heard

/** Something can be heard at a place, m. */
export function takeSound({ kind, of, x, y, z }) {
  const found = KINDS[kind]?.find(([pattern]) => pattern.test(of));
  if (found) play(found[1], { x, y, z });
}

/** Where everybody is now: steps, whose ears these are, and what was reached. */
export function hearState(state) {
  const bodies = state.robot ? [{ kind: "robot", ...state.robot }, ...state.others] : state.others;
  moveEars(bodies.find(({ body }) => body === earsOf) ?? bodies[0]);
  for (const body of bodies) hearSteps(body);
  const met = state.goals.map((goal) => goal.met);
  if (metBefore && met.some((one, index) => one && metBefore[index] === false)) play("goal");
  metBefore = met;
  if (endingBefore === "running" && state.ending !== "running") play(state.ending === "complete" ? "complete" : "failed");
  endingBefore = state.ending;
}

/** Another session, or another time of it: what was before is no news. */
export function forgetSounds() {
  walked.clear();
  metBefore = null;
  endingBefore = null;
}

/** The page looks through the camera of a body, or of none, and hears as that does. */
export function hearThrough(camera) {
  const [, body] = /^[a-z]+\/(\d+)$/.exec(camera ?? "") ?? [];
  earsOf = body === undefined ? 0 : Number(body);
}

function hearSteps({ body, kind, x, y }) {
  const before = walked.get(body);
  walked.set(body, { x, y, way: before?.way ?? 0 });
  if (!before) return;
  const moved = Math.hypot(x - before.x, y - before.y);
  if (moved === 0 || moved > LEAP_M) return;
  const now = walked.get(body);
  now.way += moved;
  if (now.way < STRIDE_M) return;
  now.way %= STRIDE_M;
  play(kind === "person" ? "step" : "roll", { x, y, z: 0 }, `${body}`);
}

function moveEars(body) {
  if (!body) return;
  ears = { x: body.x, y: body.y, yaw: body.yaw };
  if (!context) return;
  const { listener } = context;
  const place = { positionX: ears.x, positionY: EARS_M, positionZ: -ears.y,
    forwardX: Math.cos(ears.yaw), forwardY: 0, forwardZ: -Math.sin(ears.yaw), upX: 0, upY: 1, upZ: 0 };
  if (listener.positionX) {
    for (const [axis, value] of Object.entries(place)) listener[axis].setTargetAtTime(value, context.currentTime, 0.03);
  } else {
    listener.setPosition(place.positionX, place.positionY, place.positionZ);
    listener.setOrientation(place.forwardX, 0, place.forwardZ, 0, 1, 0);
  }
}

// ---------------------------------------------------------------------------------------------- making it

/** Plays a sound of `RECIPES`, at a place if it has one. */
function play(name, at = null, from = "") {
  const now = performance.now();
  const key = `${name} ${from || (at ? `${at.x.toFixed(1)} ${at.y.toFixed(1)}` : "")}`;
  if (now - (lastPlayed.get(key) ?? -AGAIN_MS) < AGAIN_MS) return;
  lastPlayed.set(key, now);
  tell(name, at);
  if (settings.muted || settings.volume === 0 || context?.state !== "running" || playing >= MOST_AT_ONCE) return;
  const out = at ? placed(at) : master;
  const ends = Math.max(...RECIPES[name].map((layer) => lay(layer, out)));
  if (!at) return;
  playing += 1;
  setTimeout(() => {
    playing -= 1;
    out.disconnect();
  }, (ends - context.currentTime) * 1000 + 200);
}

function placed({ x, y, z }) {
  const panner = new PannerNode(context, { panningModel: "HRTF", distanceModel: "inverse", refDistance: NEAR_M, rolloffFactor: 1.3,
    positionX: x, positionY: Math.max(z, 0), positionZ: -y });
  panner.connect(master);
  return panner;
}

/** Plays one layer as often as it comes; gives when it ends. */
function lay({ of, hz, wide = 1, band, at = 0, lasts, loud, rises = 0.004, times = 1, apart = 0 }, out) {
  let ends = 0;
  for (let nth = 0; nth < times; nth += 1) {
    const begins = context.currentTime + 0.01 + at + nth * apart;
    ends = begins + lasts;
    const volume = new GainNode(context, { gain: 0 });
    volume.gain.setValueAtTime(0, begins);
    volume.gain.linearRampToValueAtTime(loud, begins + Math.min(rises, lasts / 2));
    volume.gain.exponentialRampToValueAtTime(0.0008, ends);
    const source = of === "noise" ? new AudioBufferSourceNode(context, { buffer: noise, loop: true }) : new OscillatorNode(context, { type: of, frequency: hz[0] });
    const filter = of === "noise" ? new BiquadFilterNode(context, { type: "bandpass", frequency: hz[0], Q: wide })
      : band ? new BiquadFilterNode(context, { type: "lowpass", frequency: band }) : null;
    const pitch = of === "noise" ? filter.frequency : source.frequency;
    pitch.setValueAtTime(hz[0], begins);
    pitch.exponentialRampToValueAtTime(hz[1], ends);
    (filter ? source.connect(filter) : source).connect(volume).connect(out);
    source.start(begins, of === "noise" ? Math.random() : undefined);
    source.stop(ends + 0.02);
    source.onended = () => volume.disconnect();
  }
  return ends;
}

/** What was played, and where as the ears have it: to the left and ahead, m. */
function tell(name, at) {
  const [east, north] = at ? [at.x - ears.x, at.y - ears.y] : [0, 0];
  const [cos, sin] = [Math.cos(ears.yaw), Math.sin(ears.yaw)];
  const told = (window.cohabit.sounds ??= []);
  told.push({ name, ahead: east * cos + north * sin, left: north * cos - east * sin });
  if (told.length > TOLD) told.shift();
}

/** The page's one audio context; browsers let it run once somebody has clicked or typed. */
export function audio() {
  if (!context) {
    context = new AudioContext({ latencyHint: "interactive" });
    const limiter = new DynamicsCompressorNode(context, { threshold: -14, ratio: 8 });
    master = new GainNode(context, { gain: 0 });
    master.connect(limiter).connect(context.destination);
    noise = new AudioBuffer({ length: context.sampleRate * 2, sampleRate: context.sampleRate });
    const samples = noise.getChannelData(0);
    for (let at = 0; at < samples.length; at += 1) samples[at] = Math.random() * 2 - 1;
    setVolume();
  }
  if (context.state === "suspended") context.resume();
  return context;
}

// ---------------------------------------------------------------------------------------------- how loud

/** A browser may refuse to keep anything; it is then as loud as it is at first. */
function recall() {
  try {
    const kept = JSON.parse(localStorage.getItem(REMEMBERED));
    if (Number.isFinite(kept?.volume)) return { volume: Math.max(0, Math.min(1, kept.volume)), muted: Boolean(kept.muted) };
  } catch {}
  return { volume: 0.6, muted: false };
}

function change(to) {
  settings = { ...settings, ...to };
  try {
    localStorage.setItem(REMEMBERED, JSON.stringify(settings));
  } catch {}
  showVolume();
  if (context) setVolume();
}

/** Loudness is heard by its logarithm. */
function setVolume() {
  master.gain.setTargetAtTime(settings.muted ? 0 : settings.volume ** 2 * 1.6, context.currentTime, 0.02);
}

function showVolume() {
  const silent = settings.muted || settings.volume === 0;
  byId("volume").value = settings.muted ? 0 : settings.volume;
  byId("volume").style.setProperty("--past", `${100 * (settings.muted ? 0 : settings.volume)}%`);
  byId("mute").setAttribute("aria-pressed", String(silent));
  byId("mute").title = silent ? text("sounds_are_off") : text("turn_sounds_off");
}

byId("mute").addEventListener("click", () => {
  const silent = settings.muted || settings.volume === 0;
  change({ muted: !silent, ...(silent && settings.volume === 0 && { volume: 0.6 }) });
});
byId("volume").addEventListener("input", ({ target }) => change({ volume: Number(target.value), muted: false }));
byId("volume").addEventListener("change", () => play("click"));
for (const gesture of ["pointerdown", "keydown"]) document.addEventListener(gesture, audio, { capture: true, passive: true });
showVolume();
