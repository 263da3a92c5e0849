"""Fits the parser's network to the corpus.

    python fit.py --minutes 60                    all speakers but those held out; writes ../model
    python fit.py --minutes 30 --dev mei earl     also without these, whose utterances are then parsed and compared

README.md says what it needs.
"""

import argparse
import json
import random
import re
import shutil
import time
from dataclasses import replace
from pathlib import Path

import torch
from safetensors.torch import load_file, save_file

import corpus
import letters
import network
from augment import MOST_LETTERS, Augmenter
from grammar import State
from letters import ALPHABET, END, START

SEED = 1
#: A determiner without a thing.
DANGLING = re.compile(r"\b(?:the|a|an|my)(?: (?:in|on|into|with|to|at)\b|\W*(?:;|$))")
BATCH, BATCHES_AHEAD = 32, 12
#: Labels further from what was said are not learnt from.
MOST_COST = 6.0
#: How often an utterance of a writer is drawn for one of the corpus.
WRITERS_SHARE = 3
ENCODER_RATE, DECODER_RATE, WARM_UP = 8e-5, 6e-4, 200
CATALOG = corpus.CRATE.parent.parent / "cdf/catalog/objects"


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--minutes", type=float, default=60, help="how long to train")
    options.add_argument("--dev", nargs="*", default=[], help="speakers to compare with, and not to learn from")
    options.add_argument("--out", type=Path, default=corpus.CRATE / "model", help="the folder of the model")
    options.add_argument("--writers", nargs="*", default=[], help="writers of utterances to learn from beside the corpus")
    options.add_argument("--rate", type=float, default=1.0, help="what the rates of learning are multiplied by")
    options.add_argument("--begin", type=Path, help="a model to begin with, as this program writes them")
    options.add_argument("--device", default="cpu")
    given = options.parse_args()
    torch.manual_seed(SEED)
    samples = list(encoded(corpus.samples()))
    unlearnt = corpus.HELD_OUT | set(given.dev)
    trained = [sample for sample in samples if sample.speaker not in unlearnt and sample.letters is not None]
    written = [one for one in encoded(corpus.written(given.writers)) if one.letters is not None and is_said(one)]
    print(f"{len(trained)} utterances of the corpus and {len(written)} of writers to learn from", flush=True)
    trained += written * WRITERS_SHARE
    model = network.Network()
    if given.begin:
        network.take(model, load_file(given.begin))
    model.to(given.device)
    train(model, Augmenter(trained, thing_names(), told(), SEED), given)
    given.out.mkdir(parents=True, exist_ok=True)
    tensors = export(model)
    notes = {"symbols": "\n".join(ALPHABET), "encoder": str(network.LAYERS), "decoder": str(network.DECODER_LAYERS)}
    save_file(tensors, given.out / "parser.safetensors", metadata=notes)
    shutil.copy(network.MINILM / "vocab.txt", given.out / "vocabulary.txt")
    for name, speakers in (("dev", set(given.dev)), ("held out", corpus.HELD_OUT)):
        compare(model, name, [sample for sample in samples if sample.speaker in speakers])
    learnt = random.Random(SEED).sample(trained, 200)
    write_reference(model, learnt, corpus.CRATE / "tests/reference.json")


def encoded(samples):
    for sample in samples:
        written, cost = letters.encode(sample)
        fits = written is not None and len(written) < MOST_LETTERS and cost < MOST_COST
        yield replace(sample, letters=written if fits else None)


def is_said(sample):
    """Whether a label is made of words that were said: writers name things as the office does, whatever the person calls them."""
    found = letters.decode(sample.letters, sample.words)
    if "?" in found:
        return letters.plain(found) == letters.plain(sample.label)
    return set(corpus.words(found)) <= set(corpus.words(sample.label)) and not DANGLING.search(found)


def thing_names():
    """What the things of the built-in catalogue are called."""
    names = set()
    for file in sorted(CATALOG.glob("*.toml")):
        for line in file.read_text(encoding="utf-8").splitlines():
            key, _, value = line.partition(" = ")
            if key == "name":
                names.add(value.strip().strip('"').lower())
    return sorted(names)


def told():
    """What people say for things."""
    file = corpus.CRATE.parent / "language/data/things.txt"
    lines = (line.partition(" | ")[2] for line in file.read_text(encoding="utf-8").splitlines())
    return [said for said in lines if said]


