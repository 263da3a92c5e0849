"""Fits the model of meaning: what people say is to point the same way as the plain request that it stands for.

    python meaning.py --minutes 20        writes ../model/meaning.safetensors

It learns from the corpus, all speakers but those held out, and from what people say for things and instead of requests
(`dialog/language/data/things.txt` and `hints.txt`). README.md says what it needs.
"""

import argparse
import json
import random
import re
import time
from pathlib import Path

import torch
import torch.nn.functional as F
from safetensors.torch import load_file, save_file
from torch import nn

import corpus
import letters
import network
from network import MINILM, VOCABULARY, WIDTH

SEED = 1
LAYERS, POSITIONS, MOST_WORDS = 6, 128, 60
BATCH, BATCHES_AHEAD = 48, 8
RATE, WARM_UP = 4e-5, 50
#: By how much cosines are divided to be scores.
SHARPNESS = 0.05
#: How often a sample is a hint, and a description of a thing.
HINTS, THINGS = 0.12, 0.2
DATA = corpus.CRATE.parent / "language/data"
DETERMINER = re.compile(r"(?:the|a|an|my|that|this|those|these|some) ", re.IGNORECASE)
#: What has no plain request of its own.
BOUND = re.compile(r"(?:if|unless|when|until|otherwise|answer|tell|goal|do not)\b")


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--minutes", type=float, default=20, help="how long to train")
    options.add_argument("--begin", type=Path, help="a model to begin with, as this program writes them")
    options.add_argument("--out", type=Path, default=corpus.CRATE / "model/meaning.safetensors", help="the model")
    options.add_argument("--seed", type=int, default=SEED)
    given = options.parse_args()
    torch.manual_seed(given.seed)
    model = Meaning()
    if given.begin:
        network.take(model, load_file(given.begin))
    samples = Samples(given.seed)
    train(model, samples, given.minutes)
    save_file(network.export(model), given.out, metadata={"encoder": str(LAYERS)})
    given.out.chmod(0o644)
    write_reference(model, samples, corpus.CRATE / "tests/likenesses.json")


class Meaning(nn.Module):
    """The mean of what MiniLM makes of a text's pieces, as `src/meaning.rs` has it."""

    def __init__(self):
        super().__init__()
        given = load_file(MINILM / "model.safetensors")
        rounded = network.four_bits(given["embeddings.word_embeddings.weight"])[2]
        self.words = nn.Embedding.from_pretrained(rounded, freeze=True)
        positions = given["embeddings.position_embeddings.weight"][:POSITIONS].clone()
        self.positions = nn.Embedding.from_pretrained(positions, freeze=False)
        self.speakers = nn.Embedding.from_pretrained(given["embeddings.token_type_embeddings.weight"][:1].clone(), freeze=False)
        self.norm = nn.LayerNorm(WIDTH, eps=1e-12)
        network.fill(self.norm, given, "embeddings.LayerNorm")
        self.encoder = network.encoder_layers(given, LAYERS)

    def forward(self, texts):
        rows = [pieces(text) for text in texts]
        length = max(map(len, rows))
        read = torch.zeros(len(rows), length, dtype=torch.long)
        for at, row in enumerate(rows):
            read[at, : len(row)] = torch.tensor(row)
        is_read = read != 0
        x = self.norm(self.words(read) + self.positions.weight[:length] + self.speakers.weight[0])
        for layer in self.encoder:
            x = layer(x, is_read[:, None, None, :])
        mean = (x * is_read[..., None]).sum(1) / is_read.sum(1, keepdim=True)
        return F.normalize(mean, dim=1)


def pieces(text):
    said = [piece for word in corpus.words(text)[:MOST_WORDS] for piece in network.pieces(word)]
    return [VOCABULARY["[CLS]"], *said[: POSITIONS - 2], VOCABULARY["[SEP]"]]


