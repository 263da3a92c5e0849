"""Variants of samples: other things spoken of, two requests at once, fillers, lost punctuation, slips of the fingers."""

import random
import re
from dataclasses import replace
from functools import partial

import corpus
import letters
from letters import END, START

MOST_LETTERS, MOST_WORDS = 38, 150
DETERMINERS = set("the a an my that this those these his her your our some all both".split())
PRONOUNS = set("it them that this one there here those these me you everything nothing anything".split())
LOOKS = "red green blue yellow black white purple orange brown gray pink silver small big large old clean dirty empty full broken".split()
NEAR = ["on the", "in the", "next to the", "by the", "near the"]
FILLERS = ["please", "um", "uh", "ok", "so", "well", "hey", "right", "listen", "robot", "hey robot", "could you please",
           "alright", "and", "oh", "just"]  # fmt: skip
JOINTS = ["and then", ",", ".", "and", "then", ", then", ", and", ". then", ". also", ". oh and", "and also", "after that", ""]
#: A word that the network does not know.
UNKNOWN = "□"
#: What makes no sense without the lines before.
BOUND = {*letters.RELATIONS, "ANSWER", "OTHERWISE", "again", "go on", "undo"}


class Augmenter:
    """Draws variants of samples; the same for the same seed."""

    def __init__(self, samples, names, told, seed):
        self.samples = samples
        self.random = random.Random(seed)
        self.things = self.named(samples, names) + [corpus.words(said) for said in told]
        self.forms = [form for form in letters.FORMS if letters.PLACES[form]]

    def draw(self):
        """A variant of any sample, or a plain request."""
        sample = self.plain() if self.random.random() < 0.08 else self.random.choice(self.samples)
        sample = self.varied(sample)
        fits = len(sample.letters) < MOST_LETTERS and len(sample.words) < MOST_WORDS
        return sample if fits else self.draw()

    def named(self, samples, names):
        """What things are called: in the samples, and the catalogue's names with other words around."""
        things = []
        for sample in samples:
            for first, last in descriptions(sample):
                said = sample.words[first : last + 1]
                is_fit = 2 <= len(said) <= 8 and said[0] in DETERMINERS and not PRONOUNS & set(said)
                if first >= sample.begin and is_fit and not any(word in ".,!?" for word in said):
                    things.append(said)
        for _ in range(len(things) // 2):
            said = ["the", *([self.random.choice(LOOKS)] if self.random.random() < 0.4 else [])]
            said += self.random.choice(names).split()
            if self.random.random() < 0.3:
                said += [*self.random.choice(NEAR).split(), *self.random.choice(names).split()]
            things.append(said)
        return things

    def plain(self):
        """A request as labels have it."""
        form = self.random.choice(self.forms)
        said, written = [corpus.NOW], [form]
        for word in re.findall(r"[a-zA-Z]+|[#?:]", form):
            part = [word.lower()]
            if word in ("X", "Y"):
                part = list(self.random.choice(self.things)) if self.random.random() < 0.8 else [self.random.choice(["it", "them", "that"])]
            elif word == "#":
                part = [str(self.random.choice([1, 2, 3, 5, 10, 30, 45, 90]))]
            if word in ("X", "Y", "#"):
                written += [(START, len(said)), (END, len(said) + len(part) - 1)]
            said += part
        return corpus.Sample("", "", [], "", said, 1, written)

    def varied(self, sample):
        chance = self.random.random
        if chance() < 0.55:
            sample = self.other_thing(sample)
        if is_free(sample):
            if chance() < 0.4:
                sample = without_context(sample)
            if chance() < 0.15 and len(sample.letters) < 12:
                sample = self.joined(sample)
        if chance() < 0.2:
            sample = insert(sample, sample.begin, self.random.choice(FILLERS).split())
        if chance() < 0.25:
            for at in reversed(range(sample.begin, len(sample.words))):
                if sample.words[at] in ".,!?;:-":
                    sample = without(sample, at)
        if chance() < 0.3 and len(sample.words) > sample.begin:
            said = list(sample.words)
            for _ in range(self.random.choice([1, 1, 2])):
                at = self.random.randrange(sample.begin, len(said))
                said[at] = self.slip(said[at])
            sample = replace(sample, words=said)
        if chance() < 0.5:
            sample = replace(sample, words=[self.unheard(sample, at) for at in range(len(sample.words))])
        return sample

    def other_thing(self, sample):
        """The same of another thing."""
        spans = [(first, last) for first, last in descriptions(sample) if first >= sample.begin]
        self.random.shuffle(spans)
        for first, last in spans[:2]:
            said = sample.words[first : last + 1]
            is_whole = all(
                isinstance(letter, str) or not first <= letter[1] <= last or letter in ((START, first), (END, last))
                for letter in sample.letters
            )
            if is_whole and said[0] in DETERMINERS and len(said) <= 10 and not PRONOUNS & set(said):
                other = list(self.random.choice(self.things))
                if self.random.random() < 0.5:
                    other[0] = said[0]
                return put(sample, first, last, other)
        return sample

    def joined(self, sample):
        """Two requests in one utterance."""
        other = self.random.choice(self.samples)
        is_asked = "NONE" not in (other.letters[0], sample.letters[0])
        said = sample.words[:-1] if sample.words[-1] in ".!" else sample.words
        is_whole = all(isinstance(letter, str) or letter[1] < len(said) for letter in sample.letters)
        if not (is_free(other) and len(other.letters) < 12 and is_asked and is_whole):
            return sample
        said = [*said, *self.random.choice(JOINTS).split()]
        shift = partial(moved, by=len(said) - other.begin)
        written = [*sample.letters, *(shift(letter) for letter in other.letters)]
        return replace(sample, words=[*said, *other.words[other.begin :]], letters=written)

    def unheard(self, sample, at):
        """One word of twelve is not known, so that no single one is relied on."""
        is_mark = sample.words[at].startswith("<")
        return sample.words[at] if is_mark or self.random.random() > 1 / 12 else UNKNOWN

    def slip(self, word):
        if len(word) < 4 or not word.isalpha():
            return word
        at, kind = self.random.randrange(1, len(word) - 1), self.random.random()
        if kind < 0.3:
            return word[:at] + word[at + 1 :]
        if kind < 0.6:
            return word[:at] + word[at + 1] + word[at] + word[at + 2 :]
        if kind < 0.8:
            return word[:at] + word[at] + word[at:]
        return word[:at] + self.random.choice("aeiostnr") + word[at + 1 :]


def descriptions(sample):
    pairs = zip(sample.letters, sample.letters[1:], strict=False)
    return [(first[1], last[1]) for first, last in pairs if first[0] == START and last[0] == END and len(first) == 2]


def is_free(sample):
    """Whether it means the same without the lines before."""
    return all(
        letter not in BOUND and not letter.startswith("answer:") if isinstance(letter, str) else letter[1] >= sample.begin
        for letter in sample.letters
    )


def moved(letter, by, beyond=-1):
    return letter if isinstance(letter, str) or letter[1] <= beyond else (letter[0], letter[1] + by)


def without_context(sample):
    by = 1 - sample.begin
    written = [moved(letter, by) for letter in sample.letters]
    return replace(sample, words=[corpus.NOW, *sample.words[sample.begin :]], begin=1, letters=written)


def put(sample, first, last, said):
    """Other words in the place of those from `first` to `last`."""
    by = len(said) - (last - first + 1)
    written = []
    for letter in sample.letters:
        if letter == (END, last):
            letter = (END, first + len(said) - 1)
        else:
            letter = moved(letter, by, beyond=last)
        written.append(letter)
    words = [*sample.words[:first], *said, *sample.words[last + 1 :]]
    return replace(sample, words=words, letters=written)


def insert(sample, at, said):
    written = [moved(letter, len(said), beyond=at - 1) for letter in sample.letters]
    return replace(sample, words=[*sample.words[:at], *said, *sample.words[at:]], letters=written)


def without(sample, at):
    if any(not isinstance(letter, str) and letter[1] == at for letter in sample.letters):
        return sample
    written = [moved(letter, -1, beyond=at) for letter in sample.letters]
    return replace(sample, words=[*sample.words[:at], *sample.words[at + 1 :]], letters=written)
