"""What one variant made of a sequence: its motion groups, matrices and eigenvalues."""

from collections.abc import Iterable

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.reports.content import GroupedObject, VariantPanel
from moseg.workflows.reports.figure_content import EigenvaluePlot
from moseg.workflows.reports.matrices import clustering_params, object_matrices
from moseg.workflows.reports.missing import Missing, WhyAbsent, say_missing, telling_missing
from moseg.workflows.reports.motion_count import FoundGroups, explain_objects
from moseg.workflows.reports.sequence_view import all_colours, as_hex

BACKGROUND = "background"


def variant_panel(
    store: ArtifactStore,
    graph: SequenceGraph,
    config: PipelineConfig,
    variant: Variant,
    why_absent: WhyAbsent = WhyAbsent.GONE,
) -> VariantPanel:
    """The panel of a variant, as far as the store has what it shows; `why_absent` is what to say of the rest.

    Raises
    ------
    CorruptArtifactError
        A stored artifact is damaged.
    """
    missing: list[Missing] = []
    names: dict[int, str] = {}
    with telling_missing(missing, "names of the objects"):
        names = _object_names(store, graph)
    clustering = graph.clustering(variant)
    if clustering is None:
        # Nothing groups them: whatever is proposed counts as moving, each object in its own way.
        return VariantPanel(variant.value, _group(names, range(len(names))), missing=say_missing(missing, why_absent))
    objects, eigenvalues = (), None
    with telling_missing(missing, "motion groups and eigenvalues"):
        found = store.attributes(clustering)
        groups = store.read(clustering, "motion").tolist()
        objects = _group(names, groups) if names else ()
        asked, num_found = graph.recipes[clustering].params["num_motions"], found["num_motions"]
        spectrum = store.read(clustering, "eigenvalues")
        counted = FoundGroups(config.clustering.motions, asked, num_found, len(groups), len(spectrum))
        how = explain_objects(counted, clustering_params(graph, variant), found.get("scores", ()))
        eigenvalues = EigenvaluePlot(plotted_spectrum(spectrum), num_found, how)
    matrices, absent = object_matrices(store, graph, config, variant, tuple(names.values()))
    missing.extend(absent)
    if config.affinity.method == "hypotheses":
        missing.append("residuals: affinity hypotheses compares objects under many models, and fits none to each.")
    return VariantPanel(variant.value, objects, matrices, eigenvalues, say_missing(missing, why_absent))


def _object_names(store: ArtifactStore, graph: SequenceGraph) -> dict[int, str]:
    """``background`` as 0, then each object by its identity: that, with what a network called it."""
    linking = store.attributes(graph.objects.linking())
    identities = linking.get("given", range(1, linking["num_objects"]))
    tags = linking.get("tags", [""] * len(identities))
    return {0: BACKGROUND} | {
        identity: f"{identity} {tag}".strip() for identity, tag in zip(identities, tags, strict=True)
    }


def _group(names: dict[int, str], groups: Iterable[int]) -> tuple[GroupedObject, ...]:
    colours = all_colours()
    return tuple(
        GroupedObject(name, group, as_hex(colours[identity]) if group else None)
        for (identity, name), group in zip(names.items(), groups, strict=True)
    )


def plotted_spectrum(spectrum: np.ndarray) -> np.ndarray:
    """Eigenvalues (V, n) of a clustering as a plot has them: of its only kernel, float64 (n,), or of each view's."""
    return spectrum[0] if len(spectrum) == 1 else spectrum
