import numpy as np

from moseg.schemas.parameters import MotionProofParams
from moseg.tasks.motion_proof import average_along_flow, prove_motion

SHAPE = (48, 64)
PARAMS = MotionProofParams()
OBJECT = (slice(16, 32), slice(20, 40))


def render(x: int, background: int) -> np.ndarray:
    """Return a textured square at `x` before a textured background that has moved by `background` px."""
    rng = np.random.default_rng(3)
    scene = np.roll(rng.integers(0, 256, (*SHAPE, 3)).astype(np.float32), background, axis=1)
    scene[16:32, x : x + 20] = rng.integers(0, 256, (16, 20, 3))
    return scene


def flows_of(object_motion: int, background_motion: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the flow to both neighbours, and its difference from the background's."""
    flow = np.zeros((2, *SHAPE, 2), np.float32)
    flow[..., 0] = background_motion
    flow[:, *OBJECT, 0] = object_motion
    flow[0] *= -1
    background = np.zeros_like(flow)
    background[0, ..., 0], background[1, ..., 0] = -background_motion, background_motion
    return flow, flow - background


def inside(proof: np.ndarray) -> np.ndarray:
    return proof[20:28, 25:35]


def test_what_moves_is_proven_and_the_background_is_not():
    previous, frame, following = (render(20 + 3 * t, t) for t in (-1, 0, 1))
    flows, residual_flows = flows_of(3, 1)
    proof = prove_motion(frame, (previous, following), flows, residual_flows, PARAMS)
    assert proof.shape == SHAPE and proof.dtype == np.float32
    assert inside(proof).min() > 1.0
    assert np.abs(proof[:, :10]).max() < 1e-3


def test_flow_that_is_wrong_about_a_static_pixel_proves_nothing():
    scene = render(20, 0)
    flows, residual_flows = flows_of(3, 0)
    proof = prove_motion(scene, (scene, scene), flows, residual_flows, PARAMS)
    assert inside(proof).max() < 0


def test_a_pixel_without_texture_has_no_proof():
    grey = np.full((*SHAPE, 3), 90.0, np.float32)
    flows, residual_flows = flows_of(3, 1)
    np.testing.assert_allclose(prove_motion(grey, (grey, grey), flows, residual_flows, PARAMS), 0, atol=1e-6)


def test_the_smaller_proof_of_both_directions_counts():
    previous, frame, following = (render(20 + 3 * t, t) for t in (-1, 0, 1))
    flows, residual_flows = flows_of(3, 1)
    both, forward, backward = (
        prove_motion(frame, neighbours, flows, residual_flows, PARAMS)
        for neighbours in ((previous, following), (None, following), (previous, None))
    )
    np.testing.assert_array_equal(both, np.minimum(forward, backward))


def test_there_is_no_proof_without_neighbours():
    flows, residual_flows = flows_of(3, 1)
    assert not prove_motion(render(20, 0), (None, None), flows, residual_flows, PARAMS).any()


def test_the_average_follows_the_flow_and_keeps_what_is_constant():
    flows = np.zeros((5, 2, *SHAPE, 2), np.float32)
    flows[:, 0, ..., 0], flows[:, 1, ..., 0] = -2, 2
    maps = np.zeros((5, *SHAPE), np.float32)
    for t in range(5):
        maps[t, :, 20 + 2 * t : 30 + 2 * t] = 1
    average = average_along_flow(list(maps), list(flows), 0.8)
    assert average.dtype == np.float32
    np.testing.assert_allclose(average, maps, atol=1e-3)
