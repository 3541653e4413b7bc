"""Ways to change a video and its ground truth: place and size of what is seen, time, and the quality of pictures."""

from collections.abc import Callable
from functools import partial
from io import BytesIO
from typing import NamedTuple

import av
import cv2
import numpy as np
from scipy.ndimage import gaussian_filter1d


class Video(NamedTuple):
    """Frames uint8 (y, x, 3), and for each the ground truth uint8 (y, x), 0 = background."""

    frames: list[np.ndarray]
    truths: list[np.ndarray]


Disturbance = Callable[[Video, np.random.Generator], Video]


def _each(change: Callable[[np.ndarray], np.ndarray], change_truth: Callable[[np.ndarray], np.ndarray]) -> Disturbance:
    """Return the disturbance that changes every frame, and every ground truth, in the same way."""
    return lambda video, rng: Video([*map(change, video.frames)], [*map(change_truth, video.truths)])


def _same(truth: np.ndarray) -> np.ndarray:
    return truth


def add_noise(video: Video, rng: np.random.Generator) -> Video:
    """Add normal noise of ten grey levels."""
    noisy = (frame + rng.normal(0, 10, frame.shape) for frame in video.frames)
    return video._replace(frames=[np.clip(frame, 0, 255).astype(np.uint8) for frame in noisy])


def compress(frame: np.ndarray) -> np.ndarray:
    """Return the frame after JPEG of quality 12."""
    return cv2.imdecode(cv2.imencode(".jpg", frame, [cv2.IMWRITE_JPEG_QUALITY, 12])[1], cv2.IMREAD_COLOR)


