// Runs beside the page's sound: takes what the microphone gives, at whatever rate, and hands on 16 kHz mono in pieces.

const RATE = 16000;
/** Samples of a piece: 32 ms. */
const PIECE = 512;
/** How many zero crossings of the filter are used on either side. */
const CROSSINGS = 16;

class Microphone extends AudioWorkletProcessor {
  constructor() {
    super();
    this.step = sampleRate / RATE;
    this.cutoff = Math.min(1, RATE / sampleRate);
    this.reach = Math.ceil(CROSSINGS / this.cutoff);
    /** What is still needed of what came; where the next sample lies in it. */
    this.kept = new Float32Array(0);
    this.place = this.reach;
    this.piece = new Int16Array(PIECE);
    this.filled = 0;
    this.loudest = 0;
  }

  process([input]) {
    if (!input?.length) return true;
    this.take(input.length === 1 ? input[0] : mixed(input));
    return true;
  }

  take(samples) {
    const all = new Float32Array(this.kept.length + samples.length);
    all.set(this.kept);
    all.set(samples, this.kept.length);
    while (this.place + this.reach < all.length) {
      this.give(this.at(all, this.place));
      this.place += this.step;
    }
    const past = Math.max(0, Math.floor(this.place) - this.reach);
    this.kept = all.slice(past);
    this.place -= past;
  }

  /** The value between samples: a windowed sinc, which lets through what the lower rate can hold. */
  at(all, place) {
    const [first, last] = [Math.ceil(place - this.reach), Math.floor(place + this.reach)];
    let sum = 0;
    for (let at = Math.max(0, first); at <= last; at += 1) {
      const away = place - at;
      const angle = Math.PI * away * this.cutoff;
      const sinc = Math.abs(angle) < 1e-6 ? 1 : Math.sin(angle) / angle;
      sum += all[at] * this.cutoff * sinc * 0.5 * (1 + Math.cos((Math.PI * away) / this.reach));
    }
    return sum;
  }

  give(value) {
    const sample = Math.max(-1, Math.min(1, value));
    this.loudest = Math.max(this.loudest, Math.abs(sample));
    this.piece[this.filled] = Math.round(sample * 32767);
    this.filled += 1;
    if (this.filled < PIECE) return;
    this.port.postMessage({ piece: this.piece.buffer, loudest: this.loudest }, [this.piece.buffer]);
    this.piece = new Int16Array(PIECE);
    this.filled = 0;
    this.loudest = 0;
  }
}

function mixed(channels) {
  const sum = new Float32Array(channels[0].length);
  for (const channel of channels) for (let at = 0; at < sum.length; at += 1) sum[at] += channel[at] / channels.length;
  return sum;
}

registerProcessor("microphone", Microphone);
