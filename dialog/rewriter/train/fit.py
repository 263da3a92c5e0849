"""Fits the rewriter: a language model that writes what an utterance means as plain requests.

    python fit.py --minutes 90                       writes ../rewriter.safetensors and ../tests/rewritings.json
    python fit.py --minutes 60 --begin ../rewriter.safetensors     goes on with the shipped one
    python fit.py --minutes 0 --begin ONE.pt TWO.pt  only writes these, of the mean of models that were kept

It begins as SmolLM2-135M-Instruct and learns from the corpus and its talks, from writers of `dialog/language/tests/utterances/writers` and from
participants of `dialog/language/tests/participants`. README.md says what it needs.
"""

import argparse
import json
import random
import re
import time
from functools import cache
from pathlib import Path

import torch
from safetensors.torch import load_file, save_file
from torch import nn
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

import corpus
import language_model
from language_model import END, LanguageModel

SEED = 1
#: How many tokens a row has that is learnt from, and how many rows a batch has, on a CPU and on a GPU.
ROW, ROWS, GPU_ROWS = 640, 4, 24
#: The most utterances of one place in a row, which share what is read of their surroundings.
FAMILY = 8
#: How many utterances are measured at once, and what the length of their rows is a multiple of, so that memory is asked for in few sizes.
MEASURED, LENGTH_STEP = 128, 16
MOST_WRITTEN = 70
#: How often an utterance of the corpus is drawn, whose labels are in the person's own words.
CORPUS_SHARE = 0.15
#: How often what is read is the label itself: who speaks plainly is taken at their word.
PLAIN_SHARE = 0.05
CONTEXTS = corpus.CRATE.parent / "language/fit/contexts"
#: How often what is around the robot is not told, and how often it is told in another order.
BLIND_SHARE, MIXED_SHARE = 0.1, 0.5
#: How often a place is told with other things in it, and how many of them are others then.
OTHER_SHARE, OTHER_THINGS = 0.4, 0.4
#: What is told of a thing beside its name.
STATES = re.compile(r"^(?:\d+ |dirty |broken |open |locked |hot |cold |wet |red |green |blue |full |empty )+| with .*$| \(.*$")
#: Names of things that mean something else, too: what a vessel holds, a verb, a colour.
AMBIGUOUS = {"tea", "coffee", "milk", "water", "juice", "can", "orange"}
#: What stands between two parts of a message.
PAUSES = [". ", ". ", ", ", ", ", " and ", ". then ", ", then ", " ... ", "; ", ". also "]
#: Labels that are no plain request.
WITHOUT_REQUEST = {"social", "none", "?"}
#: Talks with the robot, message by message: as they happened, and as writers made them up.
PARTICIPANTS = corpus.CRATE.parent / "language/tests/participants"
TALKS = [*sorted(PARTICIPANTS.glob("*.txt")), *sorted((corpus.CRATE / "corpus/talks").glob("*.txt"))]
#: Nothing is fitted to these talks and writers: they are to measure with.
UNSEEN_TALKS = {"oona", "bram", "sofia", "niamh", "piotr", "winifred", "bernard", "vikram"}
UNSEEN = set("w bc by ck cn dc dq dr ds fb fc fd fm fn fo gs gt gu ia ib ic js jv ka kb kr ks lc ld ls lv ly mc mi ml".split())


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--minutes", type=float, default=90, help="how long to train")
    options.add_argument("--rate", type=float, default=4e-4, help="the highest rate of learning")
    options.add_argument("--warm-up", type=int, default=60, help="how many steps it takes to get to that rate")
    options.add_argument("--dropout", type=float, default=0.0, help="how much of what a layer adds is left out while it learns")
    options.add_argument("--rounded-after", type=float, default=0.6, help="the share of the time after which it computes with its weights as they are rounded in the end")
    options.add_argument("--often", nargs="*", default=[], help="writers that are drawn as often as all others together: what a model that is gone on with has not read")
    options.add_argument("--seed", type=int, default=SEED, help="what is drawn by chance")
    options.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu", help="cpu or cuda")
    options.add_argument("--compile", action="store_true", help="compile the layers first: a fifth faster, and needs a C++ compiler")
    options.add_argument("--begin", type=Path, nargs="*", default=[], help="a model to go on with, as --out or, with all its bits, --keep writes it; or several: their mean")
    options.add_argument("--keep", type=Path, help="where the model is kept with all its bits")
    options.add_argument("--compare", nargs="*", default=[], help="writers or talks whose utterances are then rewritten and compared")
    options.add_argument("--out", type=Path, default=corpus.CRATE / "rewriter.safetensors", help="the model")
    options.add_argument("--reference", type=Path, default=corpus.CRATE / "tests/rewritings.json", help="what it makes of some utterances")
    given = options.parse_args()
    torch.manual_seed(given.seed)
    model = LanguageModel()
    begin(model, given.begin)
    model.to(given.device)
    if given.compile:
        for layer in model.layers:
            layer.compile(dynamic=True)
    if given.minutes:
        train(model, given)
    model.eval()
    tensors = model.export()
    save_file(tensors, given.out, metadata={"tokens": "\n".join(language_model.vocabulary()), "layers": str(len(model.layers))})
    given.out.chmod(0o644)
    set_rounded(model, False)
    print(f"rounded: {measured(model, unseen())}", flush=True)
    for writer in given.compare:
        compare(model, writer)
    write_reference(model, given.reference)


