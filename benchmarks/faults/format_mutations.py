"""Damage to what a format says, in files that are sound on the outside: checksums and lengths are made right again.

Blind damage rarely gets past a checksum; this does.
"""

import io
import random
import re
import struct
import warnings
import zipfile
import zlib
from collections.abc import Callable

from mutations import INTERESTING, Mutate, mutate_bytes, put_integer

_CHUNKS = b"IHDR PLTE IDAT IEND tRNS iCCP zTXt iTXt tEXt gAMA cHRM sRGB sBIT pHYs eXIf acTL fcTL fdAT bKGD hIST".split()
_DTYPES = ("|b1", "|u1", "<u2", ">i4", "<i8", "<f2", ">f4", "<f8", "<c8", "|S3", "<U2", "|V4", "|O", "<M8[s]", "<f16")
_TOKENS = (
    *(bytes([sign]) for sign in b"{}[],:\"'-#&*!%@`|>?\\~\0\r\t\xe9"),
    *b"\\n \\u0000 \\ud800 \x1b[31m \xef\xbb\xbf \xe2\x80\xa8 null true NaN Infinity -1 0 1e999 1e-999".split(b" "),
    *b"0x10 1_000 12:30 2001-01-01 <<: *a &a !!python/none --- ... .inf -0 1.5".split(b" "),
)
LONGEST_TEXT = 2**20
_DEEP = 100_000
_SIDES = (0, 1, 2, 31, 33, 1000, 8192, 16384, 30000, 65535, 2**20, 2**24, 2**31 - 1, 2**32 - 1)


def mutate_png(content: bytes, dice: random.Random) -> bytes:
    """Chunks changed, doubled, lost, exchanged or made up, with right checksums; sizes other than the data's."""
    chunks = _split_png(content)
    for _ in range(dice.choice((1, 1, 2, 3))):
        place = dice.randrange(len(chunks))
        kind, data = chunks[place]
        draw = dice.random()
        if draw < 0.3 and chunks[0][0] == b"IHDR" and len(chunks[0][1]) == 13:
            chunks[0] = b"IHDR", _change_png_header(chunks[0][1], dice)
        elif draw < 0.5:
            chunks[place] = kind, mutate_bytes(data, dice)
        elif draw < 0.65:
            chunks = _pack_pixels_anew(chunks, dice)
        elif draw < 0.8:
            data = dice.choice((data, dice.randbytes(dice.randrange(40)), b"a\0\0" + zlib.compress(bytes(2**22), 9)))
            chunks.insert(place, (dice.choice(_CHUNKS), data))
        elif draw < 0.9 and len(chunks) > 1:
            del chunks[place]
        else:
            chunks.insert(dice.randrange(len(chunks) + 1), chunks[place])
    return content[:8] + b"".join(map(_join_chunk, chunks))


def mutate_npy(content: bytes, dice: random.Random) -> bytes:
    """Type, order and shape other than the data's, in a header of right length."""
    start = 12 if content[6:7] in (b"\2", b"\3") else 10
    end = content.find(b"\n", start) + 1
    if not end or dice.random() < 0.2:
        return mutate_bytes(content, dice)
    header = content[start:end].decode("latin-1").rstrip()
    for _ in range(dice.choice((1, 1, 2))):
        header = dice.choice((_change_dtype, _change_shape, _change_order, _change_text))(header, dice)
    text = header.encode("latin-1", "replace") + b"\n"
    size = struct.pack("<H", min(len(text), 65535)) if start == 10 else struct.pack("<I", len(text))
    return content[:8] + size + text + content[end:]


