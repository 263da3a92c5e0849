"""Fits the re-ranker: how well something that the robot could do or say fits what was said, with both read together (a cross-encoder).

    python rerank.py --pretrain-minutes 10 --minutes 30        writes ../model/reranker.safetensors and ../tests/scores.json

It learns first from the corpus, where the label of an utterance is to fit better than labels that differ in a word, then from the lists of
`cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin ways`: all that the robot could make of an utterance, and which of it
is right. README.md says what it needs.
"""

import argparse
import json
import random
import re
import time
from dataclasses import dataclass
from pathlib import Path

import torch
import torch.nn.functional as F
from safetensors.torch import load_file, save_file
from torch import nn

import corpus
import letters
import network
from network import VOCABULARY, WIDTH

SEED = 1
LAYERS, MOST_CANDIDATE, MOST_PIECES = 4, 70, 190
#: How many pieces are read in a step, and how many steps are drawn at a time.
PIECES_A_STEP, STEPS_AHEAD = 5200, 8
RATE, PRETRAIN_RATE, WARM_UP = 8e-5, 6e-5, 40
CANDIDATE = 3
#: What may be named in the place of one another: things that are carried and that nothing is done with, colors, rooms.
NAMES = {
    "things": "action figure|apple|banana|bowl|burger|cake|candy bar|carrot|circuit board|donut|fan|floppy disk|fork|jelly|laser tip|lever|"
    "loaf of bread|mug|peanut butter|pear|pie|plate|printer cartridge|radio|record|sandwich|screw driver|soda can|spoon|toast|trophy".split("|"),
    "colors": "red|green|blue|yellow|black|white|pink|purple|brown|gray".split("|"),
    "rooms": "break room|main office|small office|robotics lab|quantum lab|warehouse|reception|hallway".split("|"),
}
WAYS = corpus.CRATE.parent / "language/fit/ways"
#: What ways are held out by default: sets that begin so.
HELD_OUT = ("held_out", "strangers")


@dataclass
class Listed:
    """An utterance with candidates, and which of them are right; where none is, none of them is meant."""

    words: list
    begin: int
    candidates: list
    right: list
    weight: float = 1.0


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--minutes", type=float, default=30, help="how long to train on lists")
    options.add_argument("--pretrain-minutes", type=float, default=10, help="how long to train on the corpus before")
    options.add_argument("--sets", nargs="*", help="the sets to learn from, by name; all but those held out, where none is named")
    options.add_argument("--judge", nargs="*", default=[], help="sets whose share of right choices is printed")
    options.add_argument("--begin", type=Path, help="a model to begin with, as this program writes them")
    options.add_argument("--out", type=Path, default=corpus.CRATE / "model/reranker.safetensors", help="the model")
    given = options.parse_args()
    torch.manual_seed(SEED)
    model = Reranker()
    if given.begin:
        network.take(model, load_file(given.begin))
    if given.pretrain_minutes:
        train(model, Corpus(SEED).draw, given.pretrain_minutes, PRETRAIN_RATE, "corpus")
        save(model, given.out)
    if given.minutes:
        draw = Lists(given.sets, SEED).draw
        train(model, draw, given.minutes, RATE, "lists")
        save(model, given.out)
    for name in given.judge:
        judge(model, name)
    write_reference(model, corpus.CRATE / "tests/scores.json")


def save(model, out):
    save_file(network.export(model), out, metadata={"encoder": str(LAYERS)})
    out.chmod(0o644)


class Reranker(nn.Module):
    """The score of a candidate, as `src/reranker.rs` has it: begins as the parser's encoder."""

    def __init__(self):
        super().__init__()
        base = network.Network()
        network.take(base, load_file(corpus.CRATE / "model/parser.safetensors"))
        self.words, self.positions, self.norm, self.encoder = base.words, base.positions, base.norm, base.encoder
        speakers = base.speakers.weight.data
        self.speakers = nn.Embedding.from_pretrained(torch.cat([speakers, speakers.mean(0, keepdim=True)]), freeze=False)
        self.score = nn.Linear(WIDTH, 1)
        nn.init.normal_(self.score.weight, std=0.02)
        nn.init.zeros_(self.score.bias)

    def forward(self, rows):
        length = max(len(pieces) for pieces, _ in rows)
        read, speakers = (torch.zeros(len(rows), length, dtype=torch.long) for _ in range(2))
        for at, (pieces, by) in enumerate(rows):
            read[at, : len(pieces)], speakers[at, : len(by)] = torch.tensor(pieces), torch.tensor(by)
        is_read = read != 0
        x = self.norm(self.words(read) + self.positions.weight[:length] + self.speakers(speakers))
        for layer in self.encoder:
            x = layer(x, is_read[:, None, None, :])
        mean = (x * is_read[..., None]).sum(1) / is_read.sum(1, keepdim=True)
        return self.score(mean)[:, 0]


