"""Tables of a report: measured figures, and published ones apart from them."""

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.scores import SequenceScore, StillScore
from moseg.schemas.trajectory_scores import GroupMean, TrajectoryMean, TrajectoryRow, TrajectoryScore
from moseg.workflows.reports.content import Better
from moseg.workflows.reports.equal_rows import equality_notes
from moseg.workflows.reports.facts import parameter_rows
from moseg.workflows.reports.published_scores import PAPER_ROWS, PUBLISHED_ERRORS
from moseg.workflows.reports.score_tables import clip_tables, score_tables

SCORE = SequenceScore(P=1, R=2, F=3, J=4, boundary_F=5, J_objects=6, boundary_F_objects=7)
POINTS = SequenceScore(P=1, R=2, F=3, J=4, J_objects=6)


def test_the_papers_rows_have_our_columns_and_are_marked():
    (ours, paper) = score_tables("davis-moving", "pixels", {"fused": {"dog": SCORE}})
    assert ours.columns == ("sequence", "Pu", "Ru", "Fu", "J", "F-boundary", "J/object", "F-b/object")
    assert ours.rows == (("dog", (1, 2, 3, 4, 5, 6, 7)),)
    assert paper.is_published and not ours.is_published and paper.columns[1:] == ours.columns[1:]
    assert dict(paper.rows)["paper, fused"] == (*PAPER_ROWS["davis-moving"]["paper, fused"], None, None, None, None)


def test_other_data_sets_have_no_rows_of_the_paper():
    assert not any(table.is_published for table in score_tables("davis16", "pixels", {"fused": {"dog": SCORE}}))


def test_points_have_no_boundaries_and_the_paper_scores_pixels():
    ours, paper = score_tables("kt3dinsmoseg", "points", {"fused": {"clip": POINTS}})
    assert ours.columns[1:] == ("Pu", "Ru", "Fu", "J", "J/object") and "over points" in ours.title
    assert (ours.over, paper.over) == ("points", "pixels")


def test_several_variants_are_compared_first():
    other = SCORE.model_copy(update={"P": 3.0})
    means, fused, base = score_tables(
        "folder", "pixels", {"fused": {"a": SCORE, "b": other}, "base": {"a": SCORE, "b": SCORE}}
    )
    assert means.title == "folder, mean of 2 sequences" and [name for name, _ in means.rows] == ["fused", "base"]
    assert means.rows[0][1] == fused.rows[-1][1] == (2, 2, 3, 4, 5, 6, 7)
    assert base.title == "folder, base"


def test_a_mean_over_incomplete_scores_is_empty():
    means, fused, base = score_tables(
        "folder", "pixels", {"fused": {"a": SCORE, "b": None}, "base": {"a": SCORE, "b": SCORE}}
    )
    assert fused.rows[0][1] == (1, 2, 3, 4, 5, 6, 7)
    assert fused.rows[1][1] == fused.rows[2][1] == means.rows[0][1] == (None,) * 7
    assert None not in base.rows[-1][1]


def _row(variant, spread=None, num_motions=3, error=12.5):
    scores = {"clip": TrajectoryScore(error=error, num_motions=num_motions, num_motions_true=2, spread=spread)}
    return TrajectoryRow(
        variant=variant,
        sequences=scores,
        mean=TrajectoryMean(error=error, median_error=error, num_motions_correct=0.0),
        spread=spread,
    )


def test_smaller_errors_are_better():
    means, fused, trajs, published = clip_tables("kt3dmoseg", (_row("fused"), _row("trajs", num_motions=4)))
    assert means.columns == ("variant", "mean error %", "median", "right number %")
    assert means.better == (Better.LESS, Better.LESS, Better.MORE)
    assert fused.rows[0] == ("clip", (12.5, 3, 2)) and trajs.better == (Better.LESS, None, None)
    assert published.is_published and dict(published.rows)["homography"] == PUBLISHED_ERRORS["homography"]


def test_tables_over_seeds_have_the_spread():
    fused, _ = clip_tables("kt3dmoseg", (_row("fused", spread=0.5),))
    assert fused.columns[-1] == "spread of error" and fused.rows[0] == ("clip", (12.5, 3, 2, 0.5))
    assert {len(values) for _, values in fused.rows} == {len(fused.better)} == {len(fused.decimals)} == {4}


def _group(error, num_sequences):
    figures = {"error": error, "median_error": error / 2, "num_motions_correct": 50.0}
    return GroupMean(**figures, num_sequences=num_sequences, num_published=120)


