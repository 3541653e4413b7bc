"""Cameras decoded from a network's output, and the frame pairs of a window."""

import numpy as np
import pytest
import torch
from safetensors.torch import load
from scipy.spatial.transform import Rotation

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import CameraParams, DepthAnything3Params
from moseg.tasks.cameras import estimate_cameras
from moseg.tasks.cameras.rays import cameras_of_rays
from moseg.tasks.cameras.scene_cameras import SceneCameras, decode_cameras
from moseg.tasks.depth import estimate_inverse_depth
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth_anything_3 import (
    build_depth_anything_3,
    build_depth_anything_3_cameras,
    build_depth_anything_3_rays,
)
from moseg.workflows.weights.tiny.depth_anything_3 import make_depth_anything_3

SHAPE, GAPS = (30, 44), (2, 4)
SEEN = DepthAnything3Params(side=42)


@pytest.fixture(scope="module")
def checkpoint():
    tiny = make_depth_anything_3(0)
    documents = {"config.json": tiny.files["config.json"].decode()}
    return Checkpoint("tiny", load(tiny.files["model.safetensors"]), documents, tiny.config)


@pytest.fixture(scope="module")
def network(checkpoint):
    return build_depth_anything_3_cameras(checkpoint)


@pytest.fixture
def cameras():
    """Three cameras in different places that look in different directions."""
    rng = np.random.default_rng(0)
    turns = Rotation.from_rotvec(rng.normal(0, 0.3, (3, 3)))
    return SceneCameras(turns.as_matrix(), rng.normal(size=(3, 3)), rng.uniform(0.4, 1.3, (3, 2)))


def frames(number):
    return np.random.default_rng(0).integers(0, 256, (number, *SHAPE, 3), dtype=np.uint8)


def rays_of(cameras, rows=20, columns=30):
    """Return the rays (S, 7, y, x) of the middles of a grid of cells, confident alike."""
    x, y = np.meshgrid(*((2 * np.arange(side) + 1 - side) / side for side in (columns, rows)))
    rays = np.zeros((len(cameras.focal), 7, rows, columns), np.float32)
    for view, (turn, centre, focal) in enumerate(zip(*cameras, strict=True)):
        seen = np.stack([x / focal[0] / 2, y / focal[1] / 2, np.ones_like(x)])
        rays[view, :3], rays[view, 3:6] = np.einsum("ij,jyx->iyx", turn, seen), centre[:, None, None]
    return rays


def assert_same(found, expected, tolerance):
    for got, wanted in zip(found, expected, strict=True):
        np.testing.assert_allclose(got, wanted, atol=tolerance)


@pytest.mark.parametrize("length", [1.0, -3.0])
def test_cameras_are_decoded_from_centre_quaternion_and_fields_of_view(cameras, length):
    quaternion = length * Rotation.from_matrix(cameras.rotation).as_quat()
    fields = 2 * np.arctan(0.5 / cameras.focal)[:, ::-1]
    assert_same(decode_cameras(np.hstack([cameras.centre, quaternion, fields])), cameras, 1e-12)


def test_motion_brings_a_point_from_one_camera_to_another(cameras):
    point = np.array([0.3, -0.2, 4.0])
    seen = [turn.T @ (point - centre) for turn, centre in zip(cameras.rotation, cameras.centre, strict=True)]
    pose = cameras.motion(0, 2)
    np.testing.assert_allclose(pose[:, :3] @ seen[0] + pose[:, 3], seen[2], atol=1e-12)
    np.testing.assert_allclose(cameras.motion(1, 1), np.eye(3, 4), atol=1e-12)


@pytest.mark.parametrize("factor", [1.0, -2.0])
def test_cameras_are_found_in_exact_rays_of_any_length(cameras, factor):
    rays = rays_of(cameras)
    rays[:, :3] *= factor
    assert_same(cameras_of_rays(rays), cameras, 1e-5)


def test_a_part_of_the_rays_that_looks_elsewhere_does_not_count(cameras):
    rays = rays_of(cameras)
    rays[:, :3, :6, :10] += 2
    assert_same(cameras_of_rays(rays), cameras, 1e-4)


def test_confident_rays_count_more(cameras):
    rays = rays_of(cameras)
    rays[:, 3:6, :, 15:] += 1
    rays[:, 6, :, 15:] = -20
    rays[:, 6, :, :15] = 20
    np.testing.assert_allclose(cameras_of_rays(rays).centre, cameras.centre, atol=1e-5)