def row(listed, candidate):
    """The pieces of the lines before, of what was said and of a candidate, and who says each."""
    said, speakers, by_robot = [VOCABULARY["[CLS]"]], [0], 0
    for at, word in enumerate(listed.words):
        by_robot = {corpus.ROBOT: 1, corpus.PERSON: 0}.get(word, by_robot)
        found = network.pieces(word)
        said += found
        speakers += [2 if at >= listed.begin - 1 else by_robot] * len(found)
    told = [piece for word in corpus.words(candidate) for piece in network.pieces(word)][:MOST_CANDIDATE]
    told = [VOCABULARY["[SEP]"], *told]
    keep = MOST_PIECES - len(told)
    return [*said[:keep], *told], [*speakers[:keep], *[CANDIDATE] * len(told)]


def loss(model, lists):
    """How unlikely the right ones are, among the candidates of their list and that none of them is meant, whose score is 0."""
    rows = [row(listed, candidate) for listed in lists for candidate in listed.candidates]
    scores, total, at = model(rows), 0.0, 0
    for listed in lists:
        own = torch.cat([scores[at : at + len(listed.candidates)], torch.zeros(1)])
        at += len(listed.candidates)
        right = torch.tensor([*listed.right, not any(listed.right)])
        shares = F.log_softmax(own, 0)
        total = total - listed.weight * torch.logsumexp(shares[right], 0)
    return total / len(lists)


def train(model, draw, minutes, rate, name):
    optimizer = torch.optim.AdamW([one for one in model.parameters() if one.requires_grad], weight_decay=0.01)
    begun, step, losses = time.monotonic(), 0, []
    model.train()
    ahead = []
    while (done := (time.monotonic() - begun) / (60 * minutes)) < 1:
        ahead = ahead or steps(draw)
        lists = ahead.pop()
        for group in optimizer.param_groups:
            group["lr"] = rate * min(1, (step + 1) / WARM_UP) * max(0.03, 1 - done)
        with torch.autocast("cpu", dtype=torch.bfloat16):
            lost = loss(model, lists)
        optimizer.zero_grad()
        lost.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        step, losses = step + 1, [*losses[-49:], lost.item()]
        if step % 25 == 0:
            print(f"{name}: step {step}, {100 * done:.0f} %, loss {sum(losses) / len(losses):.3f}", flush=True)


def steps(draw):
    """Some steps of lists, each of such that are about as long: none is padded much."""
    drawn, pieces = [], 0
    while pieces < STEPS_AHEAD * PIECES_A_STEP:
        listed = draw()
        longest = max(len(row(listed, candidate)[0]) for candidate in listed.candidates)
        drawn.append((longest, len(drawn), listed))
        pieces += longest * len(listed.candidates)
    grouped, rows = [[]], 0
    for longest, _, listed in sorted(drawn):
        if grouped[-1] and longest * (rows + len(listed.candidates)) > PIECES_A_STEP:
            grouped.append([])
            rows = 0
        grouped[-1].append(listed)
        rows += len(listed.candidates)
    random.Random(len(drawn)).shuffle(grouped)
    return grouped


