"""What may follow what in the output, as `src/grammar.rs` has it."""

from dataclasses import dataclass, replace

import torch

from letters import ACTS, ALPHABET, COMMANDS, CONDITIONS, PLACES, PREFIXES, RELATIONS, START

PARTS = [symbol for symbol in ALPHABET if symbol.startswith("const:")]
BEGINNINGS = [*CONDITIONS.values(), "OTHERWISE", *PREFIXES, *ACTS]


def mask(symbols):
    allowed = torch.zeros(len(ALPHABET), dtype=torch.bool)
    allowed[[ALPHABET.index(symbol) for symbol in symbols]] = True
    return allowed


NO_SYMBOL, PART, CONTINUED, COMMAND, BEGINNING, RELATION, FINISH, MANNER = map(
    mask, ([], PARTS, ["CONT"], COMMANDS, BEGINNINGS, RELATIONS, ["<eos>"], ["MANNER"])
)


@dataclass(frozen=True)
class State:
    """What has been written so far, as far as it decides on what may follow."""

    #: "begun", "condition" or "prefix"
    progress: str = "begun"
    has_act: bool = False
    may_have_manner: bool = False
    needed: int = 0
    start: int | None = None
    after_part: bool = False

    def allowed(self, said, words):
        """Which letters may be next, of an input of `said` words padded to `words`."""
        starts, ends = torch.zeros(2, words, dtype=torch.bool)
        symbols = NO_SYMBOL
        if self.start is not None:
            ends[self.start : said] = True
        elif self.needed:
            starts[:said] = True
            symbols = PART
        elif self.progress == "prefix":
            symbols = COMMAND
        elif self.progress == "condition":
            symbols = BEGINNING
        else:
            symbols = BEGINNING | RELATION
            if self.has_act:
                symbols = symbols | FINISH
            if self.may_have_manner:
                symbols = symbols | MANNER
        if self.after_part and self.start is None:
            symbols = symbols | CONTINUED
        return torch.cat([symbols, starts, ends])

    def after(self, letter):
        if not isinstance(letter, str):
            if letter[0] == START:
                return replace(self, start=letter[1])
            return replace(self, start=None, needed=max(0, self.needed - 1), after_part=True)
        if letter in PARTS:
            return replace(self, needed=max(0, self.needed - 1), after_part=True)
        if letter == "CONT":
            return replace(self, needed=self.needed + 1, after_part=False)
        needed = PLACES.get(letter, 0)
        if letter in RELATIONS or letter in CONDITIONS.values() or letter == "OTHERWISE":
            return replace(self, progress="condition", needed=needed, after_part=False)
        if letter in PREFIXES:
            return replace(self, progress="prefix", needed=needed, after_part=False)
        return State("begun", has_act=True, may_have_manner=letter != "MANNER", needed=needed)
