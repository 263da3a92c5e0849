"""Fits an adapter of the rewriter to some writers: a change of low rank of each matrix (Hu et al. 2021, LoRA), beside which the model stays as it is.

    python adapt.py --minutes 25 --to ja jb jc         writes ../household.safetensors

`src/tensors.rs` adds `NAME.up` times `NAME.down` to a matrix before it is rounded to 8 bits. README.md says what it needs.
"""

import argparse
from pathlib import Path

import torch
import torch.nn.functional as F
from safetensors.torch import load_file, save_file
from torch import nn

import corpus
import fit
import language_model
from language_model import LanguageModel


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--to", nargs="*", default=[], help="the writers that it is fitted to")
    options.add_argument("--share", type=float, default=0.85, help="how often one of these is drawn, and not one of all others")
    options.add_argument("--minutes", type=float, default=30, help="how long to train")
    options.add_argument("--rate", type=float, default=1e-3, help="the highest rate of learning")
    options.add_argument("--warm-up", type=int, default=10, help="how many steps it takes to get to that rate")
    options.add_argument("--rank", type=int, default=16, help="the rank of the changes")
    options.add_argument("--seed", type=int, default=fit.SEED, help="what is drawn by chance")
    options.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu", help="cpu or cuda")
    options.add_argument("--model", type=Path, default=corpus.CRATE / "rewriter.safetensors", help="the model that is adapted")
    options.add_argument("--begin", type=Path, help="an adapter to go on with")
    options.add_argument("--compare", nargs="*", default=[], help="writers or talks whose utterances are then rewritten and compared")
    options.add_argument("--out", type=Path, default=corpus.CRATE / "household.safetensors", help="the adapter")
    options.add_argument("--reference", type=Path, help="where to write what the adapted model makes of some utterances")
    given = options.parse_args()
    torch.manual_seed(given.seed)
    model = LanguageModel()
    model.take(load_file(given.model))
    changes = adapt(model, given.rank)
    if given.begin:
        take(changes, load_file(given.begin))
    model.to(given.device)
    if given.minutes:
        train(model, changes, given)
    keep(changes, given.out)
    given.out.chmod(0o644)
    model.eval()
    for change in changes.values():
        change.merge()
    for writer in given.compare:
        fit.compare(model, writer)
    if given.reference:
        fit.write_reference(model, given.reference)


class Change(nn.Module):
    """A matrix that is not learnt, and a change of low rank that is."""

    def __init__(self, linear, rank):
        super().__init__()
        outputs, inputs = linear.weight.shape
        self.weight = nn.Parameter(linear.weight.data.bfloat16(), requires_grad=False)
        self.down = nn.Parameter(torch.randn(rank, inputs) * inputs**-0.5)
        self.up = nn.Parameter(torch.zeros(outputs, rank))

    def forward(self, x):
        return F.linear(x.to(self.weight.dtype), self.weight) + F.linear(F.linear(x, self.down), self.up)

    def merge(self):
        """Leaves one matrix, which computes the same faster."""
        whole = self.weight.float() + self.up.detach().bfloat16().float() @ self.down.detach().bfloat16().float()
        self.weight = nn.Parameter(whole, requires_grad=False)
        self.forward = lambda x: F.linear(x, self.weight)


def adapt(model, rank):
    """Puts a change beside each matrix; by the matrices' names."""
    model.requires_grad_(False)
    changes = {}
    for name, module in list(model.named_modules()):
        if isinstance(module, language_model.Linear):
            parent, _, own = name.rpartition(".")
            changes[name] = Change(module, rank)
            setattr(model.get_submodule(parent), own, changes[name])
    return changes


def tensors(changes):
    """The adapter as `src/tensors.rs` reads it."""
    parts = {}
    for name, change in changes.items():
        parts[f"{name}.up"], parts[f"{name}.down"] = change.up.detach().bfloat16(), change.down.detach().bfloat16()
    return parts


def take(changes, adapter):
    """The numbers that `tensors` made of changes."""
    for name, change in changes.items():
        change.up.data, change.down.data = adapter[f"{name}.up"].float(), adapter[f"{name}.down"].float()


def train(model, changes, given):
    trained = [one for change in changes.values() for one in (change.up, change.down)]
    optimizer = torch.optim.AdamW(trained, weight_decay=0.0, betas=(0.9, 0.98))
    for step in fit.steps(model, optimizer, fit.drawn(given, given.to, given.share), given):
        if step % 50 == 0:
            keep(changes, given.out)


def keep(changes, file):
    save_file({name: one.contiguous().cpu() for name, one in tensors(changes).items()}, file)


if __name__ == "__main__":
    main()
