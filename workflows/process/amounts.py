"""Amounts that a user writes with a unit: sizes in bytes and ages in seconds."""

import re

from moseg.schemas.errors import InputError

SIZES = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}
AGES = {"s": 1.0, "m": 60.0, "h": 3600.0, "d": 86_400.0, "w": 7 * 86_400.0}
_AMOUNT = re.compile(r"(?P<number>\d+(?:\.\d+)?)\s*(?P<unit>[A-Za-z]*)")


def read_size(text: str, where: str) -> int:
    """Return the bytes of a size such as ``20G``, ``500MiB`` or ``1.5t``; raises InputError if it is none."""
    match = _AMOUNT.fullmatch(text.strip())
    unit = None if match is None else re.sub("(?:I?B)$", "", match["unit"].upper())
    if unit not in SIZES:
        raise InputError("not a size", where=where, got=repr(text), expected="a number with K, M, G or T, such as 20G")
    return round(float(match["number"]) * SIZES[unit])


def read_age(text: str, where: str) -> float:
    """Return the seconds of an age such as ``7d``, ``12h`` or ``2w``; raises InputError if it is none."""
    match = _AMOUNT.fullmatch(text.strip())
    if match is None or match["unit"] not in AGES:
        expected = "a number with s, m, h, d or w, such as 7d"
        raise InputError("not an age", where=where, got=repr(text), expected=expected)
    return float(match["number"]) * AGES[match["unit"]]


def size(nbytes: int) -> str:
    """Return a number of bytes in the unit that suits it."""
    amount = float(nbytes)
    for unit in ("B", "KiB", "MiB", "GiB"):
        if amount < 1024:
            return f"{amount:.0f} {unit}" if unit == "B" else f"{amount:.1f} {unit}"
        amount /= 1024
    return f"{amount:.1f} TiB"
