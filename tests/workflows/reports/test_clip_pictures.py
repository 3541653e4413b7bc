"""A clip of labelled trajectories is shown as points in the colours of motions, labels and errors."""

import io

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.schemas.recipes import leaf_recipe
from moseg.store import open_store
from moseg.tasks.metrics import clustering_error
from moseg.workflows.graph import TrajectoryGraph, TrajectoryLeaves
from moseg.workflows.reports.clip_layers import (
    CLIP_SIDE,
    RIGHT_COLOUR,
    UNLABELLED_COLOUR,
    WRONG_COLOUR,
    clip_extent,
    gather_clip_pictures,
    match_groups,
)
from moseg.workflows.reports.layers import as_hex
from moseg.workflows.reports.missing import WhyAbsent
from moseg.workflows.reports.panels import Panels
from moseg.workflows.stages.registry import axes_of

CONFIG = PipelineConfig()
FUSED = TrajectoryVariant.FUSED
LABELS = np.array([1, 1, 1, 2, 2], np.uint16)
GROUPS = np.array([5, 5, 0, 0, 0], np.uint16)
PLACES = [(20, 20), (60, 20), (100, 20), (140, 60), (180, 60)]


def _put(store, recipe, arrays, attributes=None):
    """Store an artifact of a stage or a leaf."""
    return store.put(recipe, arrays, attributes, dims=axes_of(recipe.task, arrays))


@pytest.fixture
def clip(tmp_path):
    """A store with five trajectories in four frames, of which the third is in the wrong group; and their graph."""
    store = open_store(str(tmp_path / "store"), create=True)
    points = np.tile(np.array(PLACES, float)[:, None], (1, 4, 1))
    points[:, :, 0] += [-9, -6, -3, 0]
    visible = np.ones((5, 4), bool)
    recipes = leaf_recipe("trajectories", "1" * 64), leaf_recipe("trajectory_labels", "2" * 64)
    _put(store, recipes[0], {"points": points, "visible": visible})
    _put(store, recipes[1], {"labels": LABELS})
    graph = TrajectoryGraph(TrajectoryLeaves("clip", recipes[0].ref, recipes[1].ref, 2), CONFIG)
    ref = graph.clustering(FUSED)
    arrays = {"embedding": np.zeros((5, 2)), "eigenvalues": np.zeros((1, 2)), "costs": np.zeros(2)}
    arrays |= {"cuts": np.zeros(2), "codes": np.zeros(2)}
    _put(store, graph.recipes[ref], {"motion": GROUPS, **arrays}, {"num_motions": 2, "objective": [0.0]})
    return store, graph


def _layer(pictures, name):
    return next(layer for layer in pictures.layers if layer.name == name)


def _colours_at_points(picture):
    """Return the colour of each point's centre in the clip's last frame."""
    image = np.asarray(Image.open(io.BytesIO(picture.data)))
    assert image.shape[2] == 4
    return [as_hex(image[y, x, :3]) for x, y in PLACES]


def test_points_have_the_colours_of_motions_labels_and_errors(clip):
    pictures = gather_clip_pictures(*clip, CONFIG, (FUSED,), 4)
    assert pictures.frames == (0, 1, 2, 3)
    assert (pictures.objects, pictures.video, pictures.missing) == ((), None, ())
    assert [layer.name for layer in pictures.layers] == ["points", "motions (fused)", "ground truth", "errors (fused)"]
    truth = _colours_at_points(_layer(pictures, "ground truth").pictures[-1])
    found = _colours_at_points(_layer(pictures, "motions (fused)").pictures[-1])
    assert truth[0] == truth[1] == truth[2] != truth[3] == truth[4]
    # A group has its label's colour, whatever its number is.
    assert found == [truth[0], truth[0], truth[3], truth[3], truth[3]]
    errors = _colours_at_points(_layer(pictures, "errors (fused)").pictures[-1])
    right, wrong = as_hex(RIGHT_COLOUR), as_hex(WRONG_COLOUR)
    assert errors == [right, right, wrong, right, right]
    legend = _layer(pictures, "errors (fused)").legend
    assert [entry.meaning for entry in legend] == ["right: 4 trajectories", "wrong: 1 trajectory"]


def test_the_picture_is_transparent_between_points_and_tails_grow(clip):
    pictures = gather_clip_pictures(*clip, CONFIG, (FUSED,), 4)
    drawn = [np.asarray(Image.open(io.BytesIO(picture.data)))[..., 3] > 0 for picture in pictures.layers[2].pictures]
    assert drawn[0].sum() < drawn[2].sum() < drawn[3].sum() < 0.2 * drawn[0].size
    assert not drawn[3][30:50].any()


