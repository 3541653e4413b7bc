"""Input of each backend: frames of 854 x 480, the size of DAVIS, and the default parameters."""

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, NamedTuple

import cv2
import numpy as np
import published

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import CameraParams, DepthAnything3Params, RigidityParams, SeaRaftParams, TrackParams
from moseg.schemas.parameters.bootstapir import BootsTapirParams
from moseg.schemas.parameters.deaot import DeaotParams
from moseg.schemas.parameters.depth_anything import DepthAnythingParams
from moseg.schemas.parameters.dpt_dinov2 import DptDinov2Params
from moseg.schemas.parameters.grounding_dino import GroundingDinoParams
from moseg.schemas.parameters.pips import PipsParams
from moseg.schemas.parameters.raft import RaftParams
from moseg.schemas.parameters.ram import RamParams
from moseg.schemas.parameters.sam2 import Sam2Params
from moseg.schemas.parameters.sam3 import MOVING_THINGS, Sam3Params
from moseg.schemas.parameters.sam_hq import SamHqParams
from moseg.tasks.cameras import estimate_cameras
from moseg.tasks.depth import estimate_inverse_depth
from moseg.tasks.detections import detect_objects
from moseg.tasks.flow.raft import estimate_raft_flow
from moseg.tasks.instances.sam2 import segment_boxes_sam2
from moseg.tasks.instances.sam3 import segment_concepts
from moseg.tasks.instances.sam_hq import segment_boxes_sam_hq
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.bootstapir import build_bootstapir
from moseg.tasks.networks.deaot import build_deaot
from moseg.tasks.networks.depth import build_depth_anything, build_dpt_dinov2
from moseg.tasks.networks.depth_anything_3 import (
    build_depth_anything_3,
    build_depth_anything_3_cameras,
    build_depth_anything_3_rays,
)
from moseg.tasks.networks.edgetam import build_edgetam_image, build_edgetam_video
from moseg.tasks.networks.grounding_dino import build_grounding_dino
from moseg.tasks.networks.pips import build_pips
from moseg.tasks.networks.raft import build_raft
from moseg.tasks.networks.ram import build_ram, build_ram_plus
from moseg.tasks.networks.sam2 import build_sam2_image, build_sam2_video
from moseg.tasks.networks.sam3 import build_sam3_detector, build_sam3_tracker
from moseg.tasks.networks.sam_hq import build_sam_hq
from moseg.tasks.networks.sea_raft import build_sea_raft
from moseg.tasks.proposals.deaot import track_masks_deaot
from moseg.tasks.proposals.sam2 import track_masks_sam2
from moseg.tasks.tags import recognise_tags
from moseg.tasks.tracks.bootstapir import track_points_bootstapir
from moseg.tasks.tracks.pips import track_points_pips
from moseg.workflows.config.pipeline_choices import choose_preset

HEIGHT, WIDTH = 480, 854
TAGS = ("person", "car", "bus", "dog", "cat", "horse", "bird", "ball", "tree", "road", "sky")
NUM_BOXES = 16
NUM_POINTS = 200


class Clock:
    """Wall-clock and CPU seconds since it was last started."""

    def start(self) -> None:
        self._wall, self._cpu = time.perf_counter(), time.process_time()

    def read(self) -> tuple[float, float]:
        return time.perf_counter() - self._wall, time.process_time() - self._cpu


class Case(NamedTuple):
    """Backend and its work.

    Attributes
    ----------
    work : str
        Description of its input.
    make_checkpoint, build : callable
    run : callable
        Takes the network and a running clock, which it restarts after a warm-up; returns the number of frames since
        then, and the result. For those in `BATCHED` a third argument is the number of frames in one pass.
    """

    work: str
    make_checkpoint: Callable[[], Checkpoint]
    build: Callable[[Checkpoint], Any]
    run: Callable[..., tuple[int, Any]]


def _image(seed: int = 0) -> np.ndarray:
    noise = np.random.default_rng(seed).integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)
    return cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 3), None, 0, 255, cv2.NORM_MINMAX)


def _video(num_frames: int, clock: Clock, num_warm: int) -> Iterator[np.ndarray]:
    """Yield frames; the clock starts after the first ones."""
    for index in range(num_frames):
        if index == num_warm:
            clock.start()
        yield np.roll(_image(), 2 * index, axis=1)


def _shifted(num_frames: int, step: int) -> np.ndarray:
    """Return frames, each moved `step` px against the one before."""
    image = _image()
    return np.stack([np.roll(image, step * index, axis=1) for index in range(num_frames)])


