"""Videos for editors: a matte, white where it moves, and the moving objects cut out, with alpha."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

from moseg.workflows.exports.encode_video import Encoding, encode_video, require_encoder
from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.ownership import OwnedFile, is_own_overlay
from moseg.workflows.exports.saved_segmentation import SavedSegmentation
from moseg.workflows.exports.write_overlay import H264

MATTE_ENCODING = H264._replace(options={"crf": "10"})
"""Finer than what is shown: lossy coding must not grey the borders of a mask."""
PRORES_ENCODING = Encoding(
    "ProRes",
    "prores_ks",
    "mov",
    "yuva444p10le",
    # Apple ProRes White Paper (2022): 4444 is the profile with alpha, of up to 16 bits.
    {"profile": "4444", "alpha_bits": "16"},
    has_even_sizes=False,
)
WEBM_ENCODING = Encoding(
    "VP9",
    "libvpx-vp9",
    "webm",
    "yuva420p",
    # Constant quality, as https://trac.ffmpeg.org/wiki/Encode/VP9 recommends: b=0 makes crf the only limit.
    {"crf": "24", "b": "0", "auto-alt-ref": "0", "deadline": "good", "cpu-used": "4"},
    stream_tags={"alpha_mode": "1"},
    has_even_sizes=False,
)
"""WebM Container Guidelines: the alpha of a block is one more VP9 frame in its BlockAdditional."""


def write_video(
    name: str,
    encoding: Encoding,
    images: Callable[[SavedSegmentation], Iterator[np.ndarray]],
    saved: SavedSegmentation,
    folder: Path,
    dilation: int | None = None,
) -> Path:
    """Write the images of a segmentation as the video `name`, one frame in memory at a time, and return its path."""
    target = video_file(name, folder, saved.summary.name, saved.names)
    target.check()
    encode_video(target.path, images(saved), saved.summary.fps, encoding)
    return target.path


def video_file(name: str, folder: Path, sequence: str, names: tuple[str, ...]) -> OwnedFile:
    """Return the file that `write_video` writes."""
    return OwnedFile(folder / name, is_own_overlay)


def draw_mattes(saved: SavedSegmentation) -> Iterator[np.ndarray]:
    """Yield uint8 (y, x, 3) of each frame: 255 where it moves, else 0."""
    for labels in saved.labels():
        yield np.repeat(_alpha(labels)[..., None], 3, axis=2)


def cut_out(saved: SavedSegmentation) -> Iterator[np.ndarray]:
    """Yield uint8 (y, x, 4) of each frame: its colours, unmultiplied, and alpha: 255 where it moves, else 0."""
    for image, labels in saved.pairs():
        yield np.dstack([image, _alpha(labels)])


def _alpha(labels: np.ndarray) -> np.ndarray:
    return np.where(labels > 0, np.uint8(255), np.uint8(0))


def _video_format(
    name: str, description: str, file: str, encoding: Encoding, images: Callable, needs_frames: bool
) -> ExportFormat:
    return ExportFormat(
        name,
        description,
        partial(write_video, file, encoding, images),
        partial(video_file, file),
        needs_frames=needs_frames,
        check_encoder=partial(require_encoder, encoding),
    )


MATTE = _video_format(
    "matte", "matte.mp4, white where it moves: editors", "matte.mp4", MATTE_ENCODING, draw_mattes, False
)
PRORES = _video_format(
    "prores", "cutout.mov, ProRes 4444 with alpha: editors", "cutout.mov", PRORES_ENCODING, cut_out, True
)
WEBM = _video_format(
    "webm", "cutout.webm, VP9 with alpha: browsers, editors", "cutout.webm", WEBM_ENCODING, cut_out, True
)
