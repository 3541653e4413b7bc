"""Objects that a variant found in a sequence, with their motion groups and names."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.configs import Variant
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph


class FoundObjects(NamedTuple):
    """Objects of a sequence by identity, including static ones.

    Attributes
    ----------
    identities : tuple of int
        Identities of the objects from 1 on, which are the pixel values of the labels.
    motions : dict of int to int
        Motion group of each object; 0 = static, like the background.
    num_motions : int
        Number of motion groups, including the background's.
    tags : dict of int to str
        Names from the networks; empty without them.
    names : dict of int to str
        Names from the user; empty without them.
    drawn : frozenset of int
        Identities of which the user painted, erased or added a part, in any frame.
    """

    identities: tuple[int, ...]
    motions: dict[int, int]
    num_motions: int
    tags: dict[int, str]
    names: dict[int, str] = {}
    drawn: frozenset[int] = frozenset()

    @property
    def called(self) -> dict[int, str]:
        """The name of each object that has one, by identity: the user's, else that of a network."""
        return self.tags | self.names


def found_refs(graph: SequenceGraph, variant: Variant) -> tuple[str, ...]:
    """Return the references that `read_found_objects` reads."""
    return (graph.objects.linking(), *filter(None, (graph.clustering(variant), graph.corrected_objects(variant))))


def read_identities(store: ArtifactStore, graph: SequenceGraph) -> tuple[tuple[int, ...], dict[int, str]]:
    """Read the identities of the objects of a sequence from the store, and their names from the networks."""
    linking = store.attributes(graph.objects.linking())
    identities = tuple(map(int, linking.get("given", range(1, linking["num_objects"]))))
    tags = dict(zip(identities, linking["tags"], strict=True)) if "tags" in linking else {}
    # An empty tag is a box for which the detector found no name.
    return identities, {identity: tag for identity, tag in tags.items() if tag}


def read_found_objects(store: ArtifactStore, graph: SequenceGraph, variant: Variant) -> FoundObjects:
    """Read the objects from the store, as the user's edits leave them."""
    clustering, corrected = graph.clustering(variant), graph.corrected_objects(variant)
    identities, tags = read_identities(store, graph)
    names = read_names(graph)
    if corrected is not None:
        identities = tuple(store.attributes(corrected)["identities"])
        motion = store.read(corrected, "motion")
        motions = {identity: int(motion[identity]) for identity in identities}
        kept = {identity: tag for identity, tag in tags.items() if identity in motions}
        drawn = frozenset(store.read(corrected, "stroke_labels")[:, 2].tolist()) - {0}
        return FoundObjects(identities, motions, len({0, *motions.values()}), kept, names, drawn)
    if clustering is None:
        motion = np.arange(len(identities) + 1, dtype=np.uint16)
    else:
        motion = store.read(clustering, "motion")
    motions = {identity: int(group) for identity, group in zip(identities, motion[1:], strict=True)}
    return FoundObjects(identities, motions, len(np.unique(motion)), tags, names)


def read_names(graph: SequenceGraph) -> dict[int, str]:
    """Return the names that the user gave objects, by identity."""
    if not graph.leaves.edits:
        return {}
    # Here, because programs start without the tasks.
    from moseg.tasks.corrections.names import names_of

    return names_of(graph.leaves.edits)
