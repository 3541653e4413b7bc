"""Time and agreement of many minimal models and their residuals, in batches and by a loop over the hypotheses.

Run ``python benchmarks/hypotheses.py [--hypotheses H] [--points N] [--repeat R]``. The loop solves one sample after the
other by singular value decomposition and evaluates it on all points at once, as a simple program does. Both ways start
from the same points and samples and alternate, so that their ratio is fair on a busy machine.
"""

import argparse
import time

import numpy as np

from moseg.tasks.geometry.eight_point import eight_point, epipolar_equations
from moseg.tasks.geometry.homography import homography_dlt, homography_sampson_squared
from moseg.tasks.geometry.ransac import draw_samples
from moseg.tasks.geometry.sampson import sampson_squared
from moseg.tasks.motion_models import FLOW_MODELS
from moseg.tasks.point_models import POINT_MODELS, Correspondences
from moseg.tasks.point_models.trifocal_tensor import epipoles, trilinear_equations

FOCAL, CENTRE = 720.0, (620.5, 187.0)  # KITTI
NOISE = 0.2  # px
NEAR = 1.0  # px
CENTRES = ((0, 0, 0), (0.1, 0.02, 0.9), (0.3, -0.1, 1.7))  # of the camera, m
TURN = 0.01  # rad about the vertical between frames


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hypotheses", type=int, default=300)
    parser.add_argument("--points", type=int, default=500)
    parser.add_argument("--repeat", type=int, default=7, help="runs of each kind; their medians are shown")
    options = parser.parse_args()
    data = scene(options.points)
    rng = np.random.default_rng(1)
    print(f"{'model':12} {'batched':>9} {'single':>9} {'loop':>9} {'ratio':>6} {'median difference':>18}")
    for name, model in POINT_MODELS.items():
        own = data._replace(points=data.points[:, : model.num_frames])
        samples = own.take(draw_samples(options.points, model.sample_size, options.hypotheses, rng))
        ways = {
            "batched": lambda model=model, own=own, samples=samples: batched(model, own, samples, np.float64),
            "single": lambda model=model, own=own, samples=samples: batched(model, own, samples, np.float32),
            "loop": lambda name=name, own=own, samples=samples: looped(name, own, samples),
        }
        times, results = {way: [] for way in ways}, {}
        for _ in range(options.repeat):
            for way, run in ways.items():
                start = time.perf_counter()
                results[way] = run()
                times[way].append(time.perf_counter() - start)
        difference = disagreement(results["batched"], results["loop"], ~model.degenerate(samples))
        fast, single, slow = (float(np.median(values)) * 1e3 for values in times.values())
        print(f"{name:12} {fast:6.1f} ms {single:6.1f} ms {slow:6.0f} ms {slow / fast:6.0f} {difference:18.1e}")


def scene(num_points: int) -> Correspondences:
    """Return points in three frames of a camera that moves forward and turns, with noise."""
    rng = np.random.default_rng(0)
    z = rng.uniform(6, 40, num_points)
    pixels = rng.uniform((0, 0), (1241, 374), (num_points, 2)) - CENTRE
    space = np.concatenate([pixels * z[:, None] / FOCAL, z[:, None]], axis=1)
    frames = []
    for frame, centre in enumerate(CENTRES):
        cos, sin = np.cos(frame * TURN), np.sin(frame * TURN)
        x, y, depth = ((space - centre) @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])).T
        frames.append(np.stack([x, y], axis=1) * FOCAL / depth[:, None] + CENTRE)
    points = np.stack(frames, axis=1)
    return Correspondences(points + rng.normal(0, NOISE, points.shape), 1 / z, CENTRE)


def batched(model, data, samples, dtype) -> np.ndarray:
    """Return the residuals (H, N) of all minimal models."""
    return model.residual(model.fit(samples), data, dtype)


def looped(name, data, samples) -> np.ndarray:
    """Return the same residuals, computed one hypothesis after the other."""
    one = {
        "affine": affine,
        "homography": homography,
        "fundamental": fundamental,
        "bilinear": bilinear,
        "trifocal": trifocal,
    }.get(name, flow)
    residuals = []
    for index, points in enumerate(samples.points):
        depth = samples.inverse_depth[index]
        residuals.append(one(samples._replace(points=points, inverse_depth=depth), data, name))
    return np.stack(residuals)


