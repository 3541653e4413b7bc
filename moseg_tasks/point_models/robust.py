"""A point model fitted to points of which many follow other motions."""

from collections.abc import Callable
from enum import StrEnum
from typing import NamedTuple

import numpy as np
import poselib

from moseg.schemas.errors import InputError
from moseg.tasks.geometry.poselib_fundamental import poselib_fundamental
from moseg.tasks.geometry.ransac import search_model
from moseg.tasks.point_models.correspondences import Correspondences, checked
from moseg.tasks.point_models.local_coordinates import local_coordinates
from moseg.tasks.point_models.point_model import PointModel


class NoFit(StrEnum):
    """Why there is no robust fit."""

    TOO_FEW_POINTS = "fewer points than a minimal sample"
    NO_MODEL = "no model with as many inliers as a minimal sample"
    DEGENERATE = "the inliers do not determine the model"


class RobustModelFit(NamedTuple):
    """A model and the points that agree with it.

    Attributes
    ----------
    parameters : float64 (*P) or None
        None where `reason` says why.
    inlier_mask : bool (N,)
        Points nearer than the threshold to the best model found, all False where none was.
    reason : NoFit or None
    """

    parameters: np.ndarray | None
    inlier_mask: np.ndarray
    reason: NoFit | None


def robust_fit(
    model: PointModel,
    data: Correspondences,
    *,
    threshold: float,
    num_samples: int,
    num_refits: int,
    rng: np.random.Generator,
) -> RobustModelFit:
    """The model that most points agree with: by PoseLib where it has it, else by LO-RANSAC over batched samples.

    There is no early stop, so that the random stream depends on the number of points alone.

    Parameters
    ----------
    model : PointModel
    data : Correspondences
        points (N, F, 2), px.
    threshold : float
        Distance of an inlier, px, as `model.residual` squares it.
    num_samples : int
        Minimal samples drawn.
    num_refits : int
        Least-squares refits to the inliers as long as they lower the cost; PoseLib refines in its own way.
    rng : numpy.random.Generator

    Returns
    -------
    RobustModelFit

    Raises
    ------
    InputError
        Where the data has another shape than the model asks for, or leading dimensions.

    References
    ----------
    P. Torr and A. Zisserman, MLESAC, CVIU 2000 (the truncated cost, MSAC);
    O. Chum, J. Matas and J. Kittler, Locally optimized RANSAC, DAGM 2003;
    V. Larsson, PoseLib - minimal solvers for camera pose estimation, https://github.com/PoseLib/PoseLib.
    """
    data = checked(data, model.num_frames, model.needs_depth)
    if data.points.ndim != 3:
        raise InputError("more than one point set", where="points", got=data.points.shape, expected="(N, F, 2)")
    nothing = np.zeros(data.num_points, dtype=bool)
    if data.num_points < model.sample_size:
        return RobustModelFit(None, nothing, NoFit.TOO_FEW_POINTS)
    estimate = _POSELIB.get(model.name)
    if estimate is not None:
        parameters = estimate(data.points, threshold, num_samples, rng)
    else:
        parameters, _ = search_model(
            lambda index: model.fit(data.take(index)),
            lambda models: model.residual(models, data),
            (data.num_points, model.sample_size),
            threshold=threshold,
            num_samples=num_samples,
            num_refits=num_refits,
            rng=rng,
        )
    if parameters is None:
        return RobustModelFit(None, nothing, NoFit.NO_MODEL)
    inlier_mask = model.residual(parameters[None], data)[0] < threshold**2
    if inlier_mask.sum() < model.sample_size:
        return RobustModelFit(None, inlier_mask, NoFit.NO_MODEL)
    if model.degenerate(data.take(inlier_mask)):
        return RobustModelFit(None, inlier_mask, NoFit.DEGENERATE)
    return RobustModelFit(parameters, inlier_mask, None)


def _fundamental(points: np.ndarray, threshold: float, num_samples: int, rng: np.random.Generator) -> np.ndarray | None:
    """PoseLib's fundamental matrix, in pixels."""
    local = local_coordinates(points)
    found = poselib_fundamental(
        local.points[:, 0], local.points[:, 1], threshold=threshold / local.scale, num_samples=num_samples, rng=rng
    )
    if found is None:
        return None
    from_pixels = local.from_pixels()[0]
    return _unit(from_pixels.T @ found.matrix @ from_pixels)


def _homography(points: np.ndarray, threshold: float, num_samples: int, rng: np.random.Generator) -> np.ndarray | None:
    """PoseLib's homography, in pixels; its own inliers are counted by the distance in the second frame."""
    local = local_coordinates(points)
    options = {
        # A distance in both frames together is that in one frame over the root of two.
        "max_reproj_error": np.sqrt(2) * threshold / local.scale,
        "seed": int(rng.integers(2**31)),
        "max_iterations": num_samples,
        "min_iterations": num_samples,
    }
    matrix, info = poselib.estimate_homography(
        local.points[:, 0], local.points[:, 1], options, {"loss_scale": options["max_reproj_error"]}
    )
    # Without a model PoseLib hands back uninitialised memory.
    if info["num_inliers"] == 0 or not np.isfinite(matrix).all() or not matrix.any():
        return None
    return _unit(local.to_pixels()[0] @ matrix @ local.from_pixels()[0])


def _unit(matrix: np.ndarray) -> np.ndarray:
    return matrix / np.linalg.norm(matrix)


_POSELIB: dict[str, Callable[[np.ndarray, float, int, np.random.Generator], np.ndarray | None]] = {
    "fundamental": _fundamental,
    "homography": _homography,
}
