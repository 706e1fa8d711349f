"""Damage to files: seeded, so that a number stands for a damaged file."""

import random
import re
from collections.abc import Callable, Sequence

NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_*$][\w*$.]*")
NUMBERS = [
    *(
        b"0 -1 1 2 nan inf -inf 1e308 -1e308 1e-320 2147483647 2147483648 -2147483648 4294967295 "
        b"9223372036854775807 -9223372036854775808 18446744073709551616 "
        b"1e30 1.5 00 0x10 1_0 999999999"
    ).split(),
    b"9" * 5000,
]
TEXTS = (
    b"\0",
    b"\xff\xfe",
    b"\n",
    b"'",
    b'"',
    b"[",
    b"]",
    b"{",
    b"../",
    b"\xc3\xa9",
    b"<!ENTITY a 'b'>",
    b"*INCLUDE, INPUT=seed",
    b"INCLUDE 'seed'",
    b"[" * 2000,
    b"x" * 2000,
)
WORDS = [n.to_bytes(size, "little") for size in (1, 2, 4, 8) for n in (0, 1, 2 ** (8 * size) - 1)]
WORDS += [(2 ** (8 * size - 1)).to_bytes(size, "little") for size in (1, 2, 4, 8)]
WORDS += [n.to_bytes(8, "little") for n in (3, 255, 65535, 10**6, 10**9, 10**12, 10**15)]

Mutation = Callable[[random.Random, bytearray, Sequence[bytes]], None]


def mutated(number: int, seeds: Sequence[bytes]) -> bytes:
    """The damaged file of a number: one to four mutations of one of the seeds."""
    rng = random.Random(number)
    data = bytearray(rng.choice(seeds))
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        rng.choice(MUTATIONS)(rng, data, seeds)
    return bytes(data)


def _somewhere(rng: random.Random, data: bytearray) -> int:
    return rng.randrange(len(data) + 1)


def _flip(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    for _ in range(rng.choice((1, 1, 2, 8, 64))):
        if data:
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)


def _truncate(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    del data[_somewhere(rng, data) :]


def _cut(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    start = _somewhere(rng, data)
    del data[start : start + rng.choice((1, 2, 4, 8, 64, 1000))]


def _repeat(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    start = _somewhere(rng, data)
    piece = data[start : start + rng.choice((1, 8, 64, 1000))]
    data[start:start] = piece * rng.choice((1, 2, 50))


def _splice(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    """The end of another seed behind the beginning of this one."""
    other = rng.choice(seeds)
    data[_somewhere(rng, data) :] = other[rng.randrange(len(other) + 1) :]


def _swap_lines(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    lines = bytes(data).split(b"\n")
    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    data[:] = b"\n".join(lines)


def _insert(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    start = _somewhere(rng, data)
    data[start:start] = rng.choice(TEXTS)


def _word(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    """An integer of one to eight bytes, as binary formats declare sizes."""
    word, start = rng.choice(WORDS), _somewhere(rng, data)
    data[start : start + len(word)] = word


def _number(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    """Another number in the place of one."""
    if found := list(NUMBER.finditer(bytes(data))):
        match = rng.choice(found)
        data[match.start() : match.end()] = rng.choice(NUMBERS)


def _exchange(rng: random.Random, data: bytearray, seeds: Sequence[bytes]) -> None:
    """A word of a seed in the place of one."""
    found, others = list(WORD.finditer(bytes(data))), WORD.findall(rng.choice(seeds))
    if found and others:
        match = rng.choice(found)
        data[match.start() : match.end()] = rng.choice(others)


MUTATIONS: tuple[Mutation, ...] = (
    _flip,
    _truncate,
    _cut,
    _repeat,
    _splice,
    _swap_lines,
    _insert,
    _word,
    _number,
    _exchange,
)