def disagreement(batched: np.ndarray, loop: np.ndarray, determined: np.ndarray) -> float:
    """Return the median relative difference of determined hypotheses' residuals; raises if 1 % of them exceed 1e-3.

    Only residuals up to `NEAR` count: beyond, the two trifocal residuals choose different three of four equations.
    """
    chosen = determined[:, None] & (loop < NEAR**2)
    difference = (np.abs(batched - loop) / np.maximum(loop, NOISE**2))[chosen]
    if np.quantile(difference, 0.99) > 1e-3:
        raise ArithmeticError(f"the two ways disagree: {np.quantile(difference, 0.99)}")
    return float(np.median(difference))


def affine(sample, data, name) -> np.ndarray:
    ones = np.ones((3, 1))
    A = np.linalg.solve(np.concatenate([sample.points[:, 0], ones], axis=1), sample.points[:, 1]).T
    error = data.points[:, 0] @ A[:, :2].T + A[:, 2] - data.points[:, 1]
    return np.sum(error * np.linalg.solve(A[:, :2] @ A[:, :2].T + np.eye(2), error.T).T, axis=1)


def homography(sample, data, name) -> np.ndarray:
    H = homography_dlt(sample.points[:, 0], sample.points[:, 1])
    return homography_sampson_squared(H, data.points[:, 0], data.points[:, 1])


def fundamental(sample, data, name) -> np.ndarray:
    F = eight_point(sample.points[:, 0], sample.points[:, 1])
    return sampson_squared(F, data.points[:, 0], data.points[:, 1])


def bilinear(sample, data, name) -> np.ndarray:
    equations = epipolar_equations(sample.points[:, 0] - CENTRE, sample.points[:, 1] - CENTRE)
    sizes = np.linalg.norm(equations, axis=0)
    F = (np.linalg.svd(equations / sizes).Vh[-1] / sizes).reshape(3, 3)
    return sampson_squared(F, data.points[:, 0] - CENTRE, data.points[:, 1] - CENTRE)


def flow(sample, data, name) -> np.ndarray:
    def equations(points):
        x, y = ((points.points[:, 0] - CENTRE) / CENTRE[0]).T
        return FLOW_MODELS[name].design(x, y, points.inverse_depth), points.points[:, 1] - points.points[:, 0]

    design, displacement = equations(sample)
    theta = np.linalg.lstsq(design.reshape(-1, design.shape[-1]), displacement.ravel())[0]
    design, displacement = equations(data)
    return np.sum((design @ theta - displacement) ** 2, axis=1)


def trifocal(sample, data, name) -> np.ndarray:
    """Fit by algorithms 16.1 and 16.2 of Hartley and Zisserman, then e' (JJ')^+ e of rank three for each point."""
    centroid = sample.points.mean(axis=0)
    scale = np.sqrt(2 / np.mean(np.sum((sample.points - centroid) ** 2, axis=-1), axis=0))
    equations = trilinear_equations((sample.points - centroid) * scale[:, None])
    epipole1, epipole2 = epipoles(np.linalg.svd(equations).Vh[-1].reshape(3, 3, 3))
    # T_i = a_i e''^T - e' b_i^T of the eighteen entries of a and b, three of which the tensor does not depend on.
    of_a = np.einsum("im,jn,k->ijkmn", np.eye(3), np.eye(3), epipole2).reshape(27, 9)
    of_b = -np.einsum("im,kn,j->ijkmn", np.eye(3), np.eye(3), epipole1).reshape(27, 9)
    basis = np.linalg.svd(np.concatenate([of_a, of_b], axis=1)).U[:, :15]
    T = (basis @ np.linalg.svd(equations @ basis).Vh[-1]).reshape(3, 3, 3)
    points = (data.points - centroid) * scale[:, None]
    equations = trilinear_equations(points).reshape(-1, 4, 27) @ T.ravel()
    jacobian = np.empty((len(points), 4, 6))
    for column in range(6):
        step = np.zeros((3, 2))
        step[column // 2, column % 2] = 0.5
        # The equations are multilinear, so that central differences of any step are exact.
        ahead, behind = (trilinear_equations(points + sign * step).reshape(-1, 4, 27) for sign in (1, -1))
        jacobian[..., column] = (ahead - behind) @ T.ravel() * scale[column // 2]
    U, S, _ = np.linalg.svd(jacobian, full_matrices=False)
    return np.sum(((equations[:, None, :] @ U[..., :3])[:, 0] / S[:, :3]) ** 2, axis=1)


if __name__ == "__main__":
    main()