def mutate_zip(content: bytes, dice: random.Random, mutate_member: Mutate = mutate_npy) -> bytes:
    """Members changed, lost, doubled, renamed or inflated, in an archive with right checksums."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = [(name, archive.read(name)) for name in archive.namelist()]
    place = dice.randrange(len(members))
    name, data = members[place]
    draw = dice.random()
    if draw < 0.6:
        members[place] = name, dice.choice((mutate_member, mutate_bytes))(data, dice)
    elif draw < 0.7:
        members[place] = name, data + bytes(dice.choice((1, 2**16, 2**24)))
    elif draw < 0.8:
        members[place] = mutate_bytes(name.encode(), dice).decode("latin-1").replace("\0", "") or "x", data
    elif draw < 0.9:
        del members[place]
    else:
        members.append((f"{name}{dice.randrange(3)}", data))
    stream = io.BytesIO()
    method = dice.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2))
    with zipfile.ZipFile(stream, "w", method) as archive, warnings.catch_warnings():
        # Two members of one name are meant.
        warnings.simplefilter("ignore")
        for name, data in members:
            archive.writestr(name, data)
    return stream.getvalue()


def mutate_mat(content: bytes, dice: random.Random) -> bytes:
    """Tags, sizes, classes and values of a variable, below its compression where it is compressed."""
    kind, length = struct.unpack_from("<II", content, 128)
    if kind != 15:
        place = 128 + 4 * dice.randrange(min(200, (len(content) - 128) // 4))
        return put_integer(content, dice, place) if dice.random() < 0.7 else mutate_bytes(content, dice)
    inner = zlib.decompress(content[136 : 136 + length])
    if dice.random() < 0.1:
        inner += bytes(2**24)
    elif dice.random() < 0.7:
        inner = put_integer(inner, dice, 4 * dice.randrange(min(200, len(inner) // 4)))
    else:
        inner = mutate_bytes(inner, dice)
    packed = zlib.compress(inner)
    return content[:128] + struct.pack("<II", 15, len(packed)) + packed


def mutate_safetensors(content: bytes, dice: random.Random) -> bytes:
    """Names, types, shapes and places of tensors, in a header of right length."""
    (length,) = struct.unpack_from("<Q", content)
    header = mutate_text(content[8 : 8 + length], dice)
    return struct.pack("<Q", len(header)) + header + content[8 + length :]


def mutate_text(content: bytes, dice: random.Random) -> bytes:
    """Words that mean something to a parser, other numbers, lines doubled or exchanged, and nesting without end."""
    for _ in range(dice.choice((1, 1, 2, 3))):
        content = dice.choice((_insert_token, _insert_token, _change_number, _change_lines, _nest))(content, dice)[
            :LONGEST_TEXT
        ]
    return content


def mutate_boxes(content: bytes, dice: random.Random) -> bytes:
    """Sizes and fields of the boxes of an mp4, outside its samples."""
    names = [
        match.start() for match in re.finditer(rb"[a-z][a-z0-9]{3}", content[:40] + content[content.find(b"moov") :])
    ]
    shift = max(0, content.find(b"moov") - 40)
    if not names or dice.random() < 0.3:
        return mutate_bytes(content, dice)
    for _ in range(dice.choice((1, 1, 2))):
        place = dice.choice(names)
        place += (shift if place >= 40 else 0) + 4 * dice.randrange(-1, 8)
        content = put_integer(content, dice, max(0, place))
    return content


def _split_png(content: bytes) -> list[tuple[bytes, bytes]]:
    chunks, start = [], 8
    while start + 12 <= len(content):
        length, kind = struct.unpack_from(">I4s", content, start)
        chunks.append((kind, content[start + 8 : start + 8 + length]))
        start += 12 + length
    return chunks


def _join_chunk(chunk: tuple[bytes, bytes]) -> bytes:
    kind, data = chunk
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _change_png_header(data: bytes, dice: random.Random) -> bytes:
    fields = list(struct.unpack(">IIBBBBB", data))
    place = dice.randrange(len(fields))
    choices = (_SIDES, _SIDES, (1, 2, 4, 8, 16, 3), (0, 2, 3, 4, 6, 1), (0, 1), (0, 1), (0, 1, 2))[place]
    fields[place] = dice.choice(choices)
    return struct.pack(">IIBBBBB", *fields)


def _pack_pixels_anew(chunks: list[tuple[bytes, bytes]], dice: random.Random) -> list[tuple[bytes, bytes]]:
    """Other pixels, too few or far too many, compressed as they should be."""
    try:
        pixels = zlib.decompress(b"".join(data for kind, data in chunks if kind == b"IDAT"))
    except zlib.error:
        return chunks
    pixels = dice.choice((mutate_bytes(pixels, dice), pixels[: len(pixels) // 2], bytes(2**22), pixels + bytes(2**20)))
    first = next(place for place, (kind, _) in enumerate(chunks) if kind == b"IDAT")
    others = [chunk for chunk in chunks if chunk[0] != b"IDAT"]
    return [*others[:first], (b"IDAT", zlib.compress(pixels)), *others[first:]]


def _change_dtype(header: str, dice: random.Random) -> str:
    return re.sub(r"'descr': '[^']*'", f"'descr': '{dice.choice(_DTYPES)}'", header)


def _change_shape(header: str, dice: random.Random) -> str:
    sides = [
        str(dice.choice((*_SIDES, 2**63, -1, 4, 6, "1.5", "None"))) for _ in range(dice.choice((0, 1, 2, 3, 3, 40)))
    ]
    return re.sub(r"\([^)]*\)", f"({', '.join(sides)}{',' if len(sides) == 1 else ''})", header)


def _change_order(header: str, dice: random.Random) -> str:
    return re.sub(r"True|False", lambda _: dice.choice(("True", "False", "1", "None")), header)


def _change_text(header: str, dice: random.Random) -> str:
    return mutate_text(header.encode("latin-1"), dice).decode("latin-1").replace("\n", " ")


def _insert_token(content: bytes, dice: random.Random) -> bytes:
    place = dice.randrange(len(content) + 1)
    return content[:place] + dice.choice(_TOKENS) + content[place + dice.choice((0, 0, 1, 4)) :]


def _change_number(content: bytes, dice: random.Random) -> bytes:
    numbers = list(re.finditer(rb"-?\d[\d.]*", content))
    if not numbers:
        return content
    values = (*INTERESTING, -1, 2**31, 2**63, 2**64, 10**30, "1e400", "0.5", "-0.0", "9" * 5000)
    found = dice.choice(numbers)
    return content[: found.start()] + str(dice.choice(values)).encode() + content[found.end() :]


def _change_lines(content: bytes, dice: random.Random) -> bytes:
    lines = content.splitlines(keepends=True) or [b""]
    place, other = dice.randrange(len(lines)), dice.randrange(len(lines))
    changes: tuple[Callable[[], None], ...] = (
        lambda: lines.insert(place, lines[other]),
        lambda: lines.pop(place),
        lambda: lines.__setitem__(place, b"  " + lines[place]),
        lambda: lines.__setitem__(place, lines[place].lstrip()),
        lambda: lines.__setitem__(place, lines[place] * 200),
    )
    dice.choice(changes)()
    return b"".join(lines)


def _nest(content: bytes, dice: random.Random) -> bytes:
    if dice.random() < 0.9:
        return content
    place = dice.randrange(len(content) + 1)
    return content[:place] + dice.choice((b"[", b"{", b'{"a":', b"- ", b"(", b"-")) * _DEEP + content[place:]