def encode(video: Video, rng: np.random.Generator, quality: int = 32) -> Video:
    """Encode the frames by H.264 and decode them: what is plain or changes little is repeated from frames before.

    `quality` is the constant rate factor, of which 23 is usual and more is worse.
    """
    height, width = video.frames[0].shape[:2]
    coded = BytesIO()
    with av.open(coded, "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=25, options={"crf": str(quality)})
        # Chroma has half the resolution, so that sides must be even.
        stream.width, stream.height, stream.pix_fmt = width + width % 2, height + height % 2, "yuv420p"
        for frame in video.frames:
            even = np.pad(frame, [(0, height % 2), (0, width % 2), (0, 0)], mode="edge")
            container.mux(stream.encode(av.VideoFrame.from_ndarray(even, "bgr24")))
        container.mux(stream.encode())
    coded.seek(0)
    with av.open(coded) as container:
        decoded = [frame.to_ndarray(format="bgr24")[:height, :width] for frame in container.decode(video=0)]
    return video._replace(frames=decoded)


def remove_colour(frame: np.ndarray) -> np.ndarray:
    """Return the grey frame, in three channels."""
    return cv2.cvtColor(cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)


def shake(video: Video, rng: np.random.Generator) -> Video:
    """Shift and turn the frames, enlarged by a tenth, as an unsteady hand does."""
    height, width = video.frames[0].shape[:2]
    weights = (0.25, 0.5, 0.25)
    noise = rng.normal(0, 1, (3, len(video.frames) + 2)) * np.array([[5.0], [5.0], [0.6]])
    moves = np.array([np.convolve(row, weights, "valid") for row in noise]).T
    frames, truths = [], []
    for frame, truth, (right, down, degrees) in zip(*video, moves, strict=True):
        matrix = cv2.getRotationMatrix2D((width / 2, height / 2), degrees, 1.1)
        matrix[:, 2] += right, down
        size = (width, height)
        frames.append(cv2.warpAffine(frame, matrix, size, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT))
        truths.append(cv2.warpAffine(truth, matrix, size, flags=cv2.INTER_NEAREST))
    return Video(frames, truths)


def follow(video: Video, rng: np.random.Generator, share: float = 0.6) -> Video:
    """Cut out a window, a share of each side, that follows the objects as a camera with a longer lens would."""
    height, width = video.frames[0].shape[:2]
    sides = np.array([height, width]) * share // 2 * 2
    middles: list[np.ndarray] = []
    for truth in video.truths:
        rows = np.argwhere(truth)
        middles.append(rows.mean(axis=0) if len(rows) else middles[-1] if middles else np.array([height, width]) / 2)
    path = gaussian_filter1d(np.array(middles), 6, axis=0, mode="nearest")
    starts = np.clip(path - sides / 2, 0, np.array([height, width]) - sides).astype(int)
    return _cut(video, starts, sides.astype(int))


def crop(video: Video, rng: np.random.Generator) -> Video:
    """Cut out a still window of three quarters of each side about the middle of the objects."""
    height, width = video.frames[0].shape[:2]
    sides = np.array([height, width]) * 3 // 4
    middle = np.mean([np.argwhere(truth).mean(axis=0) for truth in video.truths if truth.any()], axis=0)
    start = np.clip(middle - sides / 2, 0, np.array([height, width]) - sides).astype(int)
    return _cut(video, np.repeat(start[None], len(video.frames), axis=0), sides)


def _cut(video: Video, starts: np.ndarray, sides: np.ndarray) -> Video:
    places = [(slice(top, top + sides[0]), slice(left, left + sides[1])) for top, left in starts]
    return Video(*([image[place] for image, place in zip(images, places, strict=True)] for images in video))


def darken(frame: np.ndarray, share: float = 0.12) -> np.ndarray:
    """Return the frame with a share of its light."""
    return (frame * share).astype(np.uint8)


def flash(video: Video, rng: np.random.Generator) -> Video:
    """Brighten the frame in the middle, as a flash of light does."""
    middle, frames = len(video.frames) // 2, [*video.frames]
    frames[middle] = (0.3 * frames[middle] + 170).astype(np.uint8)
    return video._replace(frames=frames)


def change_exposure(video: Video, rng: np.random.Generator) -> Video:
    """Halve the light from the middle on."""
    middle = len(video.frames) // 2
    return video._replace(frames=[*video.frames[:middle], *(darken(frame, 0.5) for frame in video.frames[middle:])])


def _shrink_to(side: int) -> Disturbance:
    """Return the disturbance that reduces every frame, and every ground truth, to a longer side, px."""

    def shrunk(image: np.ndarray, interpolation: int) -> np.ndarray:
        height, width = (round(length * side / max(image.shape[:2])) for length in image.shape[:2])
        return cv2.resize(image, (width, height), interpolation=interpolation)

    return _each(lambda frame: shrunk(frame, cv2.INTER_AREA), lambda truth: shrunk(truth, cv2.INTER_NEAREST))


def add_bars(image: np.ndarray, down: float = 0.0, across: float = 0.0) -> np.ndarray:
    """Return the image with black bars: above and below of a share of its height, left and right of its width."""
    height, width = image.shape[:2]
    rows, columns = round(down * height), round(across * width)
    barred = np.zeros_like(image)
    barred[rows : height - rows, columns : width - columns] = image[rows : height - rows, columns : width - columns]
    return barred


def put_on_canvas(image: np.ndarray, ratio: float = 16 / 9) -> np.ndarray:
    """Return the image in the middle of a black canvas, which is `ratio` times as wide as high."""
    height, width = image.shape[:2]
    down, across = (max(round(side), 0) for side in ((width / ratio - height) / 2, (height * ratio - width) / 2))
    return cv2.copyMakeBorder(image, down, down, across, across, cv2.BORDER_CONSTANT)


def _bars(**shares: float) -> Disturbance:
    change = partial(add_bars, **shares)
    return _each(change, change)


def add_graphics(video: Video, rng: np.random.Generator) -> Video:
    """Draw a logo that lets a quarter of the scene shine through, and a clock that runs, into every frame."""
    return video._replace(frames=[_drawn(frame, index) for index, frame in enumerate(video.frames)])


def _drawn(frame: np.ndarray, index: int) -> np.ndarray:
    height, width = frame.shape[:2]
    scale = width / 854
    left, right = (width - round(margin * scale) for margin in (110, 20))
    logo = cv2.rectangle(frame.copy(), (left, round(20 * scale)), (right, round(60 * scale)), (30, 30, 200), -1)
    white, face = (255, 255, 255), cv2.FONT_HERSHEY_SIMPLEX
    cv2.putText(logo, "TV 5", (left + round(8 * scale), round(50 * scale)), face, scale, white, 2, cv2.LINE_AA)
    drawn = cv2.addWeighted(logo, 0.75, frame, 0.25, 0)
    time, corner = f"2026-11-26 16:33:{index // 25:02}", (round(20 * scale), height - round(20 * scale))
    for colour, thickness in (((0, 0, 0), 4), (white, 2)):
        cv2.putText(drawn, time, corner, face, 0.8 * scale, colour, thickness, cv2.LINE_AA)
    return drawn


DISTURBANCES: dict[str, tuple[str, Disturbance]] = {
    "none": ("as it is", lambda video, rng: video),
    "mirrored": ("mirrored", _each(np.fliplr, np.fliplr)),
    "reversed": ("reversed in time", lambda video, rng: Video(video.frames[::-1], video.truths[::-1])),
    "every-second": ("every second frame", lambda video, rng: Video(video.frames[::2], video.truths[::2])),
    **{f"{side}-px": (f"at {side} px", _shrink_to(side)) for side in (640, 427, 320, 240, 160)},
    "cropped": ("a still window, 75 % of each side", crop),
    "followed": ("a window that follows the objects, 60 % of each side", follow),
    "shaken": ("shaken by hand", shake),
    "pillars": ("black bars left and right, 20 % of the width each", _bars(across=0.2)),
    "letterbox": ("black bars above and below, 14 % of the height each", _bars(down=0.14)),
    "canvas": ("in a 16:9 canvas, black beside it", _each(put_on_canvas, put_on_canvas)),
    "graphics": ("a logo and a running clock", add_graphics),
    "grey": ("without colour", _each(remove_colour, _same)),
    "noisy": ("noise of ten grey levels", add_noise),
    "compressed": ("JPEG of quality 12", _each(compress, _same)),
    "coded": ("H.264 of quality 32", encode),
    "dark": ("12 % of the light", _each(darken, _same)),
    "flash": ("a flash of light in the middle", flash),
    "exposure": ("half the light from the middle on", change_exposure),
}
"""Names, with what they do to a video in words and in code."""
