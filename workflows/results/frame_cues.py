"""The cues of single frames by their names: motion saliency, flow, and inverse depth."""

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.configs import MOVING_SOURCES, PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.tasks.flow.flow_grid import full_flow
from moseg.workflows.graph import GIVEN_SOURCES, SequenceGraph


class FrameCue(NamedTuple):
    """A cue of the frames of a video.

    Attributes
    ----------
    frames : collection of int
        Those that have it: a flow leads to the next picture, so that the last one of a scene has none.
    refs : function of a frame's index
        Returns the references that are read.
    read : function of the store and these references
        Returns the cue, float32 (y, x) or (y, x, 2).
    """

    frames: Collection[int]
    refs: Callable[[int], tuple[str, ...]]
    read: Callable[..., np.ndarray]

    def without_graph(self) -> "FrameCue":
        """Return the same with all references written, so that the graph need not stay in memory."""
        return self._replace(refs={frame: self.refs(frame) for frame in self.frames}.__getitem__)


def frame_cues(graph: SequenceGraph, config: PipelineConfig, variants: Sequence[Variant]) -> dict[str, FrameCue]:
    """Return the cues that a run of the variants reads, by name.

    ``saliency``
        Confidence that a pixel moves differently from the background, float32 (y, x), 0..1, on the working grid.
    ``flow``
        Motion of every pixel to the next frame, or to the next that does not repeat the frame, float32 (y, x, 2) at the
        analysed size, px; NaN where unknown. In slow motion, its share of the motion to a picture farther away.
    ``residual_flow``
        The flow minus that of the background, float32 (y, x, 2) on the working grid, px of the analysed size; NaN
        where unknown.
    ``inverse_depth``
        float32 (y, x) at the analysed size, relative: larger is nearer.
    """
    cues, models = graph.frame_cues, {model for variant in variants for model in config.views(variant)}
    frames, width = range(len(graph.leaves.frames)), graph.leaves.shape[1]
    followed = cues.pictures.followed
    has_saliency = graph.objects.uses_saliency
    slow = {frame: gap for frame in followed if (gap := cues.pictures.gap(frame)) > 1}
    gaps = {ref: gap for frame, gap in slow.items() for ref in (cues.flow_to_next(frame), cues.saliency(frame))}
    # Flow from files may be unknown in places, which saliency fills with values beside them, or with zeros.
    has_gaps = config.flow.method in GIVEN_SOURCES

    def saliency_refs(frame: int) -> tuple[str, ...]:
        return (cues.saliency(frame),)

    def flow_refs(frame: int) -> tuple[str, ...]:
        return (cues.flow_to_next(frame),)

    def residual_flow_refs(frame: int) -> tuple[str, ...]:
        return (*saliency_refs(frame), *(flow_refs(frame) if has_gaps else ()))

    def depth_refs(frame: int) -> tuple[str, ...]:
        return (cues.depth(frame),)

    found = {}
    if has_saliency:
        found["saliency"] = FrameCue(frames, saliency_refs, _read_saliency)
    if config.proposal_source in MOVING_SOURCES or models - {"trajs"}:
        found["flow"] = FrameCue(followed, flow_refs, partial(_read_shared_flow, gaps=gaps))
    if has_saliency:
        read = partial(_read_residual_flow, width=width, gaps=gaps)
        found["residual_flow"] = FrameCue(followed, residual_flow_refs, read)
    method = config.depth.method
    if method in GIVEN_SOURCES or (method != "none" and models - {"trajs", "oc"}):
        found["inverse_depth"] = FrameCue(frames, depth_refs, _read_depth)
    return found


def resize_cue(values: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Resize values (y, x, ...); where some are not finite, by nearest neighbours."""
    size = shape[1], shape[0]
    if not np.isfinite(values).all():
        return cv2.resize(values, size, interpolation=cv2.INTER_NEAREST_EXACT)
    return cv2.resize(values, size, interpolation=cv2.INTER_AREA if size[1] < len(values) else cv2.INTER_LINEAR)


def _read_saliency(store: ArtifactStore, saliency: str) -> np.ndarray:
    return store.read(saliency, "saliency").astype(np.float32)


def _read_flow(store: ArtifactStore, flow: str) -> np.ndarray:
    return full_flow(store.read(flow, "flow"), store.attributes(flow))


def _read_shared_flow(store: ArtifactStore, flow: str, *, gaps: Mapping[str, int]) -> np.ndarray:
    """Return the flow from one picture to the next, some of which are read from pictures several apart."""
    values = _read_flow(store, flow)
    return values / np.float32(gaps[flow]) if flow in gaps else values


def _read_residual_flow(
    store: ArtifactStore, saliency: str, flow: str | None = None, *, width: int, gaps: Mapping[str, int]
) -> np.ndarray:
    """Return the residual flow, unknown where a flow that may have gaps is unknown."""
    # The second direction is the one to the next frame.
    residual = store.read(saliency, "residual_flows")[1].astype(np.float32)
    residual *= np.float32(width / residual.shape[1] / gaps.get(saliency, 1))
    if flow is not None:
        is_unknown = ~np.isfinite(_read_flow(store, flow)).all(axis=-1)
        residual[resize_cue(is_unknown.astype(np.float32), residual.shape[:2]) > 0.5] = np.nan
    return residual


def _read_depth(store: ArtifactStore, depth: str) -> np.ndarray:
    return store.read(depth, "inverse_depth")
