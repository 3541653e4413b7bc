"""Segmenting a user's own video: labels of every frame at the video's own size."""

from collections.abc import Callable, Iterator
from typing import NamedTuple, TypeVar

import numpy as np

from schemas.configs import PipelineConfig, Variant
from store import ArtifactStore
from workflows.datasets import SequenceSource
from workflows.graph import SequenceGraph
from workflows.leaves import ingest_sequences
from workflows.resize import resize_labels
from workflows.session import Session

Result = TypeVar("Result")


class MotionSegmentation(NamedTuple):
    """Where the result of one video lies, and what was found.

    Attributes
    ----------
    name : str
    shape, analysed_shape : (int, int)
        Height and width of the video's frames, and of the frames as analysed, px.
    num_motions : int
        Motion groups found, the background's included.
    motions : dict of int to int
        Motion group of each object by identity; 0 = static, with the background.
    tags : dict of int to str
        What networks called the objects, by identity; empty where none did.
    frame_refs, label_refs : tuple of references
        The frames, and the labels of every section.
    """

    name: str
    shape: tuple[int, int]
    analysed_shape: tuple[int, int]
    num_motions: int
    motions: dict[int, int]
    tags: dict[int, str]
    frame_refs: tuple[str, ...]
    label_refs: tuple[str, ...]

    @property
    def num_frames(self) -> int:
        """Frames of the video."""
        return len(self.frame_refs)

    def frames(self, store: ArtifactStore) -> Iterator[np.ndarray]:
        """Frames as analysed, uint8 (y, x, 3) RGB, one at a time."""
        for ref in self.frame_refs:
            yield store.read(ref, "image")

    def labels(self, store: ArtifactStore, shape: tuple[int, int] | None = None) -> Iterator[np.ndarray]:
        """Labels uint16 (y, x) of every frame at `shape` (the video's own size): 0 static, else an identity."""
        for ref in self.label_refs:
            for index in range(store.manifest(ref).array("labels").shape[0]):
                labels = store.read_rows(ref, "labels", index, index + 1)[0]
                yield resize_labels(labels, shape or self.shape)


def segment(
    session: Session,
    source: SequenceSource,
    config: PipelineConfig,
    variant: Variant,
    use: Callable[[MotionSegmentation], Result],
) -> Result:
    """Segment one video, reusing every artifact that exists, and return what `use` makes of it.

    `use` is called again where it met a damaged artifact, once that is made again.

    Raises
    ------
    InputError
        The video cannot be read or has fewer than two frames.
    """
    graphs: list[SequenceGraph] = []

    def build():
        (leaves,) = ingest_sequences(session, [source], config, annotated=False)
        graphs[:] = [SequenceGraph(leaves, config)]
        clustering = graphs[0].clustering(variant)
        sinks = graphs[0].segmentations(variant)
        return graphs[0].recipes, sinks if clustering is None else (*sinks, clustering)

    def read():
        graph = graphs[0]
        clustering = graph.clustering(variant)
        linking = session.store.attributes(graph.objects.linking())
        identities = linking.get("given", range(1, linking["num_objects"]))
        if clustering is None:
            motion = np.arange(linking["num_objects"], dtype=np.uint16)
        else:
            motion = session.store.read(clustering, "motion")
        result = MotionSegmentation(
            name=source.name,
            shape=source.frames.describe().size,
            analysed_shape=graph.leaves.shape,
            num_motions=len(np.unique(motion)),
            motions={int(identity): int(group) for identity, group in zip(identities, motion[1:], strict=True)},
            tags=dict(zip(identities, linking["tags"], strict=True)) if "tags" in linking else {},
            frame_refs=graph.leaves.frames,
            label_refs=graph.segmentations(variant),
        )
        return use(result)

    return session.compute(build, read)