def test_the_canvas_contains_all_visible_points():
    points = np.array([[[0.0, 0.0], [1241.2, 374.4]]])
    assert clip_extent(points, np.ones((1, 2), bool)) == (375, 1242)
    assert clip_extent(points, np.array([[True, False]])) == (1, 1)


def test_a_large_clip_is_reduced(tmp_path, clip):
    store, graph = clip
    recipe = leaf_recipe("trajectories", "3" * 64)
    _put(store, recipe, {"points": np.full((5, 1, 2), 2 * CLIP_SIDE - 1.0), "visible": np.ones((5, 1), bool)})
    graph = TrajectoryGraph(graph.leaves._replace(trajectories=recipe.ref), CONFIG)
    pictures = gather_clip_pictures(store, graph, CONFIG, (), 4)
    canvas = pictures.layers[0].pictures[0]
    assert (canvas.width, canvas.height) == (CLIP_SIDE, CLIP_SIDE)


def test_the_matching_is_the_one_that_is_scored():
    rng = np.random.default_rng(0)
    for num_groups in (1, 2, 4):
        truth, predicted = rng.integers(1, 4, 60), rng.integers(0, num_groups, 60)
        matched = match_groups(predicted, truth)
        wrong = [matched.get(group) != label for group, label in zip(predicted.tolist(), truth.tolist(), strict=True)]
        assert 100 * np.mean(wrong) == pytest.approx(clustering_error(predicted, truth))


def test_trajectories_without_a_label_do_not_take_part_in_the_matching():
    """Group 7 holds the most trajectories of label 1 only if those without a label do not count."""
    truth, predicted = np.array([1, 1, 1, 2, 0, 0, 0]), np.array([7, 7, 8, 8, 8, 8, 9])
    assert match_groups(predicted, truth) == {7: 1, 8: 2}


def test_trajectories_without_a_label_have_a_colour_of_their_own(tmp_path, clip):
    store, graph = clip
    recipe = leaf_recipe("trajectory_labels", "4" * 64)
    _put(store, recipe, {"labels": np.array([1, 1, 0, 2, 2], np.uint16)})
    graph = TrajectoryGraph(graph.leaves._replace(labels=recipe.ref), CONFIG)
    ref = graph.clustering(FUSED)
    assert store.has(ref)
    pictures = gather_clip_pictures(store, graph, CONFIG, (FUSED,), 4)
    for name in ("ground truth", "errors (fused)"):
        layer = _layer(pictures, name)
        assert _colours_at_points(layer.pictures[-1])[2] == as_hex(UNLABELLED_COLOUR)
        assert layer.legend[-1].meaning == "no label, not scored: 1 trajectory"
    meanings = [entry.meaning for entry in _layer(pictures, "errors (fused)").legend]
    assert meanings[:2] == ["right: 4 trajectories", "wrong: 0 trajectories"]
    named = [entry.meaning for entry in _layer(pictures, "motions (fused)").legend]
    assert named == ["motion 0, matched with label 2: 3 trajectories", "motion 5, matched with label 1: 2 trajectories"]


def test_absent_artifacts_are_named(clip):
    store, graph = clip
    store.remove(graph.clustering(FUSED))
    pictures = gather_clip_pictures(store, graph, CONFIG, (FUSED,), 2)
    assert [layer.name for layer in pictures.layers] == ["points", "ground truth"]
    lacks = "motions (fused) [trajectory_clustering]; errors (fused) [trajectory_clustering]."
    assert pictures.missing == (f"{WhyAbsent.GONE}: {lacks}",)
    store.remove(graph.leaves.trajectories)
    nothing = gather_clip_pictures(store, graph, CONFIG, (FUSED,), 2)
    assert (nothing.layers, nothing.num_frames, nothing.shape) == ((), 0, (0, 0))
    assert nothing.missing == (f"{WhyAbsent.GONE}: the clip [trajectories].",)


def test_trajectories_are_read_once_and_give_the_clip_its_size(clip, count_reads):
    store, graph = clip
    panels = Panels(CONFIG, (FUSED,), ("clip",))
    counted = count_reads(store)
    panels.gather(counted, graph)
    assert (panels.found["clip"].num_frames, panels.found["clip"].shape) == (4, (61, 181))
    assert {counted.reads[graph.leaves.trajectories, name] for name in ("points", "visible")} == {1}
    store.remove(graph.leaves.trajectories)
    panels.gather(store, graph)
    assert (panels.found["clip"].num_frames, panels.found["clip"].layers) == (0, ())
    assert panels.found["clip"].missing == (f"{WhyAbsent.GONE}: the clip [trajectories].",)
