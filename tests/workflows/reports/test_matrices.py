"""Matrices of a report are those that the pipeline clustered, and sentences state how motions were counted."""

from typing import get_args

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.parameters import ClusteringParams, TrajectoryClusteringParams
from moseg.store import open_store
from moseg.tasks.clustering import cluster_motions
from moseg.tasks.clustering.spectral import normalise_affinity
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.reports.layers import all_colours, as_hex
from moseg.workflows.reports.matrices import fused_kernel, matrix_refs, mean_residuals
from moseg.workflows.reports.motion_count import FoundGroups, explain_objects, explain_tracks
from moseg.workflows.reports.subject import read_subject
from moseg.workflows.reports.variant_panels import MAX_TRACKS, sample_by_motion, variant_panel
from moseg.workflows.runlog.status import list_runs

AUTO = get_args(ClusteringParams.model_fields["auto"].annotation)
AUTO_TRACKS = get_args(TrajectoryClusteringParams.model_fields["auto"].annotation)


@pytest.fixture
def squares_graph(evaluated):
    """The store of the evaluated squares, and their graph."""
    store = open_store(str(evaluated.store), create=False)
    subject = read_subject(store, list_runs(store)[0])
    return store, SequenceGraph(subject.sequences[0].leaves, subject.config), subject.config


def _affinities(num_views, num_objects=5, seed=0):
    views = np.random.default_rng(seed).random((num_views, num_objects, num_objects))
    views = (views + views.transpose(0, 2, 1)) / 2
    for view in views:
        np.fill_diagonal(view, 0.9)
        view[1, 3] = view[3, 1] = np.nan
    return views


def test_residuals_are_averaged_over_the_pairs_that_know_them():
    sections = [np.array([[[1.0, np.nan], [4.0, np.nan]], [[3.0, 5.0], [np.nan, np.nan]]]), np.full((1, 2, 2), 8.0)]
    sections[1][0, 1] = np.nan
    assert mean_residuals(iter(sections)) == pytest.approx(np.array([[4.0, 6.5], [4.0, np.nan]]), nan_ok=True)


@pytest.mark.parametrize("fusion", ["product", "sum"])
@pytest.mark.parametrize("num_views", [1, 2])
@pytest.mark.parametrize("is_apart", [False, True])
def test_the_kernel_shown_has_the_eigenvalues_that_were_clustered(fusion, num_views, is_apart):
    views, supports = _affinities(num_views), [np.array([1.0, 0.9, 0.1, 0.9, 0.2])] * num_views
    params = ClusteringParams(fusion=fusion, static="agreement" if is_apart else "group")
    is_static = np.array([1, 1, 0, 1, 0], bool) if is_apart else None
    clustered = cluster_motions(views, None, params, is_static)
    kernel = fused_kernel(views, supports, params)
    found = np.sort(np.linalg.eigvalsh(normalise_affinity(kernel)))[::-1]
    assert found == pytest.approx(clustered.eigenvalues[0], abs=1e-9)


@pytest.mark.parametrize("num_motions", [None, 3])
def test_the_kernel_shown_sets_apart_what_a_rigid_scene_explains(num_motions):
    views, supports = _affinities(2), [np.array([1.0, 0.9, 0.1, 0.9, 0.2])] * 2
    # Object 2 is explained by a rigid scene, object 3 is not; the others are left to the views.
    rigid = np.array([1.0, np.nan, 1.0, 0.0, np.nan])
    params = ClusteringParams(static="agreement" if num_motions is None else "auto")
    clustered = cluster_motions(views, num_motions, params, np.array([1, 1, 1, 0, 0], bool))
    kernel = fused_kernel(views, supports, params, rigid)
    found = np.sort(np.linalg.eigvalsh(normalise_affinity(kernel)))[::-1]
    assert found == pytest.approx(clustered.eigenvalues[0], abs=1e-9)


def test_a_panel_shows_what_is_stored(squares_graph):
    store, graph, config = squares_graph
    panel = variant_panel(store, graph, config, Variant.FUSED)
    assert panel.missing == ()
    assert [each[:2] for each in panel.objects] == [("background", 0), ("1", 1), ("2", 2)]
    matrices = {matrix.title: matrix for matrix in panel.matrices}
    assert all(matrix.labels == ("background", "1", "2") for matrix in panel.matrices)
    assert [title for title, matrix in matrices.items() if matrix.is_log] == ["residuals, trajs", "residuals, oc-depth"]
    residuals = matrices["residuals, oc-depth"].values
    # Each object's own model fits it best.
    assert (residuals.argmin(axis=0) == range(3)).all()
    assert np.array_equal(matrices["affinity, trajs"].values, store.read(graph.motions.affinity("trajs"), "affinity"))
    found = np.sort(np.linalg.eigvalsh(normalise_affinity(matrices["fused kernel"].values)))[::-1]
    assert found == pytest.approx(panel.eigenvalues.eigenvalues, abs=1e-9)
    assert panel.eigenvalues.num_motions == 3
    assert "at least 0.5 (clustering.threshold)" in panel.eigenvalues.how
    assert "objects that every view takes for static" in panel.eigenvalues.how