def _seeds(num_objects: int) -> np.ndarray:
    """Return labels of discs in a row, 0 = background."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    column = (x * num_objects // WIDTH + 1).astype(np.uint16)
    centre = (column - 0.5) * WIDTH / num_objects
    return np.where(np.hypot(y - HEIGHT / 2, x - centre) < 60, column, 0).astype(np.uint16)


def _boxes() -> np.ndarray:
    corner = np.random.default_rng(0).random((NUM_BOXES, 4)) * [WIDTH / 2, HEIGHT / 2, WIDTH / 2, HEIGHT / 2]
    return np.concatenate([corner[:, :2], corner[:, :2] + 0.9 * corner[:, 2:] + 10], axis=1)


def _run_ram(tagger, clock: Clock) -> tuple[int, Any]:
    recognise_tags(tagger, _image(), RamParams())
    clock.start()
    return 1, recognise_tags(tagger, _image(), RamParams())


def _run_grounding_dino(params: GroundingDinoParams, detector, _: Clock) -> tuple[int, Any]:
    return 1, detect_objects(detector, _image(), TAGS, params)


def _run_sam_hq(model, _: Clock) -> tuple[int, Any]:
    return 1, segment_boxes_sam_hq(model, _image(), _boxes(), SamHqParams())


def _run_sam2_image(model, _: Clock) -> tuple[int, Any]:
    return 1, segment_boxes_sam2(model, _image(), _boxes(), Sam2Params())


def _run_sam3(detector, _: Clock) -> tuple[int, Any]:
    return 1, segment_concepts(detector, _image(), MOVING_THINGS, Sam3Params())


def _run_sam2_video(model, clock: Clock) -> tuple[int, Any]:
    # From the eighth frame on the network reads the maximum number of masks.
    return 2, track_masks_sam2(model, _video(10, clock, 8), _seeds(2), Sam2Params())


def _run_deaot(params: DeaotParams, model, clock: Clock) -> tuple[int, Any]:
    # Every frame is stored, so that the memory is full soon.
    params = params.model_copy(update={"memory_every": 1})
    num_warm = params.memory_frames + 1
    return 4, track_masks_deaot(model, _video(num_warm + 4, clock, num_warm), _seeds(5), params)


def _run_tracks(track_points, params, model, _: Clock) -> tuple[int, Any]:
    sampling = TrackParams(background_points=NUM_POINTS)
    frames = [np.roll(_image(), index, axis=1) for index in range(8)]
    masks = np.zeros((1, HEIGHT, WIDTH), np.uint16)
    return len(frames), track_points(model, frames, masks, sampling, params, np.random.default_rng(0))


def _run_flow(params: RaftParams, model, clock: Clock, num_pairs: int = 1) -> tuple[int, Any]:
    images = _shifted(num_pairs + 1, 3)
    estimate_raft_flow(model, images[:1], images[1:2], params.model_copy(update={"iterations": 1}))
    clock.start()
    return num_pairs, estimate_raft_flow(model, images[:-1], images[1:], params)


def _run_depth(params, model, clock: Clock, num_frames: int = 1) -> tuple[int, Any]:
    estimate_inverse_depth(model, _image()[None, :140, :140], params)
    clock.start()
    return num_frames, estimate_inverse_depth(model, _shifted(num_frames, 2), params)


def _run_cameras(model, _: Clock) -> tuple[int, Any]:
    params = CameraParams()
    images = _shifted(params.views, 2)
    return len(images), estimate_cameras(model, images, RigidityParams().gaps, params, DepthAnything3Params())


_PROMPTS = f"a frame, {len(TAGS)} tags; one run"
_PROMPTED = f"a frame, {NUM_BOXES} boxes; one run"
_TRACKED = "2 objects, memory full"
_POINTS = f"8 frames, {NUM_POINTS} points; one run"
_BOOTSTAPIR = partial(_run_tracks, track_points_bootstapir, BootsTapirParams())
_FLOW, _SEA_FLOW = (f"a pair, {params.iterations} iterations" for params in (RaftParams(), SeaRaftParams()))
_RAFT, _SEA_RAFT = partial(_run_flow, RaftParams()), partial(_run_flow, SeaRaftParams())
_DPT, _ANY_DEPTH = partial(_run_depth, DptDinov2Params()), partial(_run_depth, DepthAnythingParams())
_DA3 = partial(_run_depth, DepthAnything3Params())
_DINO, _DEAOT = (
    partial(run, params())
    for run, params in (
        (_run_grounding_dino, GroundingDinoParams),
        (_run_deaot, DeaotParams),
    )
)
_LIGHT = PipelineConfig.model_validate(choose_preset("modern", light=True))

CASES: dict[str, Case] = {
    "ram": Case("a frame", partial(published.ram, False), build_ram, _run_ram),
    "ram-plus": Case("a frame", partial(published.ram, True), build_ram_plus, _run_ram),
    "grounding-dino-tiny": Case(_PROMPTS, partial(published.grounding_dino, False), build_grounding_dino, _DINO),
    "grounding-dino-base": Case(_PROMPTS, partial(published.grounding_dino, True), build_grounding_dino, _DINO),
    "sam-hq-vit-base": Case(_PROMPTED, partial(published.sam_hq, False), build_sam_hq, _run_sam_hq),
    "sam-hq-vit-large": Case(_PROMPTED, partial(published.sam_hq, True), build_sam_hq, _run_sam_hq),
    "sam2.1-hiera-tiny": Case(_PROMPTED, partial(published.sam2, False), build_sam2_image, _run_sam2_image),
    "sam2.1-hiera-large": Case(_PROMPTED, partial(published.sam2, True), build_sam2_image, _run_sam2_image),
    "sam2.1-hiera-tiny-video": Case(_TRACKED, partial(published.sam2, False), build_sam2_video, _run_sam2_video),
    "sam2.1-hiera-large-video": Case(_TRACKED, partial(published.sam2, True), build_sam2_video, _run_sam2_video),
    "edgetam": Case(_PROMPTED, published.edgetam, build_edgetam_image, _run_sam2_image),
    "edgetam-video": Case(_TRACKED, published.edgetam, build_edgetam_video, _run_sam2_video),
    "sam3": Case(f"a frame, {len(MOVING_THINGS)} names; one run", published.sam3, build_sam3_detector, _run_sam3),
    "sam3-video": Case(_TRACKED, published.sam3, build_sam3_tracker, _run_sam2_video),
    "deaot-r50-l": Case("5 objects, memory full", published.deaot, build_deaot, _DEAOT),
    "pips": Case(_POINTS, published.pips, build_pips, partial(_run_tracks, track_points_pips, PipsParams())),
    "bootstapir": Case(_POINTS, published.bootstapir, build_bootstapir, _BOOTSTAPIR),
    "raft-large": Case(_FLOW, partial(published.raft, False), build_raft, _RAFT),
    "raft-small": Case(_FLOW, partial(published.raft, True), build_raft, _RAFT),
    "sea-raft-m": Case(_SEA_FLOW, partial(published.sea_raft, False), build_sea_raft, _SEA_RAFT),
    "sea-raft-s": Case(_SEA_FLOW, partial(published.sea_raft, True), build_sea_raft, _SEA_RAFT),
    "dpt-dinov2-small-nyu": Case("a frame", partial(published.dpt_dinov2, False), build_dpt_dinov2, _DPT),
    "dpt-dinov2-large-nyu": Case("a frame", partial(published.dpt_dinov2, True), build_dpt_dinov2, _DPT),
    "depth-anything-v2-small": Case("a frame", published.depth_anything_small, build_depth_anything, _ANY_DEPTH),
    "depth-anything-3-small": Case("a frame", partial(published.depth_anything_3, False), build_depth_anything_3, _DA3),
    "depth-anything-3-base": Case("a frame", partial(published.depth_anything_3, True), build_depth_anything_3, _DA3),
} | {
    f"depth-anything-3-{size}-{kind}": Case(
        f"{CameraParams().views} frames at once; one run",
        partial(published.depth_anything_3, size == "base"),
        build,
        _run_cameras,
    )
    for size in ("small", "base")
    for kind, build in (("views", build_depth_anything_3_cameras), ("rays", build_depth_anything_3_rays))
}

# Networks with the parameters of `--preset modern --light`, where these differ from the defaults.
CASES |= {
    f"{name}@light": CASES[name]._replace(run=run)
    for name, run in {
        "grounding-dino-tiny": partial(_run_grounding_dino, _LIGHT.grounding_dino),
        "deaot-r50-l": partial(_run_deaot, _LIGHT.deaot),
        "bootstapir": partial(_run_tracks, track_points_bootstapir, _LIGHT.bootstapir),
        "sea-raft-s": partial(_run_flow, _LIGHT.sea_raft),
    }.items()
}

BATCHED = frozenset(name for name, case in CASES.items() if getattr(case.run, "func", None) in (_run_flow, _run_depth))
"""Names of the networks that take several frames in one pass (``--batch``)."""
