"""Object-specific point tracks through one section of a video, by PIPs."""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
import torch

from moseg.schemas.parameters import TrackParams
from moseg.schemas.parameters.pips import PipsParams
from moseg.tasks.check_frame import check_frame
from moseg.tasks.networks.pips import Pips, Resolution
from moseg.tasks.tracks.assemble import Tracks, assemble_tracks
from moseg.tasks.tracks.front import NO_TRACKS, Front, check_front
from moseg.tasks.tracks.lucas_kanade import inside_border


class _EncodedFrame(NamedTuple):
    """A frame, its resolution and its feature pyramid (1, y, x, C)."""

    image: np.ndarray
    resolution: Resolution
    pyramid: tuple[torch.Tensor, ...]


def track_points_pips(
    model: Pips,
    frames: Iterable[np.ndarray],
    masks: Sequence[np.ndarray] | np.ndarray,
    track_params: TrackParams,
    pips_params: PipsParams,
    rng: np.random.Generator,
) -> Tracks:
    """Sample points in every object and track them window by window.

    A window has 8 frames for the published network, and begins with a check: points outside their object's mask are
    dropped (their tracks end there) and new ones are sampled until each object has its quota again. A window begins in
    the last frame of the previous one, so that tracks continue: the paper checks every 8 frames, this every 7. A
    smaller `track_params.resample_every` makes windows begin that often, and each is used only up to the beginning of
    the next; a larger one has no effect. The last window of a section is padded by repeating the last frame.

    A track ends where the network predicts that its point is hidden, near the frame's border, or at a check. In each
    window the network searches for the point's appearance in its track's first frame, as the published code does where
    it chains windows.

    Parameters
    ----------
    model : Pips
    frames : iterable of uint8 (y, x, 3)
        RGB, F frames of one size; read once, in order, and encoded once each.
    masks : uint16 (M, y, x)
        Objects in the first M <= F frames, 0 = background, which gets points as well. Later frames only extend tracks.
    track_params : TrackParams
        Those of Lucas-Kanade have no effect.
    pips_params : PipsParams
    rng : numpy.random.Generator

    Returns
    -------
    Tracks
        In order of first frame, then object.

    Raises
    ------
    InputError
        A frame is not RGB or not of the first one's size, a mask is not of its frame's size, or there are fewer frames
        than masks.

    References
    ----------
    A. Harley, Z. Fang and K. Fragkiadaki, Particle video revisited, ECCV 2022.
    """
    advance = min(track_params.resample_every, model.config.window - 1)
    front = NO_TRACKS
    fronts: list[Front] = []
    with torch.inference_mode():
        appearances = torch.zeros(0, model.config.latent, dtype=model.dtype, device=_device(model))
        encoded = _encode_frames(model, frames, pips_params)
        for first, window in overlapping_windows(encoded, model.config.window, advance):
            start = window[0]
            if first < len(masks):
                front = check_front(front, first, start.image, masks[first], track_params, rng)
                new = front.points[front.track >= len(appearances)]
                new = _as_tensor(start.resolution.to_network(new), model)
                appearances = torch.cat([appearances, model.appearances(start.pyramid, new)])
            fronts.append(front)
            points, visible = _follow(model, window, front.points, appearances[front.track], pips_params)
            inside = inside_border(points.reshape(-1, 2), start.image.shape[:2], track_params.border)
            lasting = np.logical_and.accumulate(visible & inside.reshape(visible.shape), axis=0)
            moved = [front.move(*frame) for frame in zip(points[:advance], lasting[:advance], strict=True)]
            # The frame in which the next window begins is checked there.
            fronts += moved[: advance - 1]
            front = moved[-1] if moved else front
    return assemble_tracks(fronts, len(masks))


def _encode_frames(model: Pips, frames: Iterable[np.ndarray], params: PipsParams) -> Iterator[_EncodedFrame]:
    """Yield each frame with its feature pyramid."""
    size = None
    for index, frame in enumerate(frames):
        check_frame(frame, f"frame {index}", size)
        size = frame.shape[:2]
        resolution = Resolution.capped(size, params.max_side, model.config.min_side)
        image = torch.tensor(resolution.resize(frame), device=_device(model))
        yield _EncodedFrame(frame, resolution, model.encode(image[None]))


def _follow(
    model: Pips, window: list[_EncodedFrame], points: np.ndarray, appearances: torch.Tensor, params: PipsParams
) -> tuple[np.ndarray, np.ndarray]:
    """Return points (P, 2) of a window's first frame in its T others, float32 (T, P, 2), and if visible, (T, P)."""
    num_frames = len(window) - 1
    if num_frames == 0 or len(points) == 0:
        return np.zeros((num_frames, len(points), 2), np.float32), np.zeros((num_frames, len(points)), bool)
    resolution = window[0].resolution
    filled_up = window + window[-1:] * (model.config.window - len(window))
    pyramid = [torch.cat(level) for level in zip(*(frame.pyramid for frame in filled_up), strict=True)]
    starts = _as_tensor(resolution.to_network(points), model).split(params.points_per_pass)
    targets = appearances.split(params.points_per_pass)
    passes = [model(pyramid, *particles, params.iterations) for particles in zip(starts, targets, strict=True)]
    found = torch.cat([result.points for result in passes]).transpose(0, 1)[1 : len(window)].cpu().numpy()
    visibility = torch.cat([result.visibility for result in passes]).T[1 : len(window)].sigmoid().cpu().numpy()
    return resolution.to_frame(found).astype(np.float32), visibility >= params.min_visibility


def _as_tensor(points: np.ndarray, model: Pips) -> torch.Tensor:
    # Type first, because not every device has float64.
    return torch.from_numpy(points).to(model.dtype).to(_device(model))


def _device(model: Pips) -> torch.device:
    return next(model.parameters()).device


Item = TypeVar("Item")


def overlapping_windows(items: Iterable[Item], length: int, advance: int) -> Iterator[tuple[int, list[Item]]]:
    """Yield windows of `length` items that begin at 0, `advance`, 2 `advance`, …, each with the index of its first.

    Items are read one by one and kept only as long as a window needs them. Windows begin up to the end of the items, so
    the last ones are shorter.

    Parameters
    ----------
    items : iterable
    length : int
    advance : int
        At most `length`.
    """
    first = 0
    window: list[Item] = []
    for item in items:
        window.append(item)
        if len(window) == length:
            yield first, window
            window = window[advance:]
            first += advance
    while window:
        yield first, window
        window = window[advance:]
        first += advance