def begin(model, files):
    """Takes what was learnt before; of several models the mean."""
    if files:
        kept = [weights_of(model, file) for file in files]
        model.load_state_dict({name: sum(one[name] for one in kept) / len(kept) for name in kept[0]})


def weights_of(model, file):
    if file.suffix != ".safetensors":
        return torch.load(file, map_location="cpu")
    model.take(load_file(file))
    return {name: weights.clone() for name, weights in model.state_dict().items()}


def plain(label):
    """A label of the corpus without the mark of what is none of the known forms."""
    return "; ".join(dict.fromkeys(request.removeprefix("*") for request in label.split("; ")))


def of_corpus():
    """What is around the robot (here nobody told), what was said before, what is said, its labels, and whether they are in the person's own words."""
    for sample in corpus.samples():
        if sample.speaker not in corpus.HELD_OUT:
            yield "", sample.before, sample.utterance, [plain(sample.label)], True


def labels_of(texts):
    return [" ".join(text.lower().split()) for text in texts]


def of_writer(writer):
    """The same of a writer; with what is around the robot and what it said, where `contexts` of `dialog/language/fit` wrote that down."""
    contexts = CONTEXTS / f"{writer}.jsonl"
    if contexts.exists():
        for row in map(json.loads, contexts.read_text(encoding="utf-8").splitlines()):
            yield row["around"], row["before"], row["said"], labels_of(row["meant"]), False
        return
    for line in (corpus.WRITERS / f"{writer}.txt").read_text(encoding="utf-8").splitlines():
        said, arrow, meant = line.partition(" => ")
        if arrow and not line.startswith(("#", "[")):
            *earlier, utterance = said.split(" / ")
            yield "", [(False, one) for one in earlier], utterance, labels_of(meant.split(" || ")), False


def of_talk(file):
    """The same of what somebody said to the robot in a whole talk."""
    before, said = [], ""
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            before = []
        elif line.startswith("> "):
            said = line[2:]
        elif line.startswith("    = "):
            yield "", list(before), said, labels_of(line[6:].split(" || ")), False
            before.append((False, said))
        elif line.startswith(("    - ", "    ? ", "    ! ")):
            before.append((True, line[6:].split("   (")[0]))


class ByPlace:
    """Samples, and those of each place."""

    def __init__(self, samples):
        self.samples, self.by_place = list(samples), {}
        for sample in self.samples:
            self.by_place.setdefault(sample[0], []).append(sample)


class Row:
    """A row of tokens that is filled with families. What they share, their trunk, is read once; each branch sees it and itself."""

    def __init__(self):
        self.read, self.wanted, self.positions, self.families, self.branches = [], [], [], [], []

    def add(self, trunk, branches):
        """Adds a family, as many of its branches as there is room for; false, where there is none for the first."""
        if len(self.read) + len(trunk) + self.length(branches[0]) > ROW:
            return False
        family = self.families[-1] + 1 if self.families else 0
        self.extend(trunk, [-1] * len(trunk), 0, family, 0)
        for at, (read, written) in enumerate(branches, 1):
            if len(self.read) + self.length((read, written)) <= ROW:
                self.extend([*read, *written[:-1]], [-1] * (len(read) - 1) + written, len(trunk), family, at)
        return True

    def length(self, branch):
        return len(branch[0]) + len(branch[1]) - 1

    def extend(self, read, wanted, begin, family, branch):
        self.read += read
        self.wanted += wanted
        self.positions += range(begin, begin + len(read))
        self.families += [family] * len(read)
        self.branches += [branch] * len(read)

    def parts(self):
        """The row, filled up to its length."""
        parts = zip((self.read, self.wanted, self.positions, self.families, self.branches), (0, -1, 0, -1, 0), strict=True)
        return [part + [filling] * (ROW - len(part)) for part, filling in parts]


