"""Figures by group of clips are means over the clips of the group, and over seeds."""

import json

import pytest

from moseg.schemas.scores import StoreUse
from moseg.schemas.sequence_groups import SequenceGroup
from moseg.schemas.trajectory_scores import TrajectoryReport, TrajectoryScore, average_row

TRAFFIC, ALL = SequenceGroup("traffic", 0, 38), SequenceGroup("all", 1, 155)
GROUPS = {"a": (ALL,), "b": (TRAFFIC, ALL), "c": (TRAFFIC, ALL), "mine": ()}


def scores(**errors):
    return {
        name: TrajectoryScore(error=error, num_motions=2 + (error > 5), num_motions_true=2)
        for name, error in errors.items()
    }


def test_a_group_has_the_mean_and_median_of_its_clips():
    row = average_row("fused", {None: scores(a=1, b=2, c=9, mine=50)}, GROUPS)
    assert list(row.groups) == ["traffic", "all"]
    traffic, everything = row.groups.values()
    assert (traffic.error, traffic.median_error, traffic.num_motions_correct) == (5.5, 5.5, 50)
    assert (everything.error, everything.median_error) == (4, 2)
    assert everything.num_motions_correct == pytest.approx(200 / 3)
    assert (traffic.num_sequences, traffic.num_published) == (2, 38)
    assert (everything.num_sequences, everything.num_published) == (3, 155)
    # The row's own mean is over all clips.
    assert (row.mean.error, row.mean.median_error) == (15.5, 5.5)


def test_a_group_over_seeds_is_the_mean_of_the_seeds():
    by_seed = {0: scores(a=0, b=2, c=4), 1: scores(a=0, b=4, c=10)}
    traffic = average_row("fused", by_seed, GROUPS).groups["traffic"]
    assert (traffic.error, traffic.median_error, traffic.num_motions_correct) == (5, 5, 75)
    assert traffic.num_sequences == 2


def test_without_groups_the_json_has_none():
    report = [average_row("fused", {None: scores(a=1)}), average_row("trajs", {None: scores(a=1)}, GROUPS)]
    made = TrajectoryReport(dataset="x", rows=tuple(report), store=StoreUse(computed=0, reused=0), seconds=0)
    without, with_groups = json.loads(made.model_dump_json(exclude_none=True))["rows"]
    assert list(without) == ["variant", "sequences", "mean"]
    assert list(with_groups) == ["variant", "sequences", "mean", "groups"]
    assert with_groups["groups"]["all"] == {
        "error": 1,
        "median_error": 1,
        "num_motions_correct": 100,
        "num_sequences": 1,
        "num_published": 155,
    }
