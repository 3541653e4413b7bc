"""Damage to the content of a format in files that are valid on the outside: checksums and lengths are corrected.

Random damage rarely passes a checksum; this does.
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


def mutate_png(content: bytes, rng: random.Random) -> bytes:
    """Change, double, drop, swap or invent chunks, with right checksums; claim sizes other than the data's."""
    chunks = _split_png(content)
    for _ in range(rng.choice((1, 1, 2, 3))):
        place = rng.randrange(len(chunks))
        kind, data = chunks[place]
        draw = rng.random()
        if draw < 0.3 and chunks[0][0] == b"IHDR" and len(chunks[0][1]) == 13:
            chunks[0] = b"IHDR", _change_png_header(chunks[0][1], rng)
        elif draw < 0.5:
            chunks[place] = kind, mutate_bytes(data, rng)
        elif draw < 0.65:
            chunks = _pack_pixels_anew(chunks, rng)
        elif draw < 0.8:
            data = rng.choice((data, rng.randbytes(rng.randrange(40)), b"a\0\0" + zlib.compress(bytes(2**22), 9)))
            chunks.insert(place, (rng.choice(_CHUNKS), data))
        elif draw < 0.9 and len(chunks) > 1:
            del chunks[place]
        else:
            chunks.insert(rng.randrange(len(chunks) + 1), chunks[place])
    return content[:8] + b"".join(map(_join_chunk, chunks))


def mutate_npy(content: bytes, rng: random.Random) -> bytes:
    """Claim another type, order and shape than the data's, in a header of right length."""
    start = 12 if content[6:7] in (b"\2", b"\3") else 10
    end = content.find(b"\n", start) + 1
    if not end or rng.random() < 0.2:
        return mutate_bytes(content, rng)
    header = content[start:end].decode("latin-1").rstrip()
    for _ in range(rng.choice((1, 1, 2))):
        header = rng.choice((_change_dtype, _change_shape, _change_order, _change_text))(header, rng)
    text = header.encode("latin-1", "replace") + b"\n"
    size = struct.pack("<H", min(len(text), 65535)) if start == 10 else struct.pack("<I", len(text))
    return content[:8] + size + text + content[end:]


def mutate_zip(content: bytes, rng: random.Random, mutate_member: Mutate = mutate_npy) -> bytes:
    """Change, drop, double, rename or inflate members, in an archive with right checksums."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = [(name, archive.read(name)) for name in archive.namelist()]
    place = rng.randrange(len(members))
    name, data = members[place]
    draw = rng.random()
    if draw < 0.6:
        members[place] = name, rng.choice((mutate_member, mutate_bytes))(data, rng)
    elif draw < 0.7:
        members[place] = name, data + bytes(rng.choice((1, 2**16, 2**24)))
    elif draw < 0.8:
        members[place] = mutate_bytes(name.encode(), rng).decode("latin-1").replace("\0", "") or "x", data
    elif draw < 0.9:
        del members[place]
    else:
        members.append((f"{name}{rng.randrange(3)}", data))
    stream = io.BytesIO()
    method = rng.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2))
    with zipfile.ZipFile(stream, "w", method) as archive, warnings.catch_warnings():
        # Two members of one name are intended.
        warnings.simplefilter("ignore")
        for name, data in members:
            archive.writestr(name, data)
    return stream.getvalue()


def mutate_mat(content: bytes, rng: random.Random) -> bytes:
    """Change tags, sizes, classes and values of a variable, inside its compression if it is compressed."""
    kind, length = struct.unpack_from("<II", content, 128)
    if kind != 15:
        place = 128 + 4 * rng.randrange(min(200, (len(content) - 128) // 4))
        return put_integer(content, rng, place) if rng.random() < 0.7 else mutate_bytes(content, rng)
    inner = zlib.decompress(content[136 : 136 + length])
    if rng.random() < 0.1:
        inner += bytes(2**24)
    elif rng.random() < 0.7:
        inner = put_integer(inner, rng, 4 * rng.randrange(min(200, len(inner) // 4)))
    else:
        inner = mutate_bytes(inner, rng)
    packed = zlib.compress(inner)
    return content[:128] + struct.pack("<II", 15, len(packed)) + packed


def mutate_safetensors(content: bytes, rng: random.Random) -> bytes:
    """Change names, types, shapes and offsets of tensors, in a header of right length."""
    (length,) = struct.unpack_from("<Q", content)
    header = mutate_text(content[8 : 8 + length], rng)
    return struct.pack("<Q", len(header)) + header + content[8 + length :]


def mutate_text(content: bytes, rng: random.Random) -> bytes:
    """Insert words with a meaning to a parser or other numbers, double or swap lines, or nest without end."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        content = rng.choice((_insert_token, _insert_token, _change_number, _change_lines, _nest))(content, rng)[
            :LONGEST_TEXT
        ]
    return content