class Samples:
    """Draws utterances with their labels, and variants of them."""

    def __init__(self, seed, often=(), often_share=0.5):
        self.often_share = often_share
        self.random = random.Random(seed)
        writers = sorted(file.stem for file in corpus.WRITERS.glob("*.txt") if file.stem not in UNSEEN)
        written = [sample for writer in writers for sample in of_writer(writer)]
        talks = [file for file in TALKS if file.stem not in UNSEEN_TALKS]
        written += [sample for file in talks for sample in of_talk(file)]
        self.corpus, self.written = ByPlace(of_corpus()), ByPlace(written)
        self.often = ByPlace(sample for writer in often for sample in of_writer(writer))
        self.things = sorted(set().union(*map(things, self.written.by_place)))
        #: What may be said at the beginning, by what is around.
        self.beginnings = {}
        for around, before, said, labels, _ in written:
            if not before and surest(labels) not in ("?", "none"):
                self.beginnings.setdefault(around, []).append((said, labels))

    def batches(self, size):
        """Batches of as many rows."""
        rows = self.rows()
        while True:
            yield tuple(torch.tensor(part) for part in zip(*(next(rows) for _ in range(size)), strict=True))

    def rows(self):
        """Rows of families: what is read, what is to follow each place, and the tree of `LanguageModel.read`."""
        row = Row()
        while True:
            trunk, branches = self.family()
            if not row.add(trunk, branches):
                yield row.parts()
                row = Row()
                row.add(trunk, branches)

    def family(self):
        """The tokens that are read of a place, and those of some utterances there: what is read of each, and what is to be written."""
        chance = self.random.random
        drawn = self.often if self.often.samples and chance() < self.often_share else self.corpus if chance() < CORPUS_SHARE else self.written
        first = self.random.choice(drawn.samples)
        same = drawn.by_place[first[0]]
        samples = [first, *self.random.sample(same, min(len(same), FAMILY) - 1)]
        if first[0] and chance() < OTHER_SHARE:
            samples = self.with_other_things(samples)
        return language_model.surroundings(self.seen(samples[0][0])), [self.variant(*sample) for sample in samples]

    def with_other_things(self, samples):
        """The samples of a place as they would be if other things were there: what is called what is to be read, not known by heart. Who speaks of a
        thing by another name than that of the label is left out."""
        present = things(samples[0][0])
        for name in sorted(present - AMBIGUOUS):
            other = self.random.choice(self.things)
            if other not in present and self.random.random() < OTHER_THINGS and is_named(samples[0], name):
                samples = [renamed(sample, name, other) for sample in samples if is_named(sample, name)]
                present.add(other)
        return samples

    def variant(self, around, before, said, labels, by_words):
        """The tokens of a variant of an utterance that are read, and those that are to be written."""
        chance, label = self.random.random, surest(labels)
        if not by_words and label not in WITHOUT_REQUEST and chance() < PLAIN_SHARE:
            before, said = [], self.joined(label.split("; "))
        while not by_words and chance() < 0.15:
            said, label = self.with_another(around, said, label)
        if chance() < 0.15:
            said = " ".join(slip(self.random, word) if chance() < 0.1 else word for word in said.split(" "))
        if chance() < 0.15:
            said = re.sub(r"[.,!?;:]", "", said)
        return language_model.turn(before, said, by_words), to_write(label)

    def seen(self, around):
        """What is around the robot, in another order, or nothing, now and then."""
        if not around or self.random.random() < BLIND_SHARE:
            return ""
        return mixed(self.random, around) if self.random.random() < MIXED_SHARE else around

    def with_another(self, around, said, label):
        """Two utterances in one message."""
        others = self.beginnings.get(around)
        if not others or label in ("?", "none"):
            return said, label
        other, labels = self.random.choice(others)
        asked = [one for one in [label, surest(labels)] if one != "social"]
        return self.joined([said, other]), "; ".join(asked) or "social"

    def joined(self, parts):
        """Parts of a message as one, in one of the ways in which people string them together."""
        text = parts[0]
        for part in parts[1:]:
            pause = " " if text.endswith(("?", "!")) else self.random.choice(PAUSES)
            text = text.rstrip(" .") + pause + part
        return text


