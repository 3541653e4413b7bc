"""Damage to the bytes of a file, whatever its format: what disks, downloads, editors and attackers do to them."""

import random
import struct
from collections.abc import Callable, Sequence

INTERESTING = (0, 1, 2, 3, 8, 100, 127, 128, 255, 256, 4096, 32767, 32768, 65535, 65536, 2**20, 2**24, 2**30)
"""Integers at which sizes and counts go wrong, beside the largest of each width."""
HEADER_BYTES, TAIL_BYTES = 200, 80
LONGEST_SPAN = 400
MOST_STEPS = 4

Mutate = Callable[[bytes, random.Random], bytes]


def mutate_bytes(content: bytes, dice: random.Random, others: Sequence[bytes] = ()) -> bytes:
    """Some of these steps, one after the other; `others` are sound files to be spliced with."""
    for _ in range(dice.choice((1, 1, 1, 2, 2, 3, MOST_STEPS))):
        if others and dice.random() < 0.08:
            content = splice(content, dice.choice(others), dice)
        else:
            content = dice.choice(STEPS)(content, dice)
    return content


def choose_place(content: bytes, dice: random.Random) -> int:
    """A position, half of the time near the beginning, now and then near the end: there stand sizes and counts."""
    draw = dice.random()
    if draw < 0.5:
        return dice.randrange(min(len(content), HEADER_BYTES) + 1)
    if draw < 0.65:
        return max(0, len(content) - dice.randrange(TAIL_BYTES))
    return dice.randrange(len(content) + 1)


def splice(content: bytes, other: bytes, dice: random.Random) -> bytes:
    """The beginning of one file and the end of another, or a span of the other in the place of an equal one."""
    if dice.random() < 0.5:
        return content[: choose_place(content, dice)] + other[choose_place(other, dice) :]
    start, end = _span(other, dice)
    place = choose_place(content, dice)
    return content[:place] + other[start:end] + content[place + end - start :]


def put_integer(content: bytes, dice: random.Random, place: int | None = None) -> bytes:
    """An interesting integer of 1, 2, 4 or 8 bytes in either byte order, over what stood there."""
    size = dice.choice((1, 2, 4, 4, 4, 8))
    largest = 2 ** (8 * size) - 1
    value = dice.choice((*INTERESTING, largest, largest // 2, largest // 2 + 1, dice.randrange(largest + 1)))
    place = choose_place(content, dice) if place is None else place
    digits = (value & largest).to_bytes(size, dice.choice(("little", "big")))
    return content[:place] + digits + content[place + size :]


def _flip_bit(content: bytes, dice: random.Random) -> bytes:
    return _change(content, dice, lambda old: old ^ 1 << dice.randrange(8))


def _set_byte(content: bytes, dice: random.Random) -> bytes:
    return _change(content, dice, lambda old: dice.choice((0, 1, 0x7F, 0x80, 0xFF, dice.randrange(256))))


def _change(content: bytes, dice: random.Random, new: Callable[[int], int]) -> bytes:
    if not content:
        return content
    place = min(choose_place(content, dice), len(content) - 1)
    return content[:place] + bytes([new(content[place])]) + content[place + 1 :]


def _add_to_integer(content: bytes, dice: random.Random) -> bytes:
    """One more or less, or another sign, of the integer of four bytes that stands there."""
    place = choose_place(content, dice)
    if place + 4 > len(content):
        return content
    order = dice.choice("<>")
    (value,) = struct.unpack_from(f"{order}I", content, place)
    value = dice.choice((value + 1, value - 1, -value, 2 * value, 16 * value)) & 0xFFFFFFFF
    return content[:place] + struct.pack(f"{order}I", value) + content[place + 4 :]


def _cut(content: bytes, dice: random.Random) -> bytes:
    return content[: choose_place(content, dice)]


def _cut_beginning(content: bytes, dice: random.Random) -> bytes:
    return content[dice.randrange(1, 40) :]


def _insert(content: bytes, dice: random.Random) -> bytes:
    place, length = choose_place(content, dice), dice.randrange(1, 40)
    span = dice.choice((bytes(length), b"\xff" * length, dice.randbytes(length)))
    return content[:place] + span + content[place:]


def _repeat(content: bytes, dice: random.Random) -> bytes:
    start, end = _span(content, dice)
    return content[:end] + content[start:end] * dice.choice((1, 1, 2, 50)) + content[end:]


def _remove(content: bytes, dice: random.Random) -> bytes:
    start, end = _span(content, dice)
    return content[:start] + content[end:]


def _blank(content: bytes, dice: random.Random) -> bytes:
    start, end = _span(content, dice)
    return content[:start] + bytes([dice.choice((0, 0, 0xFF))]) * (end - start) + content[end:]


def _span(content: bytes, dice: random.Random) -> tuple[int, int]:
    start = choose_place(content, dice)
    return start, min(len(content), start + dice.choice((1, 2, 4, 8, dice.randrange(1, LONGEST_SPAN))))


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
