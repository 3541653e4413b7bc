"""What one variant made of a clip of labelled trajectories: kernels in the order of the motions, and eigenvalues."""

import numpy as np

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.schemas.parameters import TrajectoryClusteringParams
from moseg.store import ArtifactStore
from moseg.workflows.graph import TrajectoryGraph
from moseg.workflows.reports.content import VariantPanel
from moseg.workflows.reports.figure_content import EigenvaluePlot, Matrix
from moseg.workflows.reports.missing import Missing, WhyAbsent, say_missing, telling_missing
from moseg.workflows.reports.motion_count import FoundGroups, explain_tracks
from moseg.workflows.reports.variant_panels import plotted_spectrum

MOST_TRACKS = 200
"""Rows of a matrix: of more tracks an even sample is shown."""


def clip_panel(
    store: ArtifactStore,
    graph: TrajectoryGraph,
    config: PipelineConfig,
    variant: TrajectoryVariant,
    why_absent: WhyAbsent = WhyAbsent.GONE,
) -> VariantPanel:
    """The panel of a variant, as far as the store has what it shows; `why_absent` is what to say of the rest.

    Raises
    ------
    CorruptArtifactError
        A stored artifact is damaged.
    """
    missing: list[Missing] = []
    matrices: list[Matrix] = []
    eigenvalues = motion = None
    clustering = graph.clustering(variant)
    recipe = graph.recipes[clustering].params
    params = TrajectoryClusteringParams(**recipe["clustering"])
    with telling_missing(missing, "motion groups and eigenvalues"):
        motion = store.read(clustering, "motion")
        num_motions, spectrum = store.attributes(clustering)["num_motions"], store.read(clustering, "eigenvalues")
        counted = FoundGroups(config.clustering.motions, recipe["num_motions"], num_motions, len(motion), len(spectrum))
        eigenvalues = EigenvaluePlot(plotted_spectrum(spectrum), num_motions, explain_tracks(counted, params))
    models = config.point_models(variant)
    kernels = []
    for model in models:
        with telling_missing(missing, f"kernel, {model}"):
            kernels.append(store.read(graph.kernel(model), "kernel").mean(axis=0, dtype=np.float64))
            description = f"How alike two tracks move under {model} models, the mean over draws of hypotheses;"
            matrices.append(_sampled(f"kernel, {model}", kernels[-1], motion, description))
    if len(models) > 1 and len(kernels) == len(models):
        is_product = params.method == "product"
        fused = np.prod(kernels, axis=0) ** (1 / len(kernels)) if is_product else np.mean(kernels, axis=0)
        description = f"The {'geometric' if is_product else 'arithmetic'} mean of the models' kernels;"
        matrices.append(_sampled("fused kernel", fused, motion, description))
    return VariantPanel(variant.value, (), tuple(matrices), eigenvalues, say_missing(missing, why_absent))


def clip_refs(graph: TrajectoryGraph, config: PipelineConfig, variant: TrajectoryVariant) -> tuple[str, ...]:
    """References that the panel of a variant is read from."""
    return (graph.clustering(variant), *(graph.kernel(model) for model in config.point_models(variant)))


def sample_by_motion(motion: np.ndarray, most: int = MOST_TRACKS) -> np.ndarray:
    """At most so many tracks, evenly from all of them in the order of their motions, int (n,)."""
    order = np.argsort(motion, kind="stable")
    count = min(len(order), most)
    return order[(2 * np.arange(count) + 1) * len(order) // (2 * count)] if count else order


def _sampled(title: str, kernel: np.ndarray, motion: np.ndarray | None, description: str) -> Matrix:
    chosen = sample_by_motion(np.zeros(len(kernel)) if motion is None else motion)
    order = "in the order of the file" if motion is None else "in the order of their motions"
    share = "all tracks" if len(chosen) == len(kernel) else f"{len(chosen)} of {len(kernel)} tracks"
    return Matrix(
        title, kernel[np.ix_(chosen, chosen)], (), "", f"{description} {share}, {order}; large: the same motion."
    )
