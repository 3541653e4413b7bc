"""What one variant found in a sequence or in a clip of trajectories: its motion groups, matrices and eigenvalues."""

from collections.abc import Iterable

import numpy as np

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.schemas.parameters import TrajectoryClusteringParams
from moseg.store import ArtifactStore
from moseg.workflows.graph import SequenceGraph, TrajectoryGraph
from moseg.workflows.reports.content import EigenvaluePlot, GroupedObject, Matrix, VariantPanel
from moseg.workflows.reports.layers import all_colours, as_hex
from moseg.workflows.reports.matrices import clustering_params, object_matrices
from moseg.workflows.reports.missing import Missing, WhyAbsent, collect_missing, format_missing
from moseg.workflows.reports.motion_count import FoundGroups, explain_objects, explain_tracks
from moseg.workflows.results.found_objects import read_identities, read_names
from moseg.workflows.results.rigid_support import read_rigid_support
from moseg.workflows.results.scenes import scene_rows, spell_scenes

BACKGROUND = "background"
MAX_TRACKS = 200
"""Rows of a matrix: of more tracks an even sample is shown."""


def variant_panel(
    store: ArtifactStore,
    graph: SequenceGraph,
    config: PipelineConfig,
    variant: Variant,
    why_absent: WhyAbsent = WhyAbsent.GONE,
    place: int = 0,
) -> VariantPanel:
    """Gather the panel of a variant in a scene as far as its artifacts are stored.

    Parameters
    ----------
    why_absent : WhyAbsent
        Reason that is given for artifacts that are not stored.
    place : int
        Of the scene among those of the graph.

    Raises
    ------
    CorruptArtifactError
        A stored artifact is damaged.
    """
    missing: list[Missing] = []
    names: dict[int, str] = {}
    rows: list[int] = []
    with collect_missing(missing, "names of the objects"):
        rows = [0, *scene_rows(store, graph)[place]]
        names = _object_names(store, graph, rows)
    joined, scene, spelled = graph.clustering(variant), graph.scenes[place], spell_scenes(graph)[place]
    clustering = scene.clustering(variant)
    if clustering is None:
        # No clustering: every proposal counts as moving, each as a motion of its own.
        return VariantPanel(
            variant.value, _group(names, rows), missing=format_missing(missing, why_absent), scene=spelled
        )
    objects, eigenvalues = (), None
    with collect_missing(missing, "motion groups and eigenvalues"):
        found = store.attributes(clustering)
        num_items = len(store.read(clustering, "motion"))
        groups = store.read(joined, "motion")[rows].tolist()
        rigid_support = read_rigid_support(store, scene.rigid_supports(variant))
        objects = _group(names, groups, rigid_support) if names else ()
        asked, num_found = scene.recipes[clustering].params["num_motions"], found["num_motions"]
        spectrum = store.read(clustering, "eigenvalues")
        counted = FoundGroups(config.clustering.motions, asked, num_found, num_items, len(spectrum))
        has_rigid = rigid_support is not None
        how = explain_objects(counted, clustering_params(scene, variant), found.get("scores", ()), has_rigid=has_rigid)
        eigenvalues = EigenvaluePlot(_squeeze(spectrum), num_found, how)
    matrices = object_matrices(store, scene, config, variant, tuple(names.values()), missing)
    if config.affinity.method == "hypotheses":
        missing.append("residuals: affinity hypotheses compares objects under many models, and fits none to each.")
    return VariantPanel(variant.value, objects, matrices, eigenvalues, format_missing(missing, why_absent), spelled)