def train(model, augmenter, given):
    of_encoder = ("encoder.", "positions", "speakers", "norm.")
    parts = {True: [], False: []}
    for name, parameter in model.named_parameters():
        if parameter.requires_grad:
            parts[name.startswith(of_encoder)].append(parameter)
    rates = [given.rate * ENCODER_RATE, given.rate * DECODER_RATE]
    groups = [{"params": parts[is_encoder], "lr": rate} for is_encoder, rate in zip((True, False), rates, strict=True)]
    optimizer = torch.optim.AdamW(groups, weight_decay=0.05, betas=(0.9, 0.98))
    begun, step, ahead, losses = time.monotonic(), 0, [], []
    model.train()
    while (done := (time.monotonic() - begun) / (60 * given.minutes)) < 1:
        if not ahead:
            # Batches of samples of like length: little of a batch is padding.
            drawn = sorted((augmenter.draw() for _ in range(BATCH * BATCHES_AHEAD)), key=lambda one: len(one.words))
            ahead = [drawn[at : at + BATCH] for at in range(0, len(drawn), BATCH)]
            augmenter.random.shuffle(ahead)
        for group, rate in zip(optimizer.param_groups, rates, strict=True):
            group["lr"] = rate * min(1, (step + 1) / WARM_UP) * max(0.02, 1 - done)
        loss = model.loss(network.batch(ahead.pop(), given.device))
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        step, losses = step + 1, [*losses[-199:], loss.item()]
        if step % 200 == 0:
            print(f"step {step}, {100 * done:.0f} %, loss {sum(losses) / len(losses):.3f}", flush=True)


@torch.no_grad()
def write(model, samples, size=48):
    """What the network writes for samples, letter by letter, and the logarithm of its probability."""
    model.eval()
    device = model.to_start.weight.device
    outputs = [None] * len(samples)
    order = sorted(range(len(samples)), key=lambda at: len(samples[at].words))
    for chunk in (order[at : at + size] for at in range(0, len(order), size)):
        said = [replace(samples[at], letters=None) for at in chunk]
        read = network.batch(said, device)
        memory = model.remember(model.encode(read))
        words = read["is_word"].shape[1]
        found = [([], 0.0) for _ in said]
        states = [State() for _ in said]
        while True:
            so_far = [replace(one, letters=list(written)) for one, (written, _) in zip(said, found, strict=True)]
            given = network.to_device(network.written(so_far, words)["given"], device)
            scores = model.decode(given, *memory, read["is_word"])
            for at, (written, probability) in enumerate(found):
                if written[-1:] == ["<eos>"]:
                    continue
                allowed = states[at].allowed(len(said[at].words), words).to(device)
                log = scores[at, len(written)].masked_fill(~allowed, -1e9).log_softmax(-1)
                best = int(log.argmax())
                letter = next_letter(best, words)
                states[at] = states[at].after(letter)
                found[at] = ([*written, letter], probability + float(log[best]))
            is_full = max(len(written) for written, _ in found) >= network.MOST_LETTERS - 1
            if is_full or all(written[-1] == "<eos>" for written, _ in found):
                break
        for at, result in zip(chunk, found, strict=True):
            outputs[at] = result
    return outputs


def next_letter(index, words):
    if index < len(ALPHABET):
        return ALPHABET[index]
    which, word = divmod(index - len(ALPHABET), words)
    return ((START, END)[which], word)


def compare(model, name, samples):
    """How many labels are written exactly, and how many are right but for their descriptions."""
    if not samples:
        return
    outputs = write(model, samples)
    exact = alike = 0
    for sample, (written, _) in zip(samples, outputs, strict=True):
        found = letters.decode(written, sample.words)
        exact += letters.plain(found) == letters.plain(sample.label)
        wanted, _ = letters.encode(sample)
        alike += wanted is not None and symbols(written) == symbols(wanted)
    print(f"{name}: of {len(samples)}, {exact} exact, {alike} with the right forms", flush=True)


def symbols(written):
    return [one for one in written if isinstance(one, str) and not one.startswith(("const:", "CONT", "<eos>"))]


def export(model):
    """The model's numbers as `src/tensors.rs` reads them; the model itself computes with them from now on."""
    tensors = {}
    whole, scale, rounded = network.four_bits(model.words.weight.data.cpu())
    nibbles = (whole + 8).to(torch.uint8)
    tensors["words.packed"] = nibbles[:, 0::2] | (nibbles[:, 1::2] << 4)
    tensors["words.scale"] = scale.bfloat16()
    model.words.weight.data = rounded.to(model.words.weight.device)
    return tensors | network.export(model)


def write_reference(model, samples, file):
    """What the network makes of some utterances, for the Rust code to be compared with."""
    rows = []
    for sample, (written, probability) in zip(samples, write(model, samples), strict=True):
        requests = letters.decode(written, sample.words)
        before = [{"by_robot": by_robot, "text": text} for by_robot, text in sample.before]
        row = {"utterance": sample.utterance, "before": before, "requests": requests, "log_probability": round(probability, 3)}
        rows.append(json.dumps(row, ensure_ascii=False))
    file.write_text("[\n" + ",\n".join(rows) + "\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
