"""Scores of clips of labelled trajectories and the report of their evaluation, as written to JSON."""

import statistics
from collections.abc import Mapping, Sequence

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.scores import ScoredWith, StoreUse
from moseg.schemas.sequence_groups import SequenceGroup


class TrajectoryScore(Frozen):
    """Scores of one clip.

    Attributes
    ----------
    error : float
        Trajectories outside the group of their motion, under the best one-to-one matching of groups and motions, in
        percent of those that have a label.
    num_motions : int, or float
        Number of groups found; the mean if seeds are averaged.
    num_motions_true : int
        Number of labels in the ground truth; 0, which is no label, does not count.
    spread : float or None
        Sample standard deviation of the error over seeds, if several were requested; not in the JSON.
    """

    error: float
    num_motions: int | float
    num_motions_true: int
    spread: float | None = Field(None, exclude=True)


class TrajectoryMean(Frozen):
    """Mean and median error over the clips of one variant, and clips with the correct number of motions, percent."""

    error: float
    median_error: float
    num_motions_correct: float


class GroupMean(TrajectoryMean):
    """Figures over the clips of one group.

    Attributes
    ----------
    num_sequences : int
        Clips that were scored.
    num_published : int
        Clips that the group has in the published benchmark.
    """

    num_sequences: int
    num_published: int


class SeedScores(Frozen):
    """Scores of one seed: one per clip, and their mean."""

    seed: int
    sequences: dict[str, TrajectoryScore]
    mean: TrajectoryMean


class TrajectoryRow(Frozen):
    """Scores of one variant: one per clip, and their mean.

    Attributes
    ----------
    sequences, mean : scores
        Each figure is the mean over seeds if several were requested.
    groups : dict of str to GroupMean, or None
        Figures of each group of clips that papers report, if the data set has groups; means over seeds too.
    seeds : tuple of SeedScores, or None
        Scores of each seed.
    spread : float or None
        Sample standard deviation of the mean error over seeds, percent; 0 for a single one.
    """

    variant: str
    sequences: dict[str, TrajectoryScore]
    mean: TrajectoryMean
    groups: dict[str, GroupMean] | None = None
    seeds: tuple[SeedScores, ...] | None = None
    spread: float | None = None


class TrajectoryReport(Frozen):
    """Content of the file that ``--json`` writes; ``seeds`` and ``spread`` only if requested, ``notes`` never."""

    dataset: str
    rows: tuple[TrajectoryRow, ...]
    store: StoreUse
    seconds: float = Field(ge=0)
    settings: ScoredWith | None = None
    notes: tuple[str, ...] = Field((), exclude=True)


def average_clips(scores: Sequence[TrajectoryScore]) -> TrajectoryMean:
    """Return the figures over clips."""
    errors = [score.error for score in scores]
    num_correct = sum(score.num_motions == score.num_motions_true for score in scores)
    return TrajectoryMean(
        error=statistics.fmean(errors),
        median_error=statistics.median(errors),
        num_motions_correct=100 * num_correct / len(scores),
    )


def average_seeds(variant: str, by_seed: dict[int, dict[str, TrajectoryScore]]) -> TrajectoryRow:
    """Return a variant's row from the scores of the same clips with several seeds."""
    means = {seed: average_clips(list(scores.values())) for seed, scores in by_seed.items()}
    per_clip = {name: [scores[name] for scores in by_seed.values()] for name in next(iter(by_seed.values()))}
    return TrajectoryRow(
        variant=variant,
        sequences={name: _average_score(scores) for name, scores in per_clip.items()},
        mean=_average_means(list(means.values())),
        seeds=tuple(SeedScores(seed=seed, sequences=scores, mean=means[seed]) for seed, scores in by_seed.items()),
        spread=_spread([mean.error for mean in means.values()]),
    )


def average_row(
    variant: str,
    by_seed: dict[int | None, dict[str, TrajectoryScore]],
    groups: Mapping[str, Sequence[SequenceGroup]] | None = None,
) -> TrajectoryRow:
    """Return a variant's row from the scores of the clips by seed; a run without seeds has the key None.

    `groups` gives the groups of each clip.
    """
    means = _average_groups(by_seed, groups or {}) or None
    if None not in by_seed:
        return average_seeds(variant, by_seed).model_copy(update={"groups": means})
    scores = by_seed[None]
    return TrajectoryRow(variant=variant, sequences=scores, mean=average_clips(list(scores.values())), groups=means)


def _average_groups(
    by_seed: dict[int | None, dict[str, TrajectoryScore]], groups: Mapping[str, Sequence[SequenceGroup]]
) -> dict[str, GroupMean]:
    """Return the figures of each group that has a scored clip, in the order of the groups."""
    members: dict[SequenceGroup, list[str]] = {}
    for clip in next(iter(by_seed.values())):
        for group in groups.get(clip, ()):
            members.setdefault(group, []).append(clip)
    means = {}
    for group in sorted(members, key=lambda group: group.place):
        clips = members[group]
        mean = _average_means([average_clips([scores[clip] for clip in clips]) for scores in by_seed.values()])
        counts = {"num_sequences": len(clips), "num_published": group.num_published}
        means[group.name] = GroupMean(**mean.model_dump(), **counts)
    return means


def _average_means(means: Sequence[TrajectoryMean]) -> TrajectoryMean:
    """Return the mean of each figure over seeds."""
    return TrajectoryMean(
        **{field: statistics.fmean(getattr(mean, field) for mean in means) for field in TrajectoryMean.model_fields}
    )


def _average_score(scores: Sequence[TrajectoryScore]) -> TrajectoryScore:
    """Return the mean over seeds of the scores of one clip."""
    errors = [score.error for score in scores]
    return TrajectoryScore(
        error=statistics.fmean(errors),
        num_motions=statistics.fmean(score.num_motions for score in scores),
        num_motions_true=scores[0].num_motions_true,
        spread=_spread(errors),
    )


def _spread(errors: Sequence[float]) -> float:
    """Return the sample standard deviation; 0 for a single value."""
    return statistics.stdev(errors) if len(errors) > 1 else 0.0