def test_a_motion_model_is_spelled_as_its_variant(squares_graph):
    panel = variant_panel(*squares_graph, Variant.OC_DEPTH)
    assert [matrix.title for matrix in panel.matrices][:2] == ["residuals, oc-depth", "affinity, oc-depth"]
    assert not any("oc_depth" in matrix.description for matrix in panel.matrices)
    fused = variant_panel(*squares_graph, Variant.FUSED).matrices[-1]
    assert "affinities of trajs and oc-depth" in fused.description


def test_moving_objects_have_their_colour_of_the_overlay_with_any_name(squares_graph):
    store, graph, config = squares_graph

    class Tagged:
        def __getattr__(self, name):
            return getattr(store, name)

        def attributes(self, ref):
            found = store.attributes(ref)
            return {**found, "given": [4, 7], "tags": ["", "car"]} if ref == graph.objects.linking() else found

        def read(self, ref, name):
            motion = store.read(ref, name)
            return np.array([0, 0, 1]) if name == "motion" else motion

    colour = as_hex(all_colours()[7])
    objects = variant_panel(Tagged(), graph, config, Variant.FUSED).objects
    assert objects == (("background", 0, None, ""), ("4", 0, None, ""), ("7 car", 1, colour, ""))
    assert [each.colour for each in variant_panel(Tagged(), graph, config, Variant.BASE).objects] == [
        None,
        as_hex(all_colours()[4]),
        colour,
    ]


def test_a_panel_reads_only_sinks_of_the_run(squares_graph):
    store, graph, config = squares_graph
    read = set()

    class Recorder:
        def __getattr__(self, name):
            return lambda ref, *more: (read.add(ref), getattr(store, name)(ref, *more))[1]

    variant_panel(Recorder(), graph, config, Variant.FUSED)
    assert read == set(matrix_refs(graph, config, Variant.FUSED))


def test_objects_compared_by_hypotheses_have_no_residuals_of_their_own(squares_graph):
    store, graph, _ = squares_graph
    config = PipelineConfig.model_validate(
        {"sections": {"length": 4, "overlap": 2}, "affinity": {"method": "hypotheses"}}
    )
    panel = variant_panel(store, SequenceGraph(graph.leaves, config), config, Variant.TRAJS)
    assert any(text.startswith("residuals: affinity hypotheses") for text in panel.missing)
    assert not any("residuals, " in text for text in panel.missing)


@pytest.mark.parametrize(("motions", "word"), [("gt", "ground truth"), (5, "clustering.motions")])
def test_a_given_number_is_named_with_the_reason_for_fewer_groups(motions, word):
    for explain, params in ((explain_objects, ClusteringParams()), (explain_tracks, TrajectoryClusteringParams())):
        how = explain(FoundGroups(motions, 5, 5, 9), params)
        assert how.startswith("Given: 5") and word in how and how.endswith("included.")
        assert "; there are only 2 " in explain(FoundGroups(motions, 5, 2, 2), params)
        assert explain(FoundGroups(motions, 5, 4, 9), params).endswith("; the clustering made only 4.")


def test_a_number_given_beyond_the_objects_is_not_shown_as_their_number(squares_graph, evaluated_copy, moseg):
    _, graph, config = squares_graph
    assert moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store, "--motions", "5").code == 0
    config = config.model_copy(update={"clustering": config.clustering.model_copy(update={"motions": 5})})
    store = open_store(str(evaluated_copy.store), create=False)
    plot = variant_panel(store, SequenceGraph(graph.leaves, config), config, Variant.FUSED).eigenvalues
    assert plot.num_motions == 3
    assert plot.how == (
        "Given: 5 (clustering.motions), the background's included;"
        " there are only 3 objects, the background among them, to group."
    )


@pytest.mark.parametrize(
    ("scores", "costs"),
    [
        ((0.0, -12.5), "0, 12.5"),
        ((0.0, -0.0, -0.5), "0, 0, 0.5"),
        ((float("nan"), float("nan"), -1.0), "nan, nan, 1"),
        ((-1.00001, -1.00002), "1.00001, 1.00002"),
    ],
)
def test_costs_are_listed_with_as_many_digits_as_they_need(scores, costs):
    how = explain_objects(FoundGroups("auto", None, 2, 6), ClusteringParams(auto="geometric"), scores)
    assert f"for 1, 2, … groups asked for {costs} (" in how