@pytest.mark.parametrize("value", [np.nan, 0.0])
def test_rays_that_determine_no_camera_are_an_error(cameras, value):
    rays = rays_of(cameras)
    rays[1, :3] = value
    with pytest.raises(InputError, match="rays determine no camera"):
        cameras_of_rays(rays)


@pytest.mark.parametrize("num_frames", [1, 2, 3, 5, 6, 9, 14])
def test_every_pair_of_a_window_has_a_pose_and_every_frame_depth(network, num_frames):
    found = estimate_cameras(network, frames(num_frames), GAPS, CameraParams(views=6), SEEN)
    expected = {(start, gap) for gap in GAPS for start in range(num_frames - gap)}
    assert set(map(tuple, found.pairs.tolist())) == expected and len(found.pairs) == len(expected)
    assert found.pose.shape == (len(expected), 3, 4) and found.pose.dtype == np.float64
    turns = found.pose[:, :, :3]
    np.testing.assert_allclose(turns @ turns.transpose(0, 2, 1), np.broadcast_to(np.eye(3), turns.shape), atol=1e-9)
    assert found.inverse_depth.shape == (num_frames, *SHAPE) and found.inverse_depth.dtype == np.float32
    assert (found.inverse_depth > 0).all()
    np.testing.assert_array_equal(found.intrinsics[:, :2, 2], np.broadcast_to([21.5, 14.5], (num_frames, 2)))
    assert (found.intrinsics[:, [0, 1], [0, 1]] > 0).all()


def test_poses_of_a_run_agree_with_each_other(network):
    found = estimate_cameras(network, frames(5), (1, 2), CameraParams(views=5), SEEN)
    pose = {
        tuple(pair): np.vstack([motion, [0, 0, 0, 1]]) for pair, motion in zip(found.pairs, found.pose, strict=True)
    }
    np.testing.assert_allclose(pose[2, 1] @ pose[1, 1], pose[1, 2], atol=1e-6)


def test_what_a_run_says_does_not_depend_on_the_frames_after_it(network):
    """Runs of 6 frames own the pairs of their first 2: 14 frames begin as 8 do."""
    short, long = (estimate_cameras(network, frames(14)[:n], GAPS, CameraParams(views=6), SEEN) for n in (10, 14))
    for start, gap in ((0, 2), (1, 4), (3, 4)):
        (first,), (second,) = (found.pose[(found.pairs == (start, gap)).all(axis=1)] for found in (short, long))
        np.testing.assert_array_equal(first, second)
    np.testing.assert_array_equal(short.inverse_depth[:4], long.inverse_depth[:4])


def test_cameras_by_rays_have_the_depth_of_cameras_by_the_decoder(checkpoint, network):
    by_rays = estimate_cameras(build_depth_anything_3_rays(checkpoint), frames(5), GAPS, CameraParams(), SEEN)
    found = estimate_cameras(network, frames(5), GAPS, CameraParams(), SEEN)
    np.testing.assert_allclose(by_rays.inverse_depth, found.inverse_depth, rtol=1e-5)
    assert np.isfinite(by_rays.pose).all() and np.abs(by_rays.pose - found.pose).max() > 0.01


def test_a_single_frame_has_the_depth_of_the_depth_stage(checkpoint, network):
    found = estimate_cameras(network, frames(1), GAPS, CameraParams(), SEEN)
    alone = estimate_inverse_depth(build_depth_anything_3(checkpoint), frames(1), SEEN)
    np.testing.assert_allclose(found.inverse_depth, alone, rtol=1e-5)


@pytest.mark.parametrize("name", ["cam_dec.fc_t.bias", "head.scratch.output_conv2.2.bias"])
def test_an_output_that_is_not_finite_is_an_error(checkpoint, name):
    tensors = dict(checkpoint.tensors)
    tensors[f"model.{name}"] = torch.full_like(tensors[f"model.{name}"], torch.nan)
    network = build_depth_anything_3_cameras(checkpoint._replace(tensors=tensors))
    with pytest.raises(InputError, match="depth or cameras are not finite"):
        estimate_cameras(network, frames(3), GAPS, CameraParams(), SEEN)
