"""Matrices over a sequence's objects: residuals and affinities of the motion models, and the clustered kernel."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.parameters import ClusteringParams
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.reports.content import Matrix
from moseg.workflows.reports.missing import Missing, collect_missing
from moseg.workflows.results.evidence import scene_evidence
from moseg.workflows.results.rigid_support import read_rigid_support


def object_matrices(
    store: ArtifactStore,
    graph: SequenceGraph,
    config: PipelineConfig,
    variant: Variant,
    labels: tuple[str, ...],
    missing: list[Missing],
) -> tuple[Matrix, ...]:
    """Return the matrices over the objects of a sequence that can be shown.

    Parameters
    ----------
    labels : tuple of str
        Of the objects, the background's first.
    missing : list of Missing
        The matrices whose artifacts are not stored are added to it.

    Raises
    ------
    CorruptArtifactError
        A stored artifact is damaged.
    """
    found: list[Matrix] = []
    views = config.views(variant)
    for view in views:
        if config.affinity.method == "hypotheses":
            continue
        title = f"residuals, {_spell(view)}"
        with collect_missing(missing, title):
            values = mean_residuals(store.read(ref, "residual") for ref in graph.motions.residuals(view))
            found.append(Matrix(title, values, labels, "px²", _describe_residuals(config, view), True))
    for view in views:
        title = f"affinity, {_spell(view)}"
        with collect_missing(missing, title):
            values = store.read(graph.motions.affinity(view), "affinity")
            found.append(Matrix(title, values, labels, "", _describe_affinity(config, view)))
    with collect_missing(missing, "kernel"):
        found.append(_clustered(store, graph, config, variant, labels))
    return tuple(found)


def matrix_refs(graph: SequenceGraph, config: PipelineConfig, variant: Variant) -> tuple[str, ...]:
    """Return the references that the matrices, the eigenvalues and the groups of a variant read."""
    evidence = [ref for scene in scene_evidence(graph, config, variant) for ref in scene.refs()]
    found = [ref for each in (graph, *graph.scenes) for ref in (each.objects.linking(), each.clustering(variant))]
    return tuple(dict.fromkeys((*filter(None, found), *evidence)))


def mean_residuals(sections) -> np.ndarray:
    """Average residuals over the frame pairs in which they are known, float64 (K, K); NaN where there is none.

    Parameters
    ----------
    sections : iterable of float64 (M, K, K)
        [pair, model object, data object] of each section, px²; NaN where unknown.
    """
    total = count = 0
    for residuals in sections:
        known = np.isfinite(residuals)
        total = total + np.where(known, residuals, 0.0).sum(axis=0)
        count = count + known.sum(axis=0)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def fused_kernel(
    affinities: Sequence[np.ndarray],
    supports: Sequence[np.ndarray],
    params: ClusteringParams,
    rigid_support: np.ndarray | None = None,
) -> np.ndarray:
    """Return the kernel that `cluster_motions` makes of the views, float64 (K, K) without NaN.

    Parameters
    ----------
    affinities : sequence of float64 (K, K)
        Of each view; NaN where unknown.
    supports : sequence of float64 (K,)
        Of each view for every object as static; read where `params.static` is ``agreement`` and with `rigid_support`.
    params : ClusteringParams
        As the clustering's recipe has them.
    rigid_support : float64 (K,), optional
        Of every object (``read_rigid_support``), if the clustering reads it.
    """
    # Here, because a program starts without SciPy.
    from moseg.tasks.clustering import agreed_static
    from moseg.tasks.clustering.agreement import set_apart
    from moseg.tasks.clustering.fusion import fill_unknown, fuse_kernels, unit_diagonal

    views = fill_unknown([unit_diagonal(affinity) for affinity in affinities])
    if params.static == "agreement" or rigid_support is not None:
        views = set_apart(views, agreed_static(supports, params.threshold, rigid_support))
    return fuse_kernels(views, params.fusion)


def clustering_params(graph: SequenceGraph, variant: Variant) -> ClusteringParams:
    """Return the parameters in the recipe of a variant's clustering."""
    return ClusteringParams(**graph.recipes[graph.clustering(variant)].params["clustering"])


def _spell(view: str) -> str:
    """Spell a motion model as the variant of its name is spelled by the user and on the page's tabs."""
    return view.replace("_", "-")


def _clustered(store, graph, config, variant, labels) -> Matrix:
    views = config.views(variant)
    refs = [graph.motions.affinity(view) for view in views]
    params = clustering_params(graph, variant)
    rigid_support = read_rigid_support(store, graph.rigid_supports(variant))
    by_agreement = params.static == "agreement" or rigid_support is not None
    supports = [store.read(ref, "static_support") for ref in refs] if by_agreement else []
    values = fused_kernel([store.read(ref, "affinity") for ref in refs], supports, params, rigid_support)
    mean = "geometric mean" if params.fusion == "product" else "arithmetic mean"
    named = " and ".join(map(_spell, views))
    description = f"The {mean} of the affinities of {named}" if len(views) > 1 else "The affinity"
    description += ", with a unit diagonal; values that no view has are filled in along chains of objects"
    if rigid_support is not None:
        description += ", and static objects are one group"
    elif by_agreement:
        description += ", and objects that every view takes for static are one group"
    description += "; 1: the same motion."
    if len(views) > 1 and params.fusion == "coregularised":
        description += " Spectral coordinates come from the views one by one; groups are linked by this kernel."
    return Matrix("fused kernel" if len(views) > 1 else "clustered kernel", values, labels, "", description)


def _describe_residuals(config: PipelineConfig, view: str) -> str:
    if view == "trajs":
        kind, distance = "fundamental matrix", f"{config.fundamental.statistic} squared Sampson distance of its tracks"
    else:
        kind, distance = f"{_spell(view)} flow model", "mean squared distance of its flow"
    return (
        f"Row: the object whose {kind} is applied; column: the object it is applied to. The {distance}, mean over frame"
        " pairs; large: a different motion."
    )


def _describe_affinity(config: PipelineConfig, view: str) -> str:
    return (
        f"How alike two objects move under {_spell(view)}, by the method {config.affinity.method}: large means alike;"
        " no value where they were never visible together."
    )