@pytest.mark.parametrize("auto", AUTO)
def test_every_method_that_counts_motions_of_objects_has_a_sentence(auto):
    scores = () if auto in ("threshold", "eigengap") else (-12.5, -10.25)
    found = FoundGroups("auto", None, 2, 6)
    how = explain_objects(found, ClusteringParams(auto=auto, static="group"), scores)
    assert how.startswith("Found: ") and how.endswith(".") and auto in how
    if auto in ("description_length", "geometric"):
        assert "for 1, 2, … groups asked for 12.5, 10.25 (" in how
    elif scores:
        assert "for 1, 2, … groups asked for -12.5, -10.25 (" in how
    how = explain_objects(found, ClusteringParams(auto=auto, static="agreement"), scores)
    assert "static, by 0.5 or more, are a group of their own" in how and how.endswith(".")
    compared = explain_objects(found, ClusteringParams(auto=auto, static="agreement"), scores, has_rigid=True)
    assert "objects that a rigid scene explains, and of those that it leaves open the ones that every view" in compared
    # The static block is set apart after the grouping: what is asked for is not the number of groups.
    assert ("whatever number of groups is asked for" in how) == bool(scores)


def test_different_scores_are_written_differently_and_equal_ones_equally():
    params = ClusteringParams(auto="description_length", static="group")
    how = explain_objects(FoundGroups("auto", None, 2, 6), params, (-123456.25, -123456.25, -123456.5))
    assert "123456.2, 123456.2, 123456.5 (" in how


@pytest.mark.parametrize("auto", AUTO_TRACKS)
def test_every_method_that_counts_motions_of_tracks_has_a_sentence(auto):
    found = FoundGroups("auto", None, 2, 400)
    how = explain_tracks(found, TrajectoryClusteringParams(auto=auto, separate=False))
    assert how.startswith("Found: ") and how.endswith(".") and auto in how
    assert "lie apart" in explain_tracks(found, TrajectoryClusteringParams(auto=auto))


def test_the_sentence_on_the_energy_has_all_its_weights():
    params = TrajectoryClusteringParams(
        separate=False,
        most_motions=4,
        energy={"least_unit": 0.2, "cut_weight": 0.7, "motion_weight": 0.03, "chance_weight": 0},
    )
    how = explain_tracks(FoundGroups("auto", None, 2, 400), params)
    assert how.startswith("Found: of 1 to 4 motions those of least energy: ")
    assert "as a share of their cost under a single motion (of 0.2 where that is less)" in how
    assert "plus 0.7 times the normalised cut, plus 2.5 times the coding length" in how
    assert how.endswith("plus 0.03 for each motion beyond 2.")
    by_chance = params.model_copy(update={"energy": params.energy.model_copy(update={"chance_weight": 1.5})})
    how_many = "plus 0.03 and 1.5 divided by the square root of the number of tracks for each motion beyond 2."
    assert explain_tracks(FoundGroups("auto", None, 2, 400), by_chance).endswith(how_many)
    assert "of 1 to 3 motions" in explain_tracks(FoundGroups("auto", None, 2, 3), params)
    unsearched = params.model_copy(update={"num_refined": 0})
    assert "energy, the mean over the draws: " in explain_tracks(FoundGroups("auto", None, 2, 400), unsearched)
    spectral = unsearched.model_copy(update={"method": "sum"})
    assert "mean over the draws" not in explain_tracks(FoundGroups("auto", None, 2, 400), spectral)


def test_with_several_views_the_drop_is_that_of_their_mean():
    objects, tracks = ClusteringParams(auto="eigengap"), TrajectoryClusteringParams(auto="eigengap")
    for explain, params in ((explain_objects, objects), (explain_tracks, tracks)):
        assert "before their largest drop" in explain(FoundGroups("auto", None, 2, 9, num_views=1), params)
        assert "before the largest drop of the views' mean" in explain(FoundGroups("auto", None, 2, 9, 2), params)


def test_tracks_are_sampled_evenly_in_the_order_of_their_motions():
    motion = np.array([1] * 3000 + [0] * 1000)
    chosen = sample_by_motion(motion)
    assert len(chosen) == MAX_TRACKS == len(set(chosen.tolist()))
    assert motion[chosen].tolist() == [0] * (MAX_TRACKS // 4) + [1] * (3 * MAX_TRACKS // 4)
    assert sample_by_motion(np.array([1, 0, 1])).tolist() == [1, 0, 2]
    assert sample_by_motion(np.zeros(0)).tolist() == []