def mutate_boxes(content: bytes, rng: random.Random) -> bytes:
    """Change sizes and fields of the boxes of an mp4, outside its samples."""
    names = [
        match.start() for match in re.finditer(rb"[a-z][a-z0-9]{3}", content[:40] + content[content.find(b"moov") :])
    ]
    shift = max(0, content.find(b"moov") - 40)
    if not names or rng.random() < 0.3:
        return mutate_bytes(content, rng)
    for _ in range(rng.choice((1, 1, 2))):
        place = rng.choice(names)
        place += (shift if place >= 40 else 0) + 4 * rng.randrange(-1, 8)
        content = put_integer(content, rng, max(0, place))
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


def _change_png_header(data: bytes, rng: random.Random) -> bytes:
    fields = list(struct.unpack(">IIBBBBB", data))
    place = rng.randrange(len(fields))
    choices = (_SIDES, _SIDES, (1, 2, 4, 8, 16, 3), (0, 2, 3, 4, 6, 1), (0, 1), (0, 1), (0, 1, 2))[place]
    fields[place] = rng.choice(choices)
    return struct.pack(">IIBBBBB", *fields)


def _pack_pixels_anew(chunks: list[tuple[bytes, bytes]], rng: random.Random) -> list[tuple[bytes, bytes]]:
    """Compress other pixels, too few or far too many."""
    try:
        pixels = zlib.decompress(b"".join(data for kind, data in chunks if kind == b"IDAT"))
    except zlib.error:
        return chunks
    pixels = rng.choice((mutate_bytes(pixels, rng), pixels[: len(pixels) // 2], bytes(2**22), pixels + bytes(2**20)))
    first = next(place for place, (kind, _) in enumerate(chunks) if kind == b"IDAT")
    others = [chunk for chunk in chunks if chunk[0] != b"IDAT"]
    return [*others[:first], (b"IDAT", zlib.compress(pixels)), *others[first:]]


def _change_dtype(header: str, rng: random.Random) -> str:
    return re.sub(r"'descr': '[^']*'", f"'descr': '{rng.choice(_DTYPES)}'", header)


def _change_shape(header: str, rng: random.Random) -> str:
    sides = [str(rng.choice((*_SIDES, 2**63, -1, 4, 6, "1.5", "None"))) for _ in range(rng.choice((0, 1, 2, 3, 3, 40)))]
    return re.sub(r"\([^)]*\)", f"({', '.join(sides)}{',' if len(sides) == 1 else ''})", header)


def _change_order(header: str, rng: random.Random) -> str:
    return re.sub(r"True|False", lambda _: rng.choice(("True", "False", "1", "None")), header)


def _change_text(header: str, rng: random.Random) -> str:
    return mutate_text(header.encode("latin-1"), rng).decode("latin-1").replace("\n", " ")


def _insert_token(content: bytes, rng: random.Random) -> bytes:
    place = rng.randrange(len(content) + 1)
    return content[:place] + rng.choice(_TOKENS) + content[place + rng.choice((0, 0, 1, 4)) :]


def _change_number(content: bytes, rng: random.Random) -> bytes:
    numbers = list(re.finditer(rb"-?\d[\d.]*", content))
    if not numbers:
        return content
    values = (*INTERESTING, -1, 2**31, 2**63, 2**64, 10**30, "1e400", "0.5", "-0.0", "9" * 5000)
    found = rng.choice(numbers)
    return content[: found.start()] + str(rng.choice(values)).encode() + content[found.end() :]


def _change_lines(content: bytes, rng: random.Random) -> bytes:
    lines = content.splitlines(keepends=True) or [b""]
    place, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    changes: tuple[Callable[[], None], ...] = (
        lambda: lines.insert(place, lines[other]),
        lambda: lines.pop(place),
        lambda: lines.__setitem__(place, b"  " + lines[place]),
        lambda: lines.__setitem__(place, lines[place].lstrip()),
        lambda: lines.__setitem__(place, lines[place] * 200),
    )
    rng.choice(changes)()
    return b"".join(lines)


def _nest(content: bytes, rng: random.Random) -> bytes:
    if rng.random() < 0.9:
        return content
    place = rng.randrange(len(content) + 1)
    return content[:place] + rng.choice((b"[", b"{", b'{"a":', b"- ", b"(", b"-")) * _DEEP + content[place:]
