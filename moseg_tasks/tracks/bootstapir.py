"""Object-specific point tracks through one section of a video, by BootsTAPIR."""

from collections.abc import Iterable

import numpy as np
import torch
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import TrackParams
from moseg.schemas.parameters.bootstapir import BootsTapirParams
from moseg.tasks.check_frame import check_frame
from moseg.tasks.networks.bootstapir import BootsTapir, FeatureGrid
from moseg.tasks.networks.pips import Resolution
from moseg.tasks.tracks.assemble import Tracks
from moseg.tasks.tracks.front import Front, check_front
from moseg.tasks.tracks.labels_at import labels_at
from moseg.tasks.tracks.lucas_kanade import inside_border


def track_points_bootstapir(
    model: BootsTapir,
    frames: Iterable[np.ndarray],
    masks: np.ndarray,
    track_params: TrackParams,
    bootstapir_params: BootsTapirParams,
    rng: np.random.Generator,
) -> Tracks:
    """Sample points in every object and track each through all frames, also through occlusions.

    At the first frame and every `track_params.resample_every` frames, new points are sampled until each object has its
    quota of visible ones again. The network follows every point from the frame in which it was sampled to the last
    frame and back to the first. It sees all frames at once, so that a point that was hidden is found again: a track
    never ends, it is only invisible in some frames. These are the frames in which

    - the network predicts that the point is hidden, or is not sure of its position,
    - the point is near the frame's border or outside of it, or
    - the point is not on the mask of its object, if the frame has a mask: another object is in front of it, or the
      track has slipped off.

    Memory grows with the number of frames (their feature maps), and with `bootstapir_params.points_per_pass`.

    Parameters
    ----------
    model : BootsTapir
    frames : iterable of uint8 (y, x, 3)
        RGB, F frames of one size; read once, in order, and encoded once each.
    masks : uint16 (M, y, x)
        Objects in the first M <= F frames, 0 = background, which gets points as well.
    track_params : TrackParams
        Those of Lucas-Kanade have no effect.
    bootstapir_params : BootsTapirParams
    rng : numpy.random.Generator

    Returns
    -------
    Tracks
        In order of the frame in which they were sampled, then object; visible in any number of runs of frames.

    Raises
    ------
    InputError
        A frame is not RGB or not of the first one's size, the masks are not of the frames' size, or there are fewer
        frames than masks.

    References
    ----------
    C. Doersch et al., BootsTAP: Bootstrapped training for tracking-any-point, ACCV 2024.
    """
    checks = range(0, len(masks), track_params.resample_every)
    side = max(bootstapir_params.side, model.config.matching_side)
    with torch.inference_mode():
        grids, checked, num_frames = _encode_frames(model, frames, side, checks)
        if num_frames < len(masks):
            raise InputError(
                "fewer frames than masks", where="frames", got=num_frames, expected=f"at least {len(masks)}"
            )
        tracks = Tracks(
            np.zeros((0, num_frames, 2), np.float32), np.zeros((0, num_frames), bool), np.zeros(0, np.uint16)
        )
        for check, image in zip(checks, checked, strict=True):
            seen = np.flatnonzero(tracks.visible[:, check])
            front = Front(seen, tracks.points[seen, check], tracks.object[seen], len(tracks.object))
            front = check_front(front, check, image, masks[check], track_params, rng)
            is_new = front.track >= len(tracks.object)
            starts, owner = front.points[is_new], front.object[is_new]
            resolution = Resolution(image.shape[:2], (side, side))
            points, visible = _follow(model, grids, resolution, starts, check, bootstapir_params)
            visible &= _are_inside(points, image.shape[:2], track_params.border)
            visible[:, : len(masks)] &= _are_on_their_object(points, masks, owner)
            # Where a point was sampled it is known, and the network's estimate is not.
            points[:, check], visible[:, check] = starts, True
            points[~visible] = 0
            tracks = Tracks(*map(np.concatenate, zip(tracks, (points, visible, owner), strict=True)))
    return tracks


def _encode_frames(
    model: BootsTapir, frames: Iterable[np.ndarray], side: int, checks: range
) -> tuple[list[FeatureGrid], list[np.ndarray], int]:
    """Return the maps of all frames at each size, the frames of the checks, and the number of frames."""
    by_side: dict[int, list[list[torch.Tensor]]] = {}
    checked = []
    num_frames, size = 0, None
    for frame in frames:
        check_frame(frame, f"frame {num_frames}", size)
        size = frame.shape[:2]
        # As the authors resize: anisotropic, by a filter that is smooth where the frame is reduced.
        square = np.array(Image.fromarray(frame).resize((side, side), Image.Resampling.LANCZOS))
        for grid in model.encode(torch.from_numpy(square)[None].to(_device(model))):
            for maps, level in zip(by_side.setdefault(grid.side, [[] for _ in grid.levels]), grid.levels, strict=True):
                maps.append(level)
        if num_frames in checks:
            checked.append(frame)
        num_frames += 1
    grids = [FeatureGrid(side, tuple(map(_join, levels))) for side, levels in by_side.items()]
    return grids, checked, num_frames


def _join(maps: list[torch.Tensor]) -> torch.Tensor:
    """Concatenate the maps of frames and release them, so that only one level is held twice at a time."""
    joined = torch.cat(maps)
    maps.clear()
    return joined


def _follow(
    model: BootsTapir,
    grids: list[FeatureGrid],
    resolution: Resolution,
    starts: np.ndarray,
    frame: int,
    params: BootsTapirParams,
) -> tuple[np.ndarray, np.ndarray]:
    """Return points (N, 2) of a frame in all F frames, float32 (N, F, 2), and if the network sees them, (N, F)."""
    # Type first, because not every device has float64.
    points = torch.from_numpy(resolution.to_network(starts)).to(model.dtype).to(_device(model))
    found, visibility = [], []
    for part in points.split(params.points_per_pass) if len(points) else ():
        appearances = model.appearances(grids, frame, part)
        result = model(grids, part, frame, appearances, params.iterations)
        found.append(resolution.to_frame(result.points.cpu().numpy()).astype(np.float32))
        # Both must hold, as in the authors' evaluation.
        probability = (-result.occlusion).sigmoid() * (-result.uncertainty).sigmoid()
        visibility.append((probability >= params.min_visibility).cpu().numpy())
    num_frames = len(grids[0].levels[0])
    if not found:
        return np.zeros((0, num_frames, 2), np.float32), np.zeros((0, num_frames), bool)
    return np.concatenate(found), np.concatenate(visibility)


def _are_inside(points: np.ndarray, shape: tuple[int, int], border: int) -> np.ndarray:
    """Return which points (N, F, 2) lie inside the frame's border: bool (N, F)."""
    return inside_border(points.reshape(-1, 2), shape, border).reshape(points.shape[:2])


def _are_on_their_object(points: np.ndarray, masks: np.ndarray, owner: np.ndarray) -> np.ndarray:
    """Return which points (N, F, 2) lie on the mask of the object that they were sampled in: bool (N, M)."""
    labels = [labels_at(mask, points[:, index]) for index, mask in enumerate(masks)]
    return np.stack(labels, axis=1) == owner[:, None]


def _device(model: BootsTapir) -> torch.device:
    return next(model.parameters()).device