class Corpus:
    """Draws utterances of the corpus with their labels, and labels that differ from these."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.samples = [sample for sample in corpus.samples() if sample.speaker not in corpus.HELD_OUT]
        self.places = range(len(self.samples))
        self.forms = [form for form in letters.FORMS if "#" not in form]

    def draw(self):
        at = self.random.choice(self.places)
        sample, label = self.samples[at], plain(self.samples[at].label)
        near = [plain(self.samples[other].label) for other in range(max(0, at - 6), min(len(self.samples), at + 7)) if other != at]
        wrong = set(self.random.sample(near, 2))
        wrong |= {self.varied(label, near) for _ in range(4)}
        wrong.discard(label)
        wrong.discard("")
        candidates = [*wrong, label]
        self.random.shuffle(candidates)
        if self.random.random() < 0.1:
            candidates.remove(label)
        return Listed(sample.words, sample.begin, candidates, [candidate == label for candidate in candidates])

    def varied(self, label, near):
        """The label with something else in it, more, or less."""
        requests, other = label.split("; "), self.random.choice(near)
        chance = self.random.random()
        if len(requests) > 1 and chance < 0.35:
            del requests[self.random.randrange(len(requests))]
        elif chance < 0.5:
            requests.insert(self.random.randrange(len(requests) + 1), self.random.choice(other.split("; ")))
        else:
            at = self.random.randrange(len(requests))
            requests[at] = self.changed(requests[at], self.random.choice(other.split("; ")))
        return "; ".join(requests)

    def changed(self, request, other):
        own, others = letters.readings(request), letters.readings(other)
        if not own:
            return other
        form, arguments = own[0]
        if others and others[0][1] and arguments and self.random.random() < 0.6:
            arguments = list(arguments)
            arguments[self.random.randrange(len(arguments))] = self.random.choice(others[0][1])
        else:
            count = letters.PLACES[form]
            form = self.random.choice([one for one in self.forms if letters.PLACES[one] == count])
        return filled(form, arguments)


def filled(form, arguments):
    text = form
    for mark, argument in zip(re.findall(r"[XY#]", form), arguments, strict=False):
        text = text.replace(mark, "\0" + argument, 1)
    return text.replace("\0", "")


def plain(label):
    """A label without how it is to be done or what it goes on from."""
    requests = (re.sub(r" \{[^{}]*\}$", "", re.sub(r"^(?:also|instead): ", "", one)) for one in label.split("; "))
    return "; ".join(one.removeprefix("*") for one in requests)


def lists(name):
    for line in (WAYS / f"{name}.jsonl").read_text(encoding="utf-8").splitlines():
        read = json.loads(line)
        words, begin = corpus.source([tuple(one) for one in read["before"]], read["said"])
        # What the robot would have read with what was said is told in words.
        ways = [way for way in read["ways"] if way["words"]]
        yield Listed(words, begin, [way["words"] for way in ways], [way["is_right"] for way in ways], read["weight"])


class Lists:
    """Draws utterances of sets with what the robot could make of them."""

    def __init__(self, sets, seed):
        self.random = random.Random(seed)
        names = sets or sorted(file.stem for file in WAYS.glob("*.jsonl") if not file.stem.startswith(HELD_OUT))
        self.lists = [listed for name in names for listed in lists(name) if len(listed.candidates) > 1]
        self.ahead = []
        print(f"{len(self.lists)} lists of {' '.join(names)}", flush=True)

    def draw(self):
        if not self.ahead:
            self.ahead = self.random.sample(self.lists, len(self.lists))
        listed = self.ahead.pop()
        places = list(range(len(listed.candidates)))
        self.random.shuffle(places)
        words, candidates = listed.words, [listed.candidates[at] for at in places]
        if self.random.random() < 0.5:
            words, candidates = self.renamed(words, candidates)
        begin = words.index(corpus.NOW) + 1
        if self.random.random() < 0.3:
            words = [slip(self.random, word) if at >= begin and self.random.random() < 0.1 else word for at, word in enumerate(words)]
        return Listed(words, begin, candidates, [listed.right[at] for at in places], listed.weight)

    def renamed(self, words, candidates):
        """The same with other things, colors and rooms wherever these are named."""
        text = " ".join(words)
        other = {}
        for kind, names in NAMES.items():
            named = [name for name in names if re.search(rf"\b{name}\b", text)]
            if kind == "things":
                others = self.random.sample(names, len(named))
                other |= dict(zip(named, others, strict=True)) | dict(zip(others, named, strict=True))
            else:
                other |= dict(zip(names, self.random.sample(names, len(names)), strict=True))
        pattern = re.compile(rf"\b(?:{'|'.join(sorted(other, key=len, reverse=True))})\b")

        def rename(text):
            return pattern.sub(lambda match: other[match.group()], text)

        return rename(text).split(), [rename(candidate.lower()) for candidate in candidates]


def slip(drawn, word):
    if len(word) < 4 or not word.isalpha():
        return word
    at = drawn.randrange(1, len(word) - 1)
    return drawn.choice([word[:at] + word[at + 1 :], word[:at] + word[at + 1] + word[at] + word[at + 2 :], word[:at] + word[at] + word[at:]])


@torch.no_grad()
def judge(model, name):
    model.eval()
    right = first = possible = 0
    judged = [listed for listed in lists(name) if len(listed.candidates) > 1]
    for listed in judged:
        scores = model([row(listed, candidate) for candidate in listed.candidates])
        right += listed.right[int(scores.argmax())]
        first += listed.right[0]
        possible += any(listed.right)
    print(f"{name}: the best is right in {right} of {len(judged)}, the first {first}, any {possible}", flush=True)


@torch.no_grad()
def write_reference(model, file):
    """The scores of some utterances and labels, for the Rust code to be compared with."""
    model.eval()
    rows = []
    drawn = Corpus(SEED + 1)
    for _ in range(60):
        at = drawn.random.choice(drawn.places)
        sample = drawn.samples[at]
        for candidate in (plain(sample.label), plain(drawn.samples[at - 1].label)):
            listed = Listed(sample.words, sample.begin, [candidate], [True])
            score = float(model([row(listed, candidate)])[0])
            before = [list(one) for one in sample.before]
            rows.append(json.dumps({"before": before, "said": sample.utterance, "candidate": candidate, "score": round(score, 3)}, ensure_ascii=False))
    file.write_text("[\n" + ",\n".join(rows) + "\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
