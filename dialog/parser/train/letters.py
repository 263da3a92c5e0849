"""Labels as letters: symbols of a closed alphabet, and words of the input where a description begins and ends.

A letter is the name of a symbol, or `(START, word)`, or `(END, word)`. `src/symbol.rs` reads the names.
"""

import re
from functools import cache

import corpus

START, END = "start", "end"
ANSWERS = ["yes", "no", "any", "both", "none of them", "I do not know"]
SOCIAL = ["greeting", "thanks", "praise", "complaint", "apology", "bye", "agreement", "small talk"]
CONDITIONS = {"if": "IF", "unless": "UNLESS", "when": "WHEN", "until": "UNTIL"}
INQUIRIES = {"can you": "CAN", "how do I": "HOW", "did you": "DID", "why did you": "WHY"}
#: Words that a description may have though nobody said them.
WORDS = ["it", "them", "that", "there", "me", "this", "in", "on", "with", "of", "not", "no", "is", "the"]

FORMS = list(dict.fromkeys(corpus.singular(form) for form in corpus.forms()))
PLACES = {form: corpus.places(form) for form in FORMS}
PLACES |= dict.fromkeys(["IF", "UNLESS", "WHEN", "UNTIL", "MANNER", "UNKNOWN", "GOAL", "TELL", "ANSWER"], 1)
RELATIONS = ["also", "instead"]
PREFIXES = ["NOT", *INQUIRIES.values()]
COMMANDS = [*FORMS, "UNKNOWN"]
ACTS = [
    *COMMANDS, "GOAL", "TELL", "NONE", "ANSWER",
    *(f"answer:{answer}" for answer in ANSWERS), *(f"social:{kind}" for kind in SOCIAL),
]  # fmt: skip
ALPHABET = [
    "<eos>", *RELATIONS, *CONDITIONS.values(), "OTHERWISE", *PREFIXES, "MANNER", "CONT",
    *(f"const:{word}" for word in WORDS), *ACTS,
]  # fmt: skip

NUMBERS = {word: str(number) for number, word in enumerate(
    "zero one two three four five six seven eight nine ten eleven twelve".split())}  # fmt: skip
NUMBERS |= {"fifteen": "15", "twenty": "20", "thirty": "30", "forty": "40", "fifty": "50", "sixty": "60", "ninety": "90"}
NUMBERS |= {"a": "1", "an": "1", "couple": "2"}
#: Words of labels that need not have been said.
SPARE = set("a an are my your s ' to and be i , there with some by at from has have".split())
ALIKE = [{"i", "you"}, {"my", "your"}, {"is", "'s"}, {"me", "you"}, {"are", "'re"}, {"has", "'s"}, {"i", "me"}]
MOST_PARTS = 4


class Unsayable(Exception):
    """A label has a description that cannot be made of what was said."""


def encode(sample):
    """The letters of a label, and how far they are from its text; None where it cannot be written."""
    said = sample.words
    begin = sample.begin
    # Words of the utterance are preferred to those said before, late ones to early ones.
    far = [0.6 - 0.1 * at / max(1, begin) if at < begin else 0.0 for at in range(len(said))]
    letters, cost = [], 0.0
    try:
        for request in sample.label.split("; "):
            encoder = Encoder(said, begin, far)
            encoder.request(request)
            letters += encoder.letters
            cost += encoder.cost
    except Unsayable:
        return None, 0.0
    return letters, cost


