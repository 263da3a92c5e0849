"""The corpus of labelled dialogs: lines, words and forms."""

import re
from dataclasses import dataclass, field
from pathlib import Path

CRATE = Path(__file__).resolve().parent.parent
WRITERS = CRATE.parent / "language/tests/utterances/writers"
#: What writers write where no plain request is meant.
UNLABELLED = {"?", "social"}
#: Nothing is ever fitted to these speakers.
HELD_OUT = {"camille", "gloria", "hiro", "nneka", "stefan"}

#: As `src/words.rs` has it.
WORD = re.compile(r"['’](?:s|t|re|ll|ve|d|m)\b|[^\W_]+|[^\w\s]|_", re.IGNORECASE)

MOST_LINES, MOST_LINE_WORDS, MOST_CONTEXT_WORDS, MOST_WORDS = 4, 30, 60, 120
ROBOT, PERSON, NOW = "<robot>", "<person>", "<now>"


def words(text):
    return [match.group().lower().replace("’", "'") for match in WORD.finditer(text)]


@dataclass(frozen=True)
class Sample:
    """An utterance with what was said before it, and what it means."""

    speaker: str
    utterance: str
    #: (whether the robot said it, text), the latest last
    before: list
    #: the label as text
    label: str
    #: words of the lines before, then of the utterance, with a mark before each line
    words: list
    #: where the utterance begins
    begin: int
    #: what the network is to write; None where the label cannot be written so
    letters: list = field(default=None)


def source(before, utterance):
    """What the network reads, and where the utterance begins in it."""
    context, left = [], MOST_CONTEXT_WORDS
    for by_robot, text in reversed(before[-MOST_LINES:]):
        line = words(text)[:MOST_LINE_WORDS]
        if len(line) > left:
            break
        left -= len(line)
        context = [ROBOT if by_robot else PERSON, *line, *context]
    return [*context, NOW, *words(utterance)[:MOST_WORDS]], len(context) + 1


def samples(speakers=None):
    """All labelled utterances of these speakers, or of all."""
    for file in sorted((CRATE / "corpus").glob("*.txt")):
        if speakers is None or file.stem in speakers:
            yield from dialog_samples(file)


def dialog_samples(file):
    before, utterance = [], ""
    for line in file.read_text(encoding="utf-8").splitlines():
        mark, content = line[:1], line[1:].strip()
        if mark == "#":
            before = []
        elif mark in "<~" and mark:
            before.append((mark == "<", content))
        elif mark == ">":
            utterance = content
        elif mark == "=":
            read, begin = source(before, utterance)
            yield Sample(file.stem, utterance, before[-MOST_LINES:], content, read, begin)
            before = [*before, (False, utterance)]


def written(writers):
    """Utterances of `dialog/language/tests/utterances/writers`, with each plain request that they may mean."""
    for writer in writers:
        for line in (WRITERS / f"{writer}.txt").read_text(encoding="utf-8").splitlines():
            said, arrow, meant = line.partition(" => ")
            if not arrow or line.startswith("#"):
                continue
            *earlier, utterance = said.split(" / ")
            before = [(False, one) for one in earlier]
            read, begin = source(before, utterance)
            for label in meant.split(" || "):
                if label not in UNLABELLED:
                    label = re.sub(r"\b(if|unless|when) ([^,;]+), ", r"\1 \2: ", label.strip())
                    yield Sample(f"writer {writer}", utterance, before[-MOST_LINES:], label, read, begin)


def forms():
    """The forms of plain requests, those of plural things written as of one."""
    lines = (line.strip() for line in (CRATE / "data/forms.txt").read_text(encoding="utf-8").splitlines())
    return [line for line in lines if line and not line.startswith("# ")]


def singular(form):
    """The form of one thing that means the same: `where are X?` is `where is X?`."""
    form = re.sub(r"^where are X", "where is X", form)
    form = re.sub(r"^what are X", "what is X", form)
    form = re.sub(r"^what color are", "what color is", form)
    form = re.sub(r"^are (there )?X", lambda match: f"is {match.group(1) or ''}X", form)
    form = re.sub(r"^how far are", "how far is", form)
    form = re.sub(r"^(whose|why) are", r"\1 is", form)
    form = form.replace("which X are Y", "which X is Y")
    return re.sub(r"# (meter|second|minute)s\b", r"# \1", form)


def places(form):
    """How many descriptions a form has."""
    return len(re.findall(r"\b[XY]\b|#", form))
