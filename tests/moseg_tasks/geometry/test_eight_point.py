import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.tasks.geometry.eight_point import eight_point
from moseg.tasks.geometry.sampson import sampson_squared


def same_up_to_scale(A, B, tolerance=1e-8):
    A, B = A / np.linalg.norm(A), B / np.linalg.norm(B)
    return min(np.abs(A - B).max(), np.abs(A + B).max()) < tolerance


def test_exact_points_give_back_the_true_geometry(see, scatter):
    views = see(scatter(40))
    F = eight_point(views.points0, views.points1)
    assert sampson_squared(F, views.points0, views.points1).max() < 1e-9
    elsewhere = see(scatter(200, seed=1))
    assert sampson_squared(F, elsewhere.points0, elsewhere.points1).max() < 1e-9


def test_eight_points_suffice(see, scatter):
    views = see(scatter(8))
    F = eight_point(views.points0, views.points1)
    elsewhere = see(scatter(200, seed=1))
    assert sampson_squared(F, elsewhere.points0, elsewhere.points1).max() < 1e-9


def test_rank_is_two_also_for_noisy_points(see, scatter):
    views = see(scatter(30))
    noise = np.random.default_rng(3).normal(0, 1, views.points1.shape)
    singular = np.linalg.svd(eight_point(views.points0, views.points1 + noise), compute_uv=False)
    assert singular[2] < 1e-12 * singular[0] < 1e-12 * 10


def test_a_batch_is_its_members(see, scatter):
    views = see(scatter(40))
    points0, points1 = views.points0.reshape(5, 8, 2), views.points1.reshape(5, 8, 2)
    batch = eight_point(points0, points1)
    for index in range(5):
        np.testing.assert_allclose(batch[index], eight_point(points0[index], points1[index]), atol=1e-12)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000))
def test_swapping_the_images_transposes(see_noisy, seed):
    points0, points1 = see_noisy(seed)
    assert same_up_to_scale(eight_point(points0, points1).T, eight_point(points1, points0))


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000), scale=st.floats(0.01, 100), shift=st.floats(-500, 500))
def test_moving_and_scaling_the_image_changes_the_residual_by_the_scale_alone(see_noisy, seed, scale, shift):
    points0, points1 = see_noisy(seed)
    moved0, moved1 = points0 * scale + shift, points1 * scale + shift
    before = sampson_squared(eight_point(points0, points1), points0, points1)
    after = sampson_squared(eight_point(moved0, moved1), moved0, moved1)
    np.testing.assert_allclose(after, before * scale**2, rtol=1e-3, atol=1e-6 * scale**2)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1000))
def test_the_order_of_the_points_does_not_matter(see_noisy, seed):
    points0, points1 = see_noisy(seed)
    order = np.random.default_rng(seed).permutation(len(points0))
    assert same_up_to_scale(eight_point(points0, points1), eight_point(points0[order], points1[order]))
