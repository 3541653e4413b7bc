"""Tables of a report on labelled trajectories: what was measured, and what is published of the clips."""

from moseg.schemas.trajectory_scores import TrajectoryMean, TrajectoryRow
from moseg.workflows.reports.published_scores import ONE_MOTION_ERROR, PUBLISHED_CLIPS, PUBLISHED_ERRORS
from moseg.workflows.reports.table_content import Better, ScoreTable

_SPREAD = "spread of error"


def clip_tables(dataset: str, rows: tuple[TrajectoryRow, ...]) -> tuple[ScoreTable, ...]:
    """Means of the variants where there are several, every clip of each variant, and what is published."""
    tables = [_variant_table(dataset, rows)] if len(rows) > 1 else []
    tables += [_clip_table(dataset, row) for row in rows]
    return (*tables, _published_table(dataset))


def _variant_table(dataset: str, rows: tuple[TrajectoryRow, ...]) -> ScoreTable:
    has_spread = rows[0].spread is not None
    columns = ("variant", "mean error %", "median", "right number %", *_spread_column(has_spread))
    cells = tuple((row.variant, (*_figures(row.mean), *((row.spread,) if has_spread else ()))) for row in rows)
    num_clips = len(rows[0].sequences)
    title = f"{dataset}, {num_clips} clip{'' if num_clips == 1 else 's'}"
    return ScoreTable(title, columns, cells, better=(Better.LESS, Better.LESS, Better.MORE, *((None,) * has_spread)))


def _figures(mean: TrajectoryMean) -> tuple[float, float, float]:
    return mean.error, mean.median_error, mean.num_motions_correct


def _clip_table(dataset: str, row: TrajectoryRow) -> ScoreTable:
    has_spread = row.spread is not None
    cells = [
        (name, (score.error, score.num_motions, score.num_motions_true, *((score.spread,) if has_spread else ())))
        for name, score in row.sequences.items()
    ]
    cells.append(("mean", (row.mean.error, None, None, *((row.spread,) if has_spread else ()))))
    cells.append(("median", (row.mean.median_error, None, None, *((None,) * has_spread))))
    return ScoreTable(
        f"{dataset}, {row.variant} ({row.mean.num_motions_correct:.0f} % with the right number of motions)",
        ("clip", "error %", "motions", "true", *_spread_column(has_spread)),
        tuple(cells),
        better=(Better.LESS, None, None, *((None,) * has_spread)),
        decimals=(1, 1 if has_spread else 0, 0, *((1,) * has_spread)),
    )


def _published_table(dataset: str) -> ScoreTable:
    rows = [*PUBLISHED_ERRORS.items(), ("everything one motion", (ONE_MOTION_ERROR, ONE_MOTION_ERROR))]
    title = f"{dataset}, as published for all {PUBLISHED_CLIPS} clips, number of motions given"
    columns = ("method (Xu, Cheong, Li, CVPR 2018)", "least error %", "largest error %")
    return ScoreTable(title, columns, tuple(rows), is_published=True, better=(Better.LESS, Better.LESS))


def _spread_column(has_spread: bool) -> tuple[str, ...]:
    return (_SPREAD,) if has_spread else ()