def things(around):
    """The names of things in and on the furniture of a place."""
    listed = [part.split(": ")[1].split(", ") for part in around.split("; ") if part.count(": ") == 1]
    return {STATES.sub("", STATES.sub("", thing)) for part in listed for thing in part}


@cache
def as_word(name):
    return re.compile(rf"\b{re.escape(name)}\b", re.IGNORECASE)


def is_named(sample, name):
    """Whether who means a thing says its name: now or before."""
    _, before, said, labels, _ = sample
    word = as_word(name)
    return not any(map(word.search, labels)) or any(map(word.search, [said, *(text for _, text in before)]))


def renamed(sample, name, other):
    """A sample in which a thing is called otherwise by everybody."""
    around, before, said, labels, by_words = sample
    word = as_word(name)
    before = [(by_robot, word.sub(other, text)) for by_robot, text in before]
    return word.sub(other, around), before, word.sub(other, said), [word.sub(other, label) for label in labels], by_words


def mixed(drawn, around):
    """What is around the robot with its lists, and the parts that have one, in another order."""
    parts = [part.split(": ") for part in around.split("; ")]
    listed = [at for at, part in enumerate(parts) if len(part) == 2]
    for at, part in zip(listed, drawn.sample([parts[at] for at in listed], len(listed)), strict=True):
        things = part[1].split(", ")
        parts[at] = [part[0], ", ".join(drawn.sample(things, len(things)))]
    return "; ".join(": ".join(part) for part in parts)


def slip(drawn, word):
    """A word with a slip of the fingers."""
    if len(word) < 4 or not word.isalpha():
        return word
    at = drawn.randrange(1, len(word) - 1)
    return drawn.choice([word[:at] + word[at + 1 :], word[:at] + word[at + 1] + word[at] + word[at + 2 :], word[:at] + word[at] + word[at:]])


def surest(labels):
    """One of the labels that an utterance may have, always by the same rule, as what may be written in many ways is written with doubt."""
    if labels[0] in WITHOUT_REQUEST:
        return labels[0]
    return min((label for label in labels if label not in WITHOUT_REQUEST), key=len)


class Batches(IterableDataset):
    """Batches without end, which as many processes as are asked for draw ahead."""

    def __init__(self, seed, size, often, often_share=0.5):
        self.seed, self.size, self.often, self.often_share = seed, size, often, often_share

    def __iter__(self):
        worker = get_worker_info()
        return Samples(1000 * self.seed + (worker.id if worker else 0), self.often, self.often_share).batches(self.size)


def train(model, given):
    for layer in model.layers:
        layer.dropout = given.dropout
    trained = [one for one in model.parameters() if one.requires_grad]
    optimizer = torch.optim.AdamW(trained, weight_decay=0.01, betas=(0.9, 0.98), fused=True)
    batches = drawn(given, given.often, 0.5)
    for step in steps(model, optimizer, batches, given, lambda done: set_rounded(model, True) if done >= given.rounded_after else None):
        if step % 1000 == 0:
            print(f"step {step}, {measured(model, unseen())}", flush=True)
            if given.keep:
                torch.save(model.state_dict(), given.keep)
    if given.keep:
        torch.save(model.state_dict(), given.keep)


def drawn(given, often, share):
    """Batches without end, in which writers are drawn that often, and not all others."""
    on_gpu = given.device != "cpu"
    batches = Batches(given.seed, GPU_ROWS if on_gpu else ROWS, often, share)
    return DataLoader(batches, batch_size=None, num_workers=6 if on_gpu else 0)


def steps(model, optimizer, batches, given, before=lambda done: None):
    """Learns until the time is over, at a rate that falls with the share of it that is done; gives the number of each step that was taken.
    `before` is told that share ahead of each."""
    model.train()
    trained = [one for group in optimizer.param_groups for one in group["params"]]
    begun, losses = time.monotonic(), []
    for step, parts in enumerate(batches, 1):
        done = (time.monotonic() - begun) / (60 * given.minutes)
        if done >= 1:
            return
        before(done)
        for group in optimizer.param_groups:
            group["lr"] = given.rate * min(1, step / given.warm_up) * max(0.02, 1 - done)
        with torch.autocast(given.device, torch.bfloat16):
            loss = model.loss(*(part.to(given.device) for part in parts))
        optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(trained, 1.0)
        optimizer.step()
        losses = [*losses[-99:], loss.detach()]
        if step % 20 == 0:
            print(f"step {step}, {100 * done:.0f} %, loss {sum(losses).item() / len(losses):.3f}", flush=True)
        yield step


