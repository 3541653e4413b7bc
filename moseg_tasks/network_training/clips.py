"""Clips of a video: what the network sees of three frames, and the evidence of the tracks through the frames around."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import ClipParams, SaliencyParams
from moseg.tasks.motion_network import Neighbour, encode_motion
from moseg.tasks.network_training.paths import follow_points
from moseg.tasks.network_training.track_evidence import weigh_tracks


class CuedFrame(NamedTuple):
    """A frame on the working grid with its cues.

    Attributes
    ----------
    image : float32 (y, x, 3)
        Grey levels.
    flows, residuals : float32 (2, y, x, 2)
        Flow to the frame before and to the one after, and what the background's flow leaves of it, px/frame. Those
        without a neighbour are not read.
    """

    image: np.ndarray
    flows: np.ndarray
    residuals: np.ndarray


class Clip(NamedTuple):
    """A clip.

    Attributes
    ----------
    channels : float16 (frame, channel, y, x)
        Of `encode_motion`.
    places : float32 (track, frame, 2)
        xy of the tracks in these frames, from -1 to 1 across the frame.
    seen : bool (track, frame)
    static, moving, pairs, alike, apart
        Of `TrackEvidence`.
    paths : float32 (whole track, coordinate)
        Paths of the tracks that are seen in all frames of the window: x and y of each frame, from the middle of the
        frame, in longer sides.
    whole : int32 (whole track,)
        Their tracks.
    """

    channels: np.ndarray
    places: np.ndarray
    seen: np.ndarray
    static: np.ndarray
    moving: np.ndarray
    pairs: np.ndarray
    alike: np.ndarray
    apart: np.ndarray
    paths: np.ndarray
    whole: np.ndarray


def choose_middles(num_frames: int, params: ClipParams) -> list[int]:
    """Return the middle frames of the clips of a video."""
    every = list(range(min(params.step // 2, num_frames // 2), num_frames, params.step))
    chosen = np.unique(np.linspace(0, len(every) - 1, min(len(every), params.max_clips)).round().astype(int))
    return [every[index] for index in chosen]


def window(middle: int, num_frames: int, params: ClipParams) -> range:
    """Return the frames of the clip around a middle."""
    return range(max(middle - params.reach, 0), min(middle + params.reach + 1, num_frames))


def make_clip(
    frames: Sequence[CuedFrame],
    middle: int,
    is_start: bool,
    is_end: bool,
    params: ClipParams,
    saliency: SaliencyParams,
) -> Clip:
    """Make the clip of a window of frames.

    Parameters
    ----------
    frames : sequence of CuedFrame
    middle : int
        Position of the clip's middle in the window.
    is_start, is_end : bool
        Whether the window begins and ends with the video.
    params : ClipParams
    saliency : SaliencyParams
        Of the fits of the background, as for the network's input.
    """
    rng = np.random.default_rng(0)
    paths = follow_points([frame.flows for frame in frames], middle, params.spacing, params.consistency)
    residuals = [frame.residuals.copy() for frame in frames]
    if is_start:
        residuals[0][0] = np.nan
    if is_end:
        residuals[-1][1] = np.nan
    evidence = weigh_tracks(paths, residuals, params, rng)
    shown = sorted({min(max(middle + step, 0), len(frames) - 1) for step in (-params.shown, 0, params.shown)})
    size = np.array(frames[0].image.shape[1::-1], np.float32)
    whole = np.flatnonzero(paths.visible.all(axis=1))
    centred = (paths.points[whole] - size / 2) / max(size)
    return Clip(
        np.stack([encode_frame(frames, frame, saliency) for frame in shown]),
        (2 * (paths.points[:, shown] + 0.5) / size - 1).astype(np.float32),
        paths.visible[:, shown],
        *evidence,
        centred.reshape(len(whole), 2 * len(frames)).astype(np.float32),
        whole.astype(np.int32),
    )


def encode_frame(frames: Sequence[CuedFrame], index: int, saliency: SaliencyParams) -> np.ndarray:
    """Return the network's input float16 (channel, y, x) for one of several frames that follow each other."""
    neighbours = []
    for direction, other in ((0, index - 1), (1, index + 1)):
        if not 0 <= other < len(frames):
            neighbours.append(None)
            continue
        near, own = frames[other], frames[index]
        neighbours.append(
            Neighbour(near.image, own.flows[direction], near.flows[1 - direction], own.residuals[direction])
        )
    return encode_motion(frames[index].image, *neighbours, saliency)
