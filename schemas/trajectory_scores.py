"""Scores of clips of labelled trajectories and the report of their evaluation, as written to JSON."""

import statistics
from collections.abc import Sequence

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.scores import StoreUse


class TrajectoryScore(Frozen):
    """One clip.

    Attributes
    ----------
    error : float
        Trajectories in another group than their motion's under the best one-to-one matching of groups and motions,
        percent.
    num_motions : int, or float
        Groups found; the mean where seeds are averaged.
    num_motions_true : int
        Labels in the ground truth.
    spread : float or None
        Sample standard deviation of the error over seeds, where several were asked for; no part of the JSON.
    """

    error: float
    num_motions: int | float
    num_motions_true: int
    spread: float | None = Field(None, exclude=True)


class TrajectoryMean(Frozen):
    """Over the clips of one variant: mean and median error, and clips with the right number of motions, percent."""

    error: float
    median_error: float
    num_motions_correct: float


class SeedMean(Frozen):
    """One seed's figures over all clips."""

    seed: int
    mean: TrajectoryMean


class TrajectoryRow(Frozen):
    """One variant: a score per clip, and their mean.

    Attributes
    ----------
    sequences, mean : scores
        Each figure is the mean over seeds where several were asked for.
    seeds : tuple of SeedMean, or None
        What each seed gave.
    spread : float or None
        Sample standard deviation of the mean error over seeds, percent; 0 for a single one.
    """

    variant: str
    sequences: dict[str, TrajectoryScore]
    mean: TrajectoryMean
    seeds: tuple[SeedMean, ...] | None = None
    spread: float | None = None


class TrajectoryReport(Frozen):
    """What ``--json`` writes; ``seeds`` and ``spread`` only where seeds were asked for, ``notes`` never."""

    dataset: str
    rows: tuple[TrajectoryRow, ...]
    store: StoreUse
    seconds: float = Field(ge=0)
    notes: tuple[str, ...] = Field((), exclude=True)


def average_clips(scores: Sequence[TrajectoryScore]) -> TrajectoryMean:
    """Figures over clips."""
    errors = [score.error for score in scores]
    num_correct = sum(score.num_motions == score.num_motions_true for score in scores)
    return TrajectoryMean(
        error=statistics.fmean(errors),
        median_error=statistics.median(errors),
        num_motions_correct=100 * num_correct / len(scores),
    )


def average_seeds(variant: str, by_seed: dict[int, dict[str, TrajectoryScore]]) -> TrajectoryRow:
    """A variant's row from the scores of the same clips under several seeds."""
    means = {seed: average_clips(list(scores.values())) for seed, scores in by_seed.items()}
    per_clip = {name: [scores[name] for scores in by_seed.values()] for name in next(iter(by_seed.values()))}
    return TrajectoryRow(
        variant=variant,
        sequences={name: _average_score(scores) for name, scores in per_clip.items()},
        mean=TrajectoryMean(
            **{
                field: statistics.fmean(getattr(mean, field) for mean in means.values())
                for field in TrajectoryMean.model_fields
            }
        ),
        seeds=tuple(SeedMean(seed=seed, mean=mean) for seed, mean in means.items()),
        spread=_spread([mean.error for mean in means.values()]),
    )


def average_row(variant: str, by_seed: dict[int | None, dict[str, TrajectoryScore]]) -> TrajectoryRow:
    """Return a variant's row from the scores of the clips by seed; those of a run without seeds are by None."""
    if None not in by_seed:
        return average_seeds(variant, by_seed)
    scores = by_seed[None]
    return TrajectoryRow(variant=variant, sequences=scores, mean=average_clips(list(scores.values())))


def _average_score(scores: Sequence[TrajectoryScore]) -> TrajectoryScore:
    errors = [score.error for score in scores]
    return TrajectoryScore(
        error=statistics.fmean(errors),
        num_motions=statistics.fmean(score.num_motions for score in scores),
        num_motions_true=scores[0].num_motions_true,
        spread=_spread(errors),
    )


def _spread(errors: Sequence[float]) -> float:
    """Sample standard deviation; 0 of a single value."""
    return statistics.stdev(errors) if len(errors) > 1 else 0.0
