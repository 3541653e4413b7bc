"""Tables of a report: what was measured, and what the paper reports of the same data set."""

from collections.abc import Mapping, Sequence

from moseg.schemas.scores import GroundTruth, SequenceScore, mean_score
from moseg.workflows.reports.published_scores import PAPER_COLUMNS, PAPER_ROWS
from moseg.workflows.reports.score_columns import score_columns
from moseg.workflows.reports.table_content import ScoreTable

Scores = Mapping[str, Mapping[str, SequenceScore | None]]
"""By variant and sequence; None where a score is not in the store."""


def score_tables(dataset: str, over: GroundTruth, scores: Scores) -> tuple[ScoreTable, ...]:
    """Means of the variants where there are several, every sequence of each variant, and the paper's rows."""
    named = f"{dataset}, over points" if over == "points" else dataset
    columns = score_columns(over)
    tables = []
    if len(scores) > 1:
        num_sequences = len(next(iter(scores.values())))
        title = f"{named}, mean of {num_sequences} sequence{'' if num_sequences == 1 else 's'}"
        rows = tuple((variant, _mean(list(by_name.values()), over)) for variant, by_name in scores.items())
        tables.append(ScoreTable(title, ("variant", *columns), rows, over=over))
        tables.extend(_paper_tables(dataset, over))
    for variant, by_name in scores.items():
        rows = tuple((name, _cells(score, over)) for name, score in by_name.items())
        rows += (("mean", _mean(list(by_name.values()), over)),)
        tables.append(ScoreTable(f"{named}, {variant}", ("sequence", *columns), rows, over=over))
    return tuple(tables) if len(scores) > 1 else (*tables, *_paper_tables(dataset, over))


def _paper_tables(dataset: str, over: GroundTruth) -> tuple[ScoreTable, ...]:
    """The paper's rows under our columns, of which it has some."""
    if dataset not in PAPER_ROWS:
        return ()
    columns = tuple(score_columns(over))
    rows = []
    for method, values in PAPER_ROWS[dataset].items():
        by_column = dict(zip(PAPER_COLUMNS, values, strict=True))
        rows.append((method, tuple(map(by_column.get, columns))))
    title = f"{dataset}, as the paper reports it for the whole data set"
    # The paper scores pixels, whatever we do.
    decimals = (2,) * len(columns)
    return (ScoreTable(title, ("method", *columns), tuple(rows), is_published=True, over="pixels", decimals=decimals),)


def _cells(score: SequenceScore | None, over: GroundTruth) -> tuple[float | None, ...]:
    return tuple(None if score is None else getattr(score, name) for name in score_columns(over).values())


def _mean(scores: Sequence[SequenceScore | None], over: GroundTruth) -> tuple[float | None, ...]:
    """Of all sequences or of none: a mean of those that happen to be stored is no result."""
    return _cells(None if None in scores else mean_score(list(scores)), over)
