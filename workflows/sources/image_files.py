"""Frames from image files."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError
from moseg.workflows.sources.files import digest_file, read_bytes, stem
from moseg.workflows.sources.frames import FrameDescription
from moseg.workflows.sources.pillow_image import MAX_PIXELS, check_image_header, has_wide_integers, read_below_alpha
from moseg.workflows.sources.png_file import check_png
from moseg.workflows.sources.quiet_decoding import decode_quietly
from moseg.workflows.sources.resize import shrink_to, working_size

DECODING_VERSION = 3
"""Raised when `ImageFiles.read` starts to yield other pixels for the same bytes, or to refuse them."""
MAX_SAMPLE_BYTES = 8 * MAX_PIXELS
"""Of one frame: four channels of 16 bits."""
EXPANSION_OF_PICTURES = 20
"""Pixels per byte of a file; pictures rarely have more, and only those that do are unpacked twice."""
_DAMAGE = ("Corrupt JPEG data", "Premature end of JPEG file")
_PADDING = re.compile(r"Corrupt JPEG data: ([1-9]) extraneous bytes before marker 0x(?!d[0-7])([0-9a-f]{2})")
"""Some cameras add padding bytes. More of them, or any before a restart, are misplaced data."""
_END = "d9"


@dataclass(frozen=True)
class ImageFiles:
    """Image files, one per frame, in order.

    Attributes
    ----------
    paths : tuple of str
    max_side : int
        Frames whose longer side exceeds it are area-resized to it, px.
    size : (int, int), optional
        Original (height, width) that every image must have; the first image's where None.
    folder_start : str, optional
        Path of the first image of the folder, of which these are some; the first of these where None.
    left_out : frozenset of str
        Names without suffix of the folder's other images, which were not chosen.
    """

    paths: tuple[str, ...]
    max_side: int
    size: tuple[int, int] | None = None
    folder_start: str | None = None
    left_out: frozenset[str] = frozenset()

    def __post_init__(self):
        if not self.paths:
            raise InputError("no frames", got="an empty list of image files")

    def fingerprint(self) -> str:
        """Return the digest of the files' bytes and the decode parameters."""
        files = [digest_file(path) for path in self.paths]
        return digest_json("source", ["images", DECODING_VERSION, self.max_side, self.size, files])

    def read(self) -> Iterator[np.ndarray]:
        """Yield each image as uint8 (y, x, 3) RGB; raise InputError for a file that cannot be a frame."""
        size = self.size
        for path in self.paths:
            image = decode_image(read_bytes(path), path)
            size = size or image.shape[:2]
            if image.shape[:2] != size:
                raise InputError(
                    "frame of another size",
                    where=path,
                    got=_pixels(image.shape),
                    expected=f"{_pixels(size)} as the first",
                )
            yield shrink_to(image, working_size(size, self.max_side))

    def describe(self) -> FrameDescription:
        """Return the size of the first image; images have no frame rate."""
        return FrameDescription(self.size or decode_image(read_bytes(self.paths[0]), self.paths[0]).shape[:2], None)

    def num_frames(self) -> int:
        """Return the number of files."""
        return len(self.paths)

    def choose(self, numbers: tuple[int, ...]) -> "ImageFiles":
        """Return the source of these frames alone, counted from 0."""
        chosen = tuple(self.paths[number] for number in numbers)
        left_out = self.left_out.union(map(stem, set(self.paths).difference(chosen)))
        return replace(self, paths=chosen, folder_start=self.first_path, left_out=left_out)

    @property
    def first_path(self) -> str:
        """Path of the first image of the folder."""
        return self.folder_start or self.paths[0]

    def chunks(self, size: int) -> tuple["ImageFiles", ...]:
        """Return runs of at most `size` images, which must have the size of the first image of all."""
        first = self.describe().size
        starts = range(0, len(self.paths), size)
        return tuple(ImageFiles(self.paths[start : start + size], self.max_side, first) for start in starts)


def decode_image(content: bytes, path: str) -> np.ndarray:
    """Decode an image file's bytes.

    EXIF orientation is applied, grey becomes three equal channels, 16 bits are scaled by 255/65535 and alpha is dropped
    (the colours below it count as opaque).

    Returns
    -------
    uint8 (y, x, 3) RGB

    Raises
    ------
    InputError
        The bytes are not an image, are damaged or cut short, hold several frames, more than `MAX_PIXELS`, or samples
        other than 8- or 16-bit integers.
    """
    check_png(content, path, "image", MAX_SAMPLE_BYTES, EXPANSION_OF_PICTURES)
    check_image_header(content, path)
    image, damage = _decode_with_damage(content)
    if damage is not None:
        raise InputError("image is damaged", where=path, got=damage, expected="an intact image (re-encode it)")
    if image is None:
        if has_wide_integers(content):
            raise _unusable("int32", path)
        raise InputError("image cannot be decoded", where=path, got=f"{len(content)} bytes")
    if image.dtype == np.uint16:
        image = cv2.convertScaleAbs(image, alpha=255 / 65535)
    if image.dtype != np.uint8:
        raise _unusable(str(image.dtype), path)
    below_alpha = read_below_alpha(content, path)
    if below_alpha is not None:
        return below_alpha
    return cv2.cvtColor(image, cv2.COLOR_BGR2RGB)


def _unusable(dtype: str, path: str) -> InputError:
    return InputError("image of unusable samples", where=path, got=dtype, expected="8- or 16-bit integers")


def _decode_with_damage(content: bytes) -> tuple[np.ndarray | None, str | None]:
    """Return OpenCV's samples and the damage: a damaged JPEG decodes, grey from some row on."""
    while True:
        image, complaints = decode_quietly(content, cv2.IMREAD_COLOR | cv2.IMREAD_ANYDEPTH)
        damage = next((line for line in complaints if line.startswith(_DAMAGE)), None)
        padding = None if damage is None else _PADDING.fullmatch(damage)
        if padding is None:
            return image, damage
        if padding[2] == _END:
            return image, None
        # libjpeg reports one fault only: without the zeros before a segment it reports the next one.
        marker = bytes.fromhex(f"ff{padding[2]}")
        shorter = content.replace(bytes(int(padding[1])) + marker, marker, 1)
        if shorter == content:
            return image, damage
        content = shorter


def _pixels(shape: tuple[int, ...]) -> str:
    return f"{shape[1]}x{shape[0]} px"
