"""Evidence for the masks of moving objects beside what the ground truth says of them."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy.ndimage import distance_transform_edt

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.engine.session import Session
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.leaves import ingest_sequences
from moseg.workflows.results.found_objects import read_identities
from moseg.workflows.sources.resize import resize_labels

VARIANT = Variant.FUSED
VOID = 255
RAW = {"sure_offset": 0.0, "sure_slope": 1.0, "complete_offset": 0.0, "complete_slope": 1.0}
"""Parameters of confidence that leave the evidence as it is."""


class Observation(NamedTuple):
    """One object in one annotated frame.

    Attributes
    ----------
    sequence : str
    inside, enclosed : float
        Of `MaskEvidence`.
    precision : float
        Share of the mask's pixels that move by the ground truth.
    recall : float
        Share of the true pixels nearest to this object that the mask covers; NaN without any.
    """

    sequence: str
    inside: float
    enclosed: float
    precision: float
    recall: float


def observe(session: Session, source: SequenceSource) -> list[Observation]:
    """Return the observations of the moving objects of a sequence; none if a part of them is not from saliency."""
    config = PipelineConfig.model_validate({"confidence": RAW})
    graphs: list[SequenceGraph] = []

    def build():
        (leaves,) = ingest_sequences(session, [source], config, annotated=True)
        graphs[:] = [SequenceGraph(leaves, config)]
        confidences = filter(None, graphs[0].confidences(VARIANT))
        return graphs[0].recipes, (*graphs[0].segmentations(VARIANT), *confidences)

    def read():
        return list(_observations(session, graphs[0], source.name))

    return session.compute(build, read)


def _observations(session: Session, graph: SequenceGraph, name: str) -> Iterator[Observation]:
    store, annotation, evidence = session.store, graph.leaves.annotation, graph.confidences(VARIANT)
    if None in evidence:
        return
    identities, _ = read_identities(store, graph)
    labels = np.concatenate([store.read(ref, "labels") for ref in graph.segmentations(VARIANT)])
    inside, enclosed = (np.concatenate([store.read(ref, key) for ref in evidence]) for key in ("sure", "complete"))
    frames = store.attributes(annotation)["indices"]
    for frame, truth in zip(frames, store.read(annotation, "masks"), strict=True):
        found, moves = resize_labels(labels[frame], truth.shape), (truth > 0) & (truth != VOID)
        if not found.any():
            continue
        nearest = _nearest_object(found)
        # Columns of the evidence are the objects of the sequence, after the background.
        for column, identity in enumerate(identities, start=1):
            mask, own = found == identity, moves & (nearest == identity)
            scored, hit = np.count_nonzero(mask & (truth != VOID)), np.count_nonzero(mask & moves)
            if scored and not np.isnan(inside[frame, column]):
                recall = hit / np.count_nonzero(own) if own.any() else np.nan
                yield Observation(name, inside[frame, column], enclosed[frame, column], hit / scored, recall)


def _nearest_object(labels: np.ndarray) -> np.ndarray:
    """Return the object nearest to each pixel."""
    rows, columns = distance_transform_edt(labels == 0, return_distances=False, return_indices=True)
    return labels[rows, columns]