def set_rounded(model, is_rounded):
    for module in model.modules():
        if isinstance(module, language_model.Linear):
            module.is_rounded = is_rounded


@cache
def unseen():
    """Utterances of the talks and writers that nothing is fitted to."""
    talks = [sample for file in TALKS if file.stem in UNSEEN_TALKS for sample in of_talk(file)]
    return [*talks, *(sample for writer in sorted(UNSEEN) for sample in of_writer(writer))]


def measured(model, samples):
    """The loss, a token, and how often what the model would write is one of the labels, to the letter."""
    was_training = model.training
    model.eval()
    rows = [
        (len(read) + len(label), read, to_write(label), at, label == surest(labels))
        for at, (around, before, said, labels, _) in enumerate(samples)
        for read in [language_model.prompt(around, before, said, False)]
        for label in labels
    ]
    rows.sort(key=lambda row: row[0])
    loss, count, written = 0.0, 0, set()
    device = model.marks.weight.device
    for begin in range(0, len(rows), MEASURED):
        group = rows[begin : begin + MEASURED]
        read, wanted = batch([row[1:3] for row in group])
        with torch.autocast(device.type, torch.bfloat16):
            found = model.likelihood(read.to(device), wanted.to(device))
        for (_, _, label, at, is_surest), log, is_likeliest in zip(group, *found, strict=True):
            written |= {at} if is_likeliest else set()
            loss, count = (loss - log, count + len(label)) if is_surest else (loss, count)
    model.train(was_training)
    return f"unseen: loss {loss / count:.3f}, {len(written)} of {len(samples)} as labelled"


def to_write(label):
    """The tokens of a label."""
    return [*language_model.tokens(label)[:MOST_WRITTEN], END]


def batch(samples):
    """What is read, and which token is to follow each place; -1, where that is not learnt."""
    length = max(len(read) + len(written) for read, written in samples) - 1
    length += -length % LENGTH_STEP
    read_rows = torch.zeros(len(samples), length, dtype=torch.long)
    wanted = torch.full((len(samples), length), -1)
    for at, (read, written) in enumerate(samples):
        row = [*read, *written]
        read_rows[at, : len(row) - 1] = torch.tensor(row[:-1])
        wanted[at, len(read) - 1 : len(row) - 1] = torch.tensor(written)
    return read_rows, wanted


def key(label):
    """A label without its articles."""
    text = re.sub(r"\b(?:the|a|an|my|some)\b", "", label.lower())
    text = re.sub(r"\bif ([^:;]+): ", r"if \1, ", text)
    return re.sub(r"[^a-z0-9;?]+", " ", text).replace(" ;", ";").replace(" ?", "?").strip()


def compare(model, writer):
    """How many utterances are rewritten as one of their labels."""
    talk = next((file for file in TALKS if file.stem == writer), None)
    samples = list(of_talk(talk) if talk else of_writer(writer))
    outputs = model.write([language_model.prompt(around, before, said, False) for around, before, said, *_ in samples], MOST_WRITTEN)
    right = sum(key(text) in map(key, labels) for (text, _), (*_, labels, _) in zip(outputs, samples, strict=True))
    print(f"{writer}: {right} of {len(samples)} as labelled", flush=True)


def write_reference(model, file):
    """What the model makes of some utterances, for the Rust code to be compared with."""
    samples = random.Random(SEED).sample([sample for writer in ("bj", "bk", "e", "ax") for sample in of_writer(writer)], 40)
    outputs = model.write([language_model.prompt(around, before, said, False) for around, before, said, *_ in samples], MOST_WRITTEN)
    rows = []
    for (around, before, said, *_), (text, log_probability) in zip(samples, outputs, strict=True):
        row = {"around": around, "before": before, "said": said, "text": text, "log_probability": round(log_probability, 3)}
        rows.append(json.dumps(row, ensure_ascii=False))
    file.write_text("[\n" + ",\n".join(rows) + "\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