def test_errors_by_group_precede_the_published_ones_of_the_same_columns():
    rows = tuple(
        _row(name, error=error).model_copy(
            update={"groups": {"two motions": _group(error, 60), "a new group": _group(9.0, 2)}}
        )
        for name, error in (("fused", 1.0), ("trajs", 3.0))
    )
    _, _, _, means, published_means, medians, published_medians = clip_tables("hopkins155", rows)
    assert means.columns == ("mean error %", "two motions (60 of 120)", "a new group (2 of 120)")
    assert means.rows == (("fused", (1.0, 9.0)), ("trajs", (3.0, 9.0))) and means.better == (Better.LESS,) * 2
    assert medians.rows == (("fused", (0.5, 4.5)), ("trajs", (1.5, 4.5)))
    assert published_means.is_published and published_means.columns == means.columns
    assert published_medians.is_published and published_medians.columns == medians.columns
    assert dict(published_means.rows)["RSIM*"] == (0.78, None) and dict(published_means.rows)["SCC"] == (1.41, None)
    assert dict(published_medians.rows)["LSA*"] == (0.59, None) and dict(published_medians.rows)["SCC"] == (None, None)


def test_clips_of_another_data_set_have_no_published_rows():
    assert [table.is_published for table in clip_tables("mine", (_row("fused"),))] == [False]


def test_parameters_that_differ_are_listed_as_a_user_writes_them():
    assert parameter_rows(PipelineConfig()) == ()
    settings = {
        "detections": {"tags": "car,person"},
        "affinity": {"excess": False},
        "clustering": {"motions": "gt", "count": {"gap": 5}},
        "hypotheses": {"gaps": "1,2"},
    }
    config = PipelineConfig.model_validate(settings)
    rows = {row.name: (row.value, row.default) for row in parameter_rows(config)}
    assert rows == {
        "detections.tags": ("car,person", "none"),
        "affinity.excess": ("false", "true"),
        "clustering.motions": ("gt", "auto"),
        "clustering.count.gap": ("5", "3"),
        "hypotheses.gaps": ("1,2", "3"),
    }
    assert all(row.description for row in parameter_rows(config))


def test_where_nothing_moves_less_is_better_and_small_percentages_are_legible():
    (table,) = score_tables("still", "still", {"fused": {"street": StillScore(false_pixels=0.03, false_frames=4.0)}})
    assert table.columns == ("sequence", "false pixels %", "false frames %")
    assert table.rows == (("street", (0.03, 4.0)),)
    assert table.better == (Better.LESS, Better.LESS) and table.decimals == (2, 2)


def test_variants_with_the_same_scores_share_their_rows():
    other = SCORE.model_copy(update={"P": 3.0})
    alike, scores = {"a": SCORE, "b": other}, {}
    for variant in ("fused", "oc-depth", "oc", "trajs", "base"):
        scores[variant] = dict(alike)
    means, sequences = score_tables("folder", "pixels", scores)
    assert [name for name, _ in means.rows] == ["fused, oc-depth, oc, trajs, base"]
    assert sequences.title == "folder, fused, oc-depth, oc, trajs, base"
    scores["oc"] = {"a": SCORE, "b": SCORE}
    means, *sequences = score_tables("folder", "pixels", scores)
    assert [name for name, _ in means.rows] == ["fused, oc-depth, trajs, base", "oc"]
    assert len(sequences) == 2


def test_missing_scores_are_equal_to_none():
    means, *sequences = score_tables("folder", "pixels", {"fused": {"a": None}, "base": {"a": None}})
    assert len(means.rows) == len(sequences) == 2
    assert equality_notes({"fused": {"a": None}, "base": {"a": None}}) == ()


def test_a_note_says_that_the_proposals_alone_decide():
    other = SCORE.model_copy(update={"P": 3.0})
    names = [f"clip{index}" for index in range(4)]
    alike = {variant: dict.fromkeys(names, SCORE) for variant in ("fused", "oc", "base")}
    (note,) = equality_notes(alike)
    assert note.startswith("fused, oc and base score the same on every sequence: the proposals alone decide")
    (note,) = equality_notes(alike | {"oc": alike["oc"] | {"clip2": other}})
    assert note == (
        "the variants differ on 1 of 4 sequences (clip2); on the others the proposals alone decide what moves"
    )
    mostly = dict.fromkeys(names[:3], other) | {"clip3": SCORE}
    assert equality_notes(alike | {"oc": mostly}) == ()
    assert equality_notes({"fused": alike["fused"]}) == ()
    # Without `base` it is only known that the others agree.
    (note,) = equality_notes({name: alike[name] for name in ("fused", "oc")})
    assert "proposals" not in note and "motion models agree" in note


def test_clips_with_the_same_errors_share_their_rows_too():
    means, clips, published = clip_tables("kt3dmoseg", (_row("fused"), _row("trajs")))
    assert [name for name, _ in means.rows] == ["fused, trajs"]
    assert clips.title.startswith("kt3dmoseg, fused, trajs (") and published.is_published
