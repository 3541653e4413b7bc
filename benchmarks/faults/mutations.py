"""Damage to the bytes of a file, whatever its format, as by disks, downloads, editors and attackers."""

import random
import struct
from collections.abc import Callable, Sequence

INTERESTING = (0, 1, 2, 3, 8, 100, 127, 128, 255, 256, 4096, 32767, 32768, 65535, 65536, 2**20, 2**24, 2**30)
"""Integers at which sizes and counts go wrong, beside the largest of each width."""
HEADER_BYTES, TAIL_BYTES = 200, 80
LONGEST_SPAN = 400
MOST_STEPS = 4

Mutate = Callable[[bytes, random.Random], bytes]


def mutate_bytes(content: bytes, rng: random.Random, others: Sequence[bytes] = ()) -> bytes:
    """Apply some of these steps, one after the other; `others` are valid files to splice with."""
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, MOST_STEPS))):
        if others and rng.random() < 0.08:
            content = splice(content, rng.choice(others), rng)
        else:
            content = rng.choice(STEPS)(content, rng)
    return content


def choose_place(content: bytes, rng: random.Random) -> int:
    """Choose a position, half of the time near the beginning, sometimes near the end: sizes and counts are there."""
    draw = rng.random()
    if draw < 0.5:
        return rng.randrange(min(len(content), HEADER_BYTES) + 1)
    if draw < 0.65:
        return max(0, len(content) - rng.randrange(TAIL_BYTES))
    return rng.randrange(len(content) + 1)


def splice(content: bytes, other: bytes, rng: random.Random) -> bytes:
    """Join the beginning of one file and the end of another, or replace a span by an equal one of the other."""
    if rng.random() < 0.5:
        return content[: choose_place(content, rng)] + other[choose_place(other, rng) :]
    start, end = _span(other, rng)
    place = choose_place(content, rng)
    return content[:place] + other[start:end] + content[place + end - start :]


def put_integer(content: bytes, rng: random.Random, place: int | None = None) -> bytes:
    """Write a critical integer of 1, 2, 4 or 8 bytes in either byte order over the bytes at a place."""
    size = rng.choice((1, 2, 4, 4, 4, 8))
    largest = 2 ** (8 * size) - 1
    value = rng.choice((*INTERESTING, largest, largest // 2, largest // 2 + 1, rng.randrange(largest + 1)))
    place = choose_place(content, rng) if place is None else place
    digits = (value & largest).to_bytes(size, rng.choice(("little", "big")))
    return content[:place] + digits + content[place + size :]


def _flip_bit(content: bytes, rng: random.Random) -> bytes:
    return _change(content, rng, lambda old: old ^ 1 << rng.randrange(8))


def _set_byte(content: bytes, rng: random.Random) -> bytes:
    return _change(content, rng, lambda old: rng.choice((0, 1, 0x7F, 0x80, 0xFF, rng.randrange(256))))


def _change(content: bytes, rng: random.Random, new: Callable[[int], int]) -> bytes:
    if not content:
        return content
    place = min(choose_place(content, rng), len(content) - 1)
    return content[:place] + bytes([new(content[place])]) + content[place + 1 :]


def _add_to_integer(content: bytes, rng: random.Random) -> bytes:
    """Add or subtract one, or change the sign, of the integer of four bytes at a place."""
    place = choose_place(content, rng)
    if place + 4 > len(content):
        return content
    order = rng.choice("<>")
    (value,) = struct.unpack_from(f"{order}I", content, place)
    value = rng.choice((value + 1, value - 1, -value, 2 * value, 16 * value)) & 0xFFFFFFFF
    return content[:place] + struct.pack(f"{order}I", value) + content[place + 4 :]


def _cut(content: bytes, rng: random.Random) -> bytes:
    return content[: choose_place(content, rng)]


def _cut_beginning(content: bytes, rng: random.Random) -> bytes:
    return content[rng.randrange(1, 40) :]


def _insert(content: bytes, rng: random.Random) -> bytes:
    place, length = choose_place(content, rng), rng.randrange(1, 40)
    span = rng.choice((bytes(length), b"\xff" * length, rng.randbytes(length)))
    return content[:place] + span + content[place:]


def _repeat(content: bytes, rng: random.Random) -> bytes:
    start, end = _span(content, rng)
    return content[:end] + content[start:end] * rng.choice((1, 1, 2, 50)) + content[end:]


def _remove(content: bytes, rng: random.Random) -> bytes:
    start, end = _span(content, rng)
    return content[:start] + content[end:]


def _blank(content: bytes, rng: random.Random) -> bytes:
    start, end = _span(content, rng)
    return content[:start] + bytes([rng.choice((0, 0, 0xFF))]) * (end - start) + content[end:]


def _span(content: bytes, rng: random.Random) -> tuple[int, int]:
    start = choose_place(content, rng)
    return start, min(len(content), start + rng.choice((1, 2, 4, 8, rng.randrange(1, LONGEST_SPAN))))


STEPS: tuple[Mutate, ...] = (
    _flip_bit,
    _flip_bit,
    _set_byte,
    _set_byte,
    put_integer,
    put_integer,
    _add_to_integer,
    _cut,
    _cut_beginning,
    _insert,
    _repeat,
    _remove,
    _blank,
)
