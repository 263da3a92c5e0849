"""The corpus of labelled dialogs."""

from dataclasses import dataclass
from pathlib import Path

CRATE = Path(__file__).resolve().parent.parent
WRITERS = CRATE.parent / "language/tests/utterances/writers"
#: Nothing is ever fitted to these speakers.
HELD_OUT = {"camille", "gloria", "hiro", "nneka", "stefan"}


@dataclass(frozen=True)
class Sample:
    """An utterance with what was said before it, and what it means."""

    speaker: str
    utterance: str
    #: (whether the robot said it, text), the latest last
    before: list
    #: the label as text
    label: str


def samples():
    """All labelled utterances."""
    for file in sorted((CRATE / "corpus").glob("*.txt")):
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
            yield Sample(file.stem, utterance, list(before), content)
            before.append((False, utterance))
