"""Clips of videos without labels, from the cues that the pipeline computes for them."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.leaves import ingest_sequences
from moseg.workflows.stages.registry import STAGES

if TYPE_CHECKING:
    from moseg.schemas.parameters import ClipParams
    from moseg.store import ArtifactStore
    from moseg.tasks.network_training.clips import Clip, CuedFrame


CLIPS_VERSION = 3
"""Raised when the same cues give other clips."""
_STAGES = "flow", "background", "saliency"


def describe_clips(source: SequenceSource, config: PipelineConfig, params: "ClipParams") -> dict[str, Any]:
    """Return what the clips of a video depend on, the versions of the code included, as in JSON."""
    tasks = {name: STAGES[name].task(STAGES[name].chosen(config)) for name in _STAGES}
    return {
        "video": source.frames.fingerprint(),
        "config": config.model_dump(mode="json"),
        "tasks": {name: [task.method, task.version] for name, task in tasks.items()},
        "clip": params.model_dump(mode="json"),
        "version": CLIPS_VERSION,
    }


def cue_config(config: PipelineConfig) -> PipelineConfig:
    """Return a configuration whose cues are those of `config`, and that asks for no choice and no network beyond.

    Clips follow what moves from each picture to the next.
    """
    network = config.motion_network.model_copy(update={"use": "never"})
    slow_motion = config.slow_motion.model_copy(update={"max_gap": 1})
    return config.model_copy(
        update={"proposal_source": "saliency", "motion_network": network, "slow_motion": slow_motion}
    )


def make_clips(
    session: Session,
    source: SequenceSource,
    config: PipelineConfig,
    params: "ClipParams",
    keep: "Callable[[int, Clip], None]",
) -> None:
    """Compute the flow, background and saliency of a video, and hand each of its clips to `keep` with its number.

    Raises
    ------
    InputError
        The video cannot be read.
    """
    graphs: list[SequenceGraph] = []

    def build():
        leaves = ingest_sequences(session, [source], config, annotated=False)
        graphs[:] = [SequenceGraph(each, config) for each in leaves]
        frames = range(len(leaves[0].frames))
        return graphs[0].recipes, [graphs[0].frame_cues.saliency(frame) for frame in frames]

    def read():
        _cut(session.store, graphs[0], config, params, keep)

    session.compute(build, read)


def _cut(store: "ArtifactStore", graph: SequenceGraph, config: PipelineConfig, params: "ClipParams", keep) -> None:
    from moseg.tasks.network_training.clips import choose_middles, make_clip, window

    pictures = graph.frame_cues.pictures
    for number, middle in enumerate(choose_middles(len(pictures), params)):
        shown = window(middle, len(pictures), params)
        clip = make_clip(
            read_cued_frames(store, graph, [pictures.frames(picture).start for picture in shown]),
            middle - shown.start,
            shown.start == 0,
            shown.stop == len(pictures),
            params,
            config.saliency,
        )
        keep(number, clip)


def read_cued_frames(store: "ArtifactStore", graph: SequenceGraph, frames: Sequence[int]) -> "list[CuedFrame]":
    """Return frames with the cues of their saliency."""
    from moseg.tasks.frame_grid import frame_on_grid
    from moseg.tasks.half_floats import to_float32
    from moseg.tasks.network_training.clips import CuedFrame

    found = []
    for frame in frames:
        ref = graph.frame_cues.saliency(frame)
        flows, residuals = (to_float32(store.read(ref, name)) for name in ("flows", "residual_flows"))
        image = frame_on_grid(store.read(graph.leaves.frames[frame], "image"), flows.shape[1:3])
        found.append(CuedFrame(image, flows, residuals))
    return found