class Samples:
    """Draws what is said, the plain request that it means, and another request about the same thing."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        said = (sample for sample in corpus.samples() if sample.speaker not in corpus.HELD_OUT)
        self.pairs = [(sample.utterance, request) for sample in said if (request := plain(sample.label))]
        self.things, self.hints = lines(DATA / "things.txt"), lines(DATA / "hints.txt")
        forms = [form for form in letters.FORMS if "#" not in form]
        self.of_one = [form for form in forms if letters.PLACES[form] == 1]
        self.of_two = [form for form in forms if letters.PLACES[form] == 2]
        self.commands = [form for form in self.of_one if not form.endswith("?")]
        print(f"{len(self.pairs)} utterances, {len(self.things)} descriptions, {len(self.hints)} hints", flush=True)

    def draw(self):
        chance = self.random.random()
        if self.hints and chance < HINTS:
            request, said = self.random.choice(self.hints)
            return said, request, self.other(request)
        if chance < HINTS + THINGS:
            name, said = self.random.choice(self.things)
            if self.random.random() < 0.3:
                return said, f"the {name}", None
            form = self.random.choice(self.commands)
            request = form.replace("X", f"the {name}")
            return form.replace("X", said), request, self.other(request)
        said, request = self.random.choice(self.pairs)
        if self.random.random() < 0.5:
            said, request = self.of_other_thing(said, request)
        return said, request, self.other(request)

    def other(self, request):
        """Another deed with the same thing."""
        readings = letters.readings(request)
        if not readings or letters.PLACES[readings[0][0]] not in (1, 2) or "#" in readings[0][0]:
            return None
        form, arguments = readings[0]
        forms = self.of_two if letters.PLACES[form] == 2 and self.random.random() < 0.5 else self.of_one
        other = self.random.choice([one for one in forms if one.endswith("?") == form.endswith("?")] or forms)
        last = arguments[-1] if len(arguments) > 1 else "it"
        return None if other == form else other.replace("X", "\0", 1).replace("Y", last).replace("\0", arguments[0])

    def of_other_thing(self, said, request):
        """The same of a thing of the catalogue, which may be described where it is said."""
        readings = letters.readings(request)
        arguments = readings[0][1] if readings else []
        fit = [one for one in arguments if DETERMINER.match(f"{one} ") and len(one.split()) < 8 and said.lower().count(one.lower()) == 1]
        if not fit:
            return said, request
        argument = self.random.choice(fit)
        name, description = self.random.choice(self.things)
        if self.random.random() < 0.4:
            description = f"the {name}"
        at = said.lower().index(argument.lower())
        return said[:at] + description + said[at + len(argument) :], request.replace(argument, f"the {name}")


def plain(label):
    """The request of a label that has one, without how it is to be done or what it goes on from."""
    label = re.sub(r" \{[^{}]*\}$", "", re.sub(r"^(?:also|instead): ", "", label))
    if "; " in label or BOUND.match(label):
        return None
    return "nothing" if label == "none" else label.removeprefix("*")


def lines(file):
    """Lines of `head | what is said`."""
    read = (line for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#"))
    return [tuple(line.split(" | ", 1)) for line in read if " | " in line]


def train(model, samples, minutes):
    optimizer = torch.optim.AdamW([one for one in model.parameters() if one.requires_grad], weight_decay=0.01)
    begun, step, ahead, losses = time.monotonic(), 0, [], []
    model.train()
    while (done := (time.monotonic() - begun) / (60 * minutes)) < 1:
        if not ahead:
            drawn = sorted((samples.draw() for _ in range(BATCH * BATCHES_AHEAD)), key=lambda one: len(one[0]))
            ahead = [drawn[at : at + BATCH] for at in range(0, len(drawn), BATCH)]
            samples.random.shuffle(ahead)
        for group in optimizer.param_groups:
            group["lr"] = RATE * min(1, (step + 1) / WARM_UP) * max(0.03, 1 - done)
        loss = contrast(model, ahead.pop())
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        step, losses = step + 1, [*losses[-99:], loss.item()]
        if step % 100 == 0:
            print(f"step {step}, {100 * done:.0f} %, loss {sum(losses) / len(losses):.3f}", flush=True)


def contrast(model, drawn):
    """How badly each utterance is told which of all requests is its own, and each request which utterance."""
    said, wanted, others = zip(*drawn, strict=True)
    requests = [*wanted, *(other for other in others if other)]
    scores = model(said) @ model(requests).T / SHARPNESS
    own = torch.arange(len(said))
    is_same = torch.tensor([[one == request for request in requests] for one in wanted])
    is_same[own, own] = False
    scores = scores.masked_fill(is_same, -1e4)
    return F.cross_entropy(scores, own) + 0.5 * F.cross_entropy(scores[:, : len(said)].T, own)


@torch.no_grad()
def write_reference(model, samples, file):
    """How like some texts are, for the Rust code to be compared with."""
    model.eval()
    rows = []
    for _ in range(100):
        said, request, _ = samples.draw()
        one, other = model([said, request])
        rows.append(json.dumps({"one": said, "other": request, "likeness": round(float(one @ other), 3)}, ensure_ascii=False))
    file.write_text("[\n" + ",\n".join(rows) + "\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