class Encoder:
    """Writes one request."""

    def __init__(self, said, begin, far):
        self.said, self.begin, self.far = said, begin, far
        self.letters, self.cost = [], 0.0

    def request(self, text):
        manner = None
        if match := re.match(r"^(.*) \{([^{}]*)\}$", text):
            text, manner = match.groups()
        while True:
            word, _, rest = text.partition(" ")
            if word in ("also:", "instead:", "otherwise:"):
                self.letters.append(word[:-1] if word != "otherwise:" else "OTHERWISE")
                text = rest
            elif word in CONDITIONS:
                statement, text = rest.split(": ", 1)
                self.letters.append(CONDITIONS[word])
                self.description(statement, is_loose=True)
            else:
                break
        self.act(text)
        if manner is not None:
            self.letters.append("MANNER")
            self.description(manner, is_loose=True)

    def act(self, text, is_inner=False):
        kind, _, content = text.partition(": ")
        if text == "none":
            self.letters.append("NONE")
        elif f"{kind}:{content}" in ACTS:
            self.letters.append(f"{kind}:{content}")
        elif kind in ("answer", "goal", "tell"):
            self.letters.append(kind.upper())
            self.description(content, is_loose=True)
        elif text.startswith("do not "):
            self.letters.append("NOT")
            self.act(text.removeprefix("do not "), is_inner=True)
        elif text.startswith("*"):
            self.letters.append("UNKNOWN")
            self.description(text[1:], is_loose=True)
        elif not self.command(text):
            inquiry = next((words for words in INQUIRIES if text.startswith(f"{words} ") and text.endswith("?")), None)
            if inquiry:
                self.letters.append(INQUIRIES[inquiry])
                self.act(text[len(inquiry) + 1 : -1], is_inner=True)
            elif is_inner:
                self.letters.append("UNKNOWN")
                self.description(text, is_loose=True)
            else:
                raise Unsayable(text)

    def command(self, text):
        """The form and the descriptions that fit what was said best."""
        options = readings(text)
        if not options:
            return False
        best = self.cheapest((form, arguments, 0) for form, arguments in options)
        # Where a description was never said: a form without it.
        best = best or self.cheapest((shorter(form), arguments, 1) for form, arguments in options if shorter(form))
        best = best or self.cheapest(((*options[0], 2),), is_loose=True)
        self.letters += best[1]
        self.cost += best[0]
        return True

    def cheapest(self, options, is_loose=False):
        best = None
        for form, arguments, cost in options:
            trial = Encoder(self.said, self.begin, self.far)
            trial.letters.append(form)
            trial.cost = cost
            try:
                for argument in arguments[: PLACES[form]]:
                    trial.description(argument, is_loose)
            except Unsayable:
                continue
            if best is None or trial.cost < best[0] - 1e-6:
                best = (trial.cost, trial.letters)
        return best

    def description(self, text, is_loose=False):
        """A description as stretches of what was said; a loose one may be what comes nearest."""
        words = corpus.words(text)
        cost, parts = align(words, self.said, self.far)
        is_bad = not parts or len(parts) > 1 and all(isinstance(part, str) for part in parts)
        if is_bad:
            if not is_loose:
                raise Unsayable(text)
            parts, cost = self.nearest(words), 1.0
        elif len(words) == 1 and words[0] in WORDS and words[0] not in self.said[self.begin :]:
            parts = (words[0],)
        self.cost += cost
        for at, part in enumerate(parts):
            if at:
                self.letters.append("CONT")
            self.letters += [f"const:{part}"] if isinstance(part, str) else [(START, part[0]), (END, part[1])]

    def nearest(self, words):
        """The stretch of the utterance that has most of the words; else all of it."""
        content = [word for word in words if word not in SPARE]
        here = range(self.begin, len(self.said))
        hits = [at for at in here if any(difference(word, self.said[at]) is not None for word in content)]
        if content and len(hits) >= max(1, len(content) / 2):
            return ((hits[0], hits[-1]),)
        last = len(self.said) - 1
        while last > self.begin and self.said[last] in ".,!?;:":
            last -= 1
        if self.begin > last:
            raise Unsayable(" ".join(words))
        return ((self.begin, last),)


def align(label, said, far):
    """The cheapest way to write words as stretches of what was said: `(cost, parts)`.

    A part is `(first, last)`, or a word that nobody said.
    """
    best = [(float("inf"), ())] * (len(label) + 1)
    best[0] = (0.0, ())

    def offer(at, cost, parts):
        if cost < best[at][0]:
            best[at] = (cost, parts)

    for at, word in enumerate(label):
        cost, parts = best[at]
        if cost == float("inf"):
            continue
        if word in SPARE or word == "the":
            offer(at + 1, cost + (0.4 if word == "the" else 0.7), parts)
        if len(parts) >= MOST_PARTS:
            continue
        if word in WORDS:
            offer(at + 1, cost + 1.3, (*parts, word))
        for first in range(len(said)):
            step = difference(word, said[first])
            if step is None:
                continue
            goes_back = bool(parts) and not isinstance(parts[-1], str) and first <= parts[-1][1]
            total = cost + 1 + far[first] + step + 0.3 * goes_back
            to, last = at + 1, first
            offer(to, total, (*parts, (first, last)))
            while to < len(label) and last + 1 < len(said):
                step = difference(label[to], said[last + 1])
                if step is None:
                    break
                total += step + 0.1 * far[last + 1]
                to, last = to + 1, last + 1
                offer(to, total, (*parts, (first, last)))
    return best[-1]


@cache
def difference(wanted, said):
    """How much a said word differs from the wanted one; None where it is another word."""
    if wanted == said:
        return 0.0
    if NUMBERS.get(said) == wanted or NUMBERS.get(wanted) == said:
        return 0.1
    if {wanted, said} in ALIKE:
        return 0.15
    if len(wanted) > 3 and (wanted + "s" == said or said + "s" == wanted):
        return 0.2
    return 0.3 if is_slip(wanted, said) else None


