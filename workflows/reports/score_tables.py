"""Score tables: what was measured over frames or trajectories, and what papers report of the same data set."""

from collections.abc import Mapping, Sequence
from typing import TypeVar

from moseg.schemas.scores import AnyScore, EvaluationRow, GroundTruth, StillRow, mean_score
from moseg.schemas.trajectory_scores import TrajectoryRow
from moseg.workflows.reports.content import Better, ScoreTable
from moseg.workflows.reports.equal_rows import group_equal, name_group
from moseg.workflows.reports.published_groups import PUBLISHED_GROUPS, RERUN_NOTE
from moseg.workflows.reports.published_scores import (
    ONE_MOTION_ERROR,
    PAPER_COLUMNS,
    PAPER_ROWS,
    PUBLISHED_CLIPS,
    PUBLISHED_ERRORS,
)

Scores = Mapping[str, Mapping[str, AnyScore | None]]
"""By variant and sequence; None where a score is not in the store."""
AnyRow = TypeVar("AnyRow", EvaluationRow, StillRow, TrajectoryRow)
_COLUMNS = {
    "Pu": "P",
    "Ru": "R",
    "Fu": "F",
    "J": "J",
    "F-boundary": "boundary_F",
    "J/object": "J_objects",
    "F-b/object": "boundary_F_objects",
}
_STILL_COLUMNS = {"false pixels %": "false_pixels", "false frames %": "false_frames"}


def score_columns(over: GroundTruth) -> dict[str, str]:
    """Return the fields of a score by their column heads; points have no boundary scores."""
    if over == "still":
        return dict(_STILL_COLUMNS)
    return {head: name for head, name in _COLUMNS.items() if over == "pixels" or "boundary" not in name}


def score_decimals(over: GroundTruth) -> int:
    """Return the digits after the point of measured scores; false pixels are a few in a thousand."""
    return 2 if over == "still" else 1


def score_tables(dataset: str, over: GroundTruth, scores: Scores) -> tuple[ScoreTable, ...]:
    """Return means of the variants where there are several, every sequence of each variant, and the paper's rows.

    Variants with the same scores share their rows.
    """
    named = f"{dataset}, over points" if over == "points" else dataset
    columns = score_columns(over)
    groups = {name_group(names): by_name for names, by_name in group_equal(scores).items()}
    tables = []
    if len(scores) > 1:
        title = f"{named}, mean of {_count(len(next(iter(scores.values()))), 'sequence')}"
        rows = tuple((variant, _mean(list(by_name.values()), over)) for variant, by_name in groups.items())
        tables.append(_measured(title, ("variant", *columns), rows, over))
        tables.extend(_paper_tables(dataset, over))
    for variant, by_name in groups.items():
        tables.append(_measured(f"{named}, {variant}", ("sequence", *columns), _sequence_rows(by_name, over), over))
    return tuple(tables) if len(scores) > 1 else (*tables, *_paper_tables(dataset, over))


def _sequence_rows(by_name: Mapping[str, AnyScore | None], over: GroundTruth) -> tuple:
    """Return a row for each sequence, and their mean where there are several."""
    rows = tuple((name, _cells(score, over)) for name, score in by_name.items())
    return (*rows, ("mean", _mean(list(by_name.values()), over))) if len(rows) > 1 else rows


def _measured(title: str, columns: tuple[str, ...], rows: tuple, over: GroundTruth) -> ScoreTable:
    if over != "still":
        return ScoreTable(title, columns, rows, over=over)
    num_figures = len(columns) - 1
    decimals = (score_decimals(over),) * num_figures
    return ScoreTable(title, columns, rows, better=(Better.LESS,) * num_figures, decimals=decimals)


def clip_tables(dataset: str, rows: tuple[TrajectoryRow, ...]) -> tuple[ScoreTable, ...]:
    """Return the same of labelled trajectories, whose score is an error: the less, the better.

    Errors by group of clips, where the data set has groups, have a row for each variant and each published method.
    """
    shown = share_rows(rows)
    tables = [_variant_table(dataset, shown)] if len(rows) > 1 else []
    clips = (_clip_table(dataset, row) for row in shown)
    return (*tables, *clips, *_group_tables(dataset, shown), *_published(dataset))


def share_rows(rows: Sequence[AnyRow]) -> tuple[AnyRow, ...]:
    """Return the rows of variants, with one row for those whose scores are the same."""
    unnamed = {row.variant: row.model_copy(update={"variant": ""}) for row in rows}
    return tuple(row.model_copy(update={"variant": name_group(names)}) for names, row in group_equal(unnamed).items())


