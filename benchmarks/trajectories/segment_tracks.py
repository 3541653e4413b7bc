"""Motion groups of trajectories in memory, by the tasks and the default parameters of `moseg eval`."""

import numpy as np

from moseg.schemas.configs import PipelineConfig
from moseg.tasks.point_models import POINT_MODELS
from moseg.tasks.trajectories import (
    HypothesisResiduals,
    ModelKernels,
    TrajectoryGroups,
    choose_landmarks,
    draw_hypotheses,
    group_clip,
    reduce_noise,
    trajectory_kernels,
)

SEED_OF_STARTS = 1


def segment_tracks(
    points: np.ndarray,
    visible: np.ndarray,
    num_motions: int | None,
    config: PipelineConfig,
    seed: int = 0,
) -> TrajectoryGroups:
    """Group trajectories by motion.

    Parameters
    ----------
    points : float64 (N, F, 2)
        px.
    visible : bool (N, F)
    num_motions : int, optional
        None: it is found.
    config : PipelineConfig
    seed : int
        Of the hypotheses.
    """
    points, is_stray = reduce_noise(points, visible, config.noise_reduction)
    rng = np.random.default_rng(seed)
    tracks = choose_landmarks(points, visible, config.kernel.max_tracks)
    views = []
    for name in sorted(config.fused_point_models, key=list(POINT_MODELS).index):
        model = POINT_MODELS[name]
        drawn = draw_hypotheses(points[~is_stray], visible[~is_stray], model, config.hypotheses, rng)
        residuals = HypothesisResiduals(drawn, points[tracks], visible[tracks], model)
        views.append(
            ModelKernels(model, drawn, trajectory_kernels(residuals, config.hypotheses.num_draws, config.kernel))
        )
    starts = np.random.default_rng(SEED_OF_STARTS)
    params = config.trajectory_clustering, config.clip_sections, config.kernel.window
    return group_clip(points, visible, is_stray, views, num_motions, *params, starts)