def clip_panel(
    store: ArtifactStore,
    graph: TrajectoryGraph,
    config: PipelineConfig,
    variant: TrajectoryVariant,
    why_absent: WhyAbsent = WhyAbsent.GONE,
) -> VariantPanel:
    """Gather the same of a clip of labelled trajectories: its kernels are sorted by motion."""
    missing: list[Missing] = []
    matrices: list[Matrix] = []
    eigenvalues = motion = None
    clustering = graph.clustering(variant)
    recipe = graph.recipes[clustering].params
    params = TrajectoryClusteringParams(**recipe["clustering"])
    with collect_missing(missing, "motion groups and eigenvalues"):
        motion = store.read(clustering, "motion")
        num_motions, spectrum = store.attributes(clustering)["num_motions"], store.read(clustering, "eigenvalues")
        counted = FoundGroups(config.clustering.motions, recipe["num_motions"], num_motions, len(motion), len(spectrum))
        eigenvalues = EigenvaluePlot(_squeeze(spectrum), num_motions, explain_tracks(counted, params))
    models = config.point_models(variant)
    kernels = []
    for model in models:
        with collect_missing(missing, f"kernel, {model}"):
            kernels.append(store.read(graph.kernel(model), "kernel").mean(axis=0, dtype=np.float64))
            description = f"How alike two tracks move under {model} models, the mean over draws of hypotheses;"
            matrices.append(_sampled(f"kernel, {model}", kernels[-1], motion, description))
    if len(models) > 1 and len(kernels) == len(models):
        is_product = params.method == "product"
        fused = np.prod(kernels, axis=0) ** (1 / len(kernels)) if is_product else np.mean(kernels, axis=0)
        description = f"The {'geometric' if is_product else 'arithmetic'} mean of the models' kernels;"
        matrices.append(_sampled("fused kernel", fused, motion, description))
    return VariantPanel(variant.value, (), tuple(matrices), eigenvalues, format_missing(missing, why_absent))


def clip_refs(graph: TrajectoryGraph, config: PipelineConfig, variant: TrajectoryVariant) -> tuple[str, ...]:
    """Return the references that the panel of a variant reads."""
    return (graph.clustering(variant), *(graph.kernel(model) for model in config.point_models(variant)))


def sample_by_motion(motion: np.ndarray, max_tracks: int = MAX_TRACKS) -> np.ndarray:
    """Return at most so many tracks, evenly from all of them in the order of their motions, int (n,)."""
    order = np.argsort(motion, kind="stable")
    count = min(len(order), max_tracks)
    return order[(2 * np.arange(count) + 1) * len(order) // (2 * count)] if count else order


def _object_names(store: ArtifactStore, graph: SequenceGraph, rows: Iterable[int]) -> dict[int, str]:
    """Return ``background`` as 0, then some objects by identity: the identity and its name, if it has one.

    Parameters
    ----------
    rows : iterable of int
        Which of the background, 0, and the objects of the video, from 1 on.
    """
    identities, tags = read_identities(store, graph)
    called = tags | read_names(graph)
    names = {0: BACKGROUND} | {identity: f"{identity} {called.get(identity, '')}".strip() for identity in identities}
    every = list(names.items())
    return dict(every[row] for row in rows)


def _group(
    names: dict[int, str], groups: Iterable[int], rigid_support: np.ndarray | None = None
) -> tuple[GroupedObject, ...]:
    colours = all_colours()
    supports = np.full(len(names), np.nan) if rigid_support is None else rigid_support
    return tuple(
        GroupedObject(name, group, as_hex(colours[identity]) if group else None, _reason(support) if identity else "")
        for (identity, name), group, support in zip(names.items(), groups, supports, strict=True)
    )


def _reason(rigid_support: float) -> str:
    """Return what the rigid support of an object says, or nothing if it is open."""
    if np.isnan(rigid_support):
        return ""
    return "(a rigid scene explains it)" if rigid_support else "(no rigid scene explains it)"


def _squeeze(spectrum: np.ndarray) -> np.ndarray:
    """Return eigenvalues (V, n) of a clustering as float64 (n,) where there is only one view."""
    return spectrum[0] if len(spectrum) == 1 else spectrum


def _sampled(title: str, kernel: np.ndarray, motion: np.ndarray | None, description: str) -> Matrix:
    chosen = sample_by_motion(np.zeros(len(kernel)) if motion is None else motion)
    order = "in the order of the file" if motion is None else "in the order of their motions"
    share = "all tracks" if len(chosen) == len(kernel) else f"{len(chosen)} of {len(kernel)} tracks"
    return Matrix(
        title, kernel[np.ix_(chosen, chosen)], (), "", f"{description} {share}, {order}; large: the same motion."
    )