def _paper_tables(dataset: str, over: GroundTruth) -> tuple[ScoreTable, ...]:
    """Return the paper's rows under our columns, of which the paper has some."""
    if dataset not in PAPER_ROWS:
        return ()
    columns = tuple(score_columns(over))
    rows = []
    for method, values in PAPER_ROWS[dataset].items():
        by_column = dict(zip(PAPER_COLUMNS, values, strict=True))
        rows.append((method, tuple(map(by_column.get, columns))))
    title = f"{dataset}, as the paper reports it for the whole data set"
    # The paper scores pixels, also where we score points.
    decimals = (2,) * len(columns)
    return (ScoreTable(title, ("method", *columns), tuple(rows), is_published=True, over="pixels", decimals=decimals),)


def _cells(score: AnyScore | None, over: GroundTruth) -> tuple[float | None, ...]:
    return tuple(None if score is None else getattr(score, name) for name in score_columns(over).values())


def _mean(scores: Sequence[AnyScore | None], over: GroundTruth) -> tuple[float | None, ...]:
    """Average all sequences, or none: a mean of those that happen to be stored is no result."""
    return _cells(None if None in scores else mean_score(list(scores)), over)


def _variant_table(dataset: str, rows: tuple[TrajectoryRow, ...]) -> ScoreTable:
    has_spread = rows[0].spread is not None
    means = ((row.mean.error, row.mean.median_error, row.mean.num_motions_correct) for row in rows)
    return ScoreTable(
        f"{dataset}, {_count(len(rows[0].sequences), 'clip')}",
        ("variant", "mean error %", "median", "right number %", *_if(has_spread, "spread of error")),
        tuple((row.variant, (*mean, *_if(has_spread, row.spread))) for row, mean in zip(rows, means, strict=True)),
        better=(Better.LESS, Better.LESS, Better.MORE, *_if(has_spread, None)),
    )


def _clip_table(dataset: str, row: TrajectoryRow) -> ScoreTable:
    has_spread = row.spread is not None
    cells = [
        (name, (score.error, score.num_motions, score.num_motions_true, *_if(has_spread, score.spread)))
        for name, score in row.sequences.items()
    ]
    cells.append(("mean", (row.mean.error, None, None, *_if(has_spread, row.spread))))
    cells.append(("median", (row.mean.median_error, None, None, *_if(has_spread, None))))
    return ScoreTable(
        f"{dataset}, {row.variant} ({row.mean.num_motions_correct:.0f} % with the right number of motions)",
        ("clip", "error %", "motions", "true", *_if(has_spread, "spread of error")),
        tuple(cells),
        better=(Better.LESS, None, None, *_if(has_spread, None)),
        decimals=(1, 1 if has_spread else 0, 0, *_if(has_spread, 1)),
    )


def _group_tables(dataset: str, rows: tuple[TrajectoryRow, ...]) -> tuple[ScoreTable, ...]:
    """Return mean and median errors by group: measured ones, with published ones below where there are any."""
    if not rows or rows[0].groups is None:
        return ()
    groups = rows[0].groups
    heads = tuple(f"{name} ({group.num_sequences} of {group.num_published})" for name, group in groups.items())
    styles = {"better": (Better.LESS,) * len(groups), "decimals": (2,) * len(groups)}
    tables = []
    for place, (what, field) in enumerate((("mean error %", "error"), ("median error %", "median_error"))):
        columns = (what, *heads)
        measured = tuple(
            (row.variant, tuple(getattr(row.groups[name], field) if name in row.groups else None for name in groups))
            for row in rows
        )
        tables.append(ScoreTable(f"{dataset}, {what} by group", columns, measured, **styles))
        if dataset in PUBLISHED_GROUPS:
            published = PUBLISHED_GROUPS[dataset]
            cells = tuple(
                (method, tuple(error and error[place] for error in published.errors_of(method, groups)))
                for method in published.methods
            )
            title = (
                f"{dataset}, {what} as published for all sequences of a group, number of motions given. {RERUN_NOTE}"
            )
            tables.append(ScoreTable(title, columns, cells, is_published=True, **styles))
    return tuple(tables)


def _published(dataset: str) -> tuple[ScoreTable, ...]:
    """Return what papers report for all clips of KT3DMoSeg."""
    if dataset != "kt3dmoseg":
        return ()
    rows = [*PUBLISHED_ERRORS.items(), ("everything one motion", (ONE_MOTION_ERROR, ONE_MOTION_ERROR))]
    title = f"{dataset}, as published for all {PUBLISHED_CLIPS} clips, number of motions given"
    columns = ("method (Xu, Cheong, Li, CVPR 2018)", "least error %", "largest error %")
    return (ScoreTable(title, columns, tuple(rows), is_published=True, better=(Better.LESS, Better.LESS)),)


def _if(has_column: bool, cell):
    return (cell,) if has_column else ()


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
