"""Write a GGUF model that llama.cpp runs: two layers, random weights, a real tokenizer.

The tokenizer is byte-level BPE whose merges are learned from a text, so that it reads anything,
and has tokens of one to a dozen characters like that of any model.
"""

import re
from collections import Counter
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

import gguf
import numpy as np

SPECIAL = ("<|im_start|>", "<|im_end|>")
CHAT = (
    "{% for m in messages %}<|im_start|>{{ m.role }}\n{{ m.content }}<|im_end|>\n{% endfor %}"
    "{% if add_generation_prompt %}<|im_start|>assistant\n{% endif %}"
)


def write_model(path: Path, text: str, *, context: int = 16384, seed: int = 0) -> Path:
    """Write the model.

    Args:
        path: The file.
        text: What the tokenizer learns its merges from.
        context: The context length that it was "trained" for.
        seed: Seed of the weights.
    """
    rng = np.random.default_rng(seed)
    width, layers, heads, hidden = 32, 2, 2, 64
    merges = learn_merges(text, 200)
    tokens = [*SPECIAL, *byte_letters().values(), *("".join(pair) for pair in merges)]
    out = gguf.GGUFWriter(path, "llama")
    out.add_context_length(context)
    out.add_embedding_length(width)
    out.add_block_count(layers)
    out.add_feed_forward_length(hidden)
    out.add_head_count(heads)
    out.add_head_count_kv(heads)
    out.add_layer_norm_rms_eps(1e-5)
    out.add_tokenizer_model("gpt2")
    out.add_tokenizer_pre("gpt-2")
    out.add_token_list(tokens)
    special = [gguf.TokenType.CONTROL] * len(SPECIAL)
    out.add_token_types(special + [gguf.TokenType.NORMAL] * (len(tokens) - len(SPECIAL)))
    out.add_token_merges([" ".join(pair) for pair in merges])
    out.add_eos_token_id(1)
    out.add_bos_token_id(0)
    out.add_add_bos_token(False)
    out.add_chat_template(CHAT)

    def tensor(name: str, *shape: int) -> None:
        out.add_tensor(f"{name}.weight", 0.3 * rng.standard_normal(shape, dtype=np.float32))

    def ones(name: str) -> None:
        out.add_tensor(f"{name}.weight", np.ones(width, dtype=np.float32))

    tensor("token_embd", len(tokens), width)
    tensor("output", len(tokens), width)
    ones("output_norm")
    for layer in range(layers):
        ones(f"blk.{layer}.attn_norm")
        ones(f"blk.{layer}.ffn_norm")
        for part in ("attn_q", "attn_k", "attn_v", "attn_output"):
            tensor(f"blk.{layer}.{part}", width, width)
        tensor(f"blk.{layer}.ffn_gate", hidden, width)
        tensor(f"blk.{layer}.ffn_up", hidden, width)
        tensor(f"blk.{layer}.ffn_down", width, hidden)
    out.write_header_to_file()
    out.write_kv_data_to_file()
    out.write_tensors_to_file()
    out.close()
    return path


def byte_letters() -> dict[int, str]:
    """The letter that stands for each byte in GPT-2's vocabulary."""
    plain = [*range(33, 127), *range(161, 173), *range(174, 256)]
    others = (b for b in range(256) if b not in plain)
    shown = {b: chr(b) for b in plain} | {b: chr(256 + n) for n, b in enumerate(others)}
    return dict(sorted(shown.items()))


def learn_merges(text: str, count: int) -> list[tuple[str, str]]:
    """Byte-pair encoding: join the most frequent pair, again and again."""
    letters = byte_letters()
    pieces = Counter(re.findall(r" ?[A-Za-z]+| ?[^\sA-Za-z]+|\s+", text))
    words = {tuple(letters[b] for b in piece.encode()): n for piece, n in pieces.items()}
    merges: list[tuple[str, str]] = []
    while len(merges) < count:
        pairs: Counter[tuple[str, str]] = Counter()
        for word, times in words.items():
            for pair in pairwise(word):
                pairs[pair] += times
        if not pairs:
            break
        best = max(pairs, key=lambda p: (pairs[p], p))
        merges.append(best)
        words = {tuple(joined(word, best)): n for word, n in words.items()}
    return merges


def joined(word: tuple[str, ...], pair: tuple[str, str]) -> Iterable[str]:
    """A word with a pair of neighbours made one."""
    at = 0
    while at < len(word):
        here = word[at : at + 2]
        yield "".join(here) if here == pair else word[at]
        at += 2 if here == pair else 1