def is_slip(one, other):
    """Whether two words of four letters or more differ by one slip of the fingers."""
    if abs(len(one) - len(other)) > 1 or min(len(one), len(other)) < 4:
        return False
    at = next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))
    swapped = one[at : at + 2] == other[at : at + 2][::-1] and one[at + 2 :] == other[at + 2 :]
    return (
        one[at + 1 :] == other[at + 1 :] or one[at:] == other[at + 1 :] or one[at + 1 :] == other[at:] or swapped
    )


def pattern(form):
    out = []
    for word in form.split(" "):
        bare = word.rstrip("?:")
        group = {"X": "(.+?)", "Y": "(.+?)", "#": r"([\d.]+)"}.get(bare, re.escape(bare))
        out.append(group + re.escape(word[len(bare) :]))
    return re.compile(f"^{' '.join(out)}$")


PATTERNS = [(form, pattern(form)) for form in corpus.forms()]


def readings(text):
    """All `(form, descriptions)` that make a text."""
    found = []
    for form, regex in PATTERNS:
        match = regex.match(text)
        if not match:
            continue
        found.append((corpus.singular(form), list(match.groups())))
        if "Y" not in form:
            continue
        # other places to cut: `put the mug in the sink in the bin`
        head, rest = form.split("X", 1)
        middle, tail = rest.split("Y", 1)
        inner = text[len(head) : len(text) - len(tail)]
        for cut in re.finditer(f"(?={re.escape(middle)})", inner):
            arguments = [inner[: cut.start()], inner[cut.start() + len(middle) :]]
            if all(arguments) and arguments != found[-1][1]:
                found.append((corpus.singular(form), arguments))
    return found


@cache
def shorter(form):
    """The form without its last description, where there is one."""
    shorter = re.sub(r" (# (meter|degrees|second|minute)|(in|with|on|to) [XY]|to me)$", "", form)
    return shorter if shorter != form and shorter in PLACES else None


def decode(letters, said):
    """The label that letters stand for."""
    requests, current, is_question = [], "", False
    rest = list(letters)

    def description():
        parts = []
        while rest:
            if isinstance(rest[0], str) and rest[0].startswith("const:"):
                parts.append(rest.pop(0).removeprefix("const:"))
            elif len(rest) > 1 and not isinstance(rest[0], str):
                (_, first), (_, last) = rest.pop(0), rest.pop(0)
                parts.append(" ".join(said[first : last + 1]))
            if not rest or rest[0] != "CONT":
                break
            rest.pop(0)
        return " ".join(parts)

    while rest:
        letter = rest.pop(0)
        if letter == "<eos>" or not isinstance(letter, str):
            continue
        if letter == "MANNER":
            requests[-1:] = [f"{requests[-1]} {{{description()}}}"] if requests else []
        elif letter in RELATIONS:
            current += f"{letter}: "
        elif letter in CONDITIONS.values():
            current += f"{letter.lower()} {description()}: "
        elif letter == "OTHERWISE":
            current += "otherwise: "
        elif letter == "NOT":
            current += "do not "
        elif letter in INQUIRIES.values():
            current += f"{next(words for words, name in INQUIRIES.items() if name == letter)} "
            is_question = True
        elif letter in ACTS:
            if letter in FORMS:
                filled = re.sub(r"\b[XY]\b|#", lambda _: description(), letter)
            elif letter == "UNKNOWN":
                filled = f"*{description()}"
            elif letter in ("GOAL", "TELL", "ANSWER"):
                filled = f"{letter.lower()}: {description()}"
            else:
                filled = letter.lower() if letter == "NONE" else letter.replace(":", ": ", 1)
            requests.append(current + filled + ("?" if is_question else ""))
            current, is_question = "", False
    return "; ".join(requests)


def plain(label):
    """A label without what makes no difference, to compare: articles, plurals of forms, marks, numbers in words."""
    requests = []
    for request in label.split("; "):
        request = re.sub(r"\b(where|whose|why|what|what color) are\b(?! you)", r"\1 is", request)
        request = re.sub(r"^((?:also: |instead: )?)are ", r"\1is ", request)
        request = re.sub(r"\b(meter|second|minute)s\b", r"\1", request)
        said = corpus.words(request)
        requests.append(" ".join(NUMBERS.get(word, word) for word in said if word not in {*"a an the , . ! ? ' *".split()}))
    return "; ".join(requests)
