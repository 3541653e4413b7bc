"""The page of a run put together and written, by the run itself when it has done its work or later from its log."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.workflows.engine.session import Session
from moseg.workflows.exports import TextKind, check_replaceable, write_text
from moseg.workflows.reports.content import ReportPage, ScoreTable, SequencePanel
from moseg.workflows.reports.facts import RunFacts, facts_of_session, parameter_rows
from moseg.workflows.reports.page import render_page
from moseg.workflows.reports.panels import MAX_SEQUENCES, Panels, choose_shown
from moseg.workflows.runlog.events import as_unicode


def build_page(
    about: str,
    variants: Sequence[Variant | TrajectoryVariant],
    config: PipelineConfig,
    facts: RunFacts,
    notes: Iterable[str],
    scores: tuple[ScoreTable, ...],
    panels: Iterable[SequencePanel],
) -> ReportPage:
    """Return the page of a run about a data set or a video."""
    return ReportPage(
        title=f"{about}: {', '.join(variant.value for variant in variants)}",
        facts=facts.rows,
        notes=tuple(notes),
        scores=scores,
        sequences=tuple(panels),
        stages=facts.stages,
        parameters=parameter_rows(config),
    )


def panel_notes(num_sequences: int, num_shown: int, seeds: Sequence[int] | None = None) -> tuple[str, ...]:
    """Return notes on the pictures: how many sequences have some, and which seed they show."""
    notes = []
    if num_shown < num_sequences:
        notes.append(
            f"pictures of the first {MAX_SEQUENCES} of {num_sequences} sequences: `moseg report RUN --sequences a,b`"
            " shows others; the tables have all"
        )
    if seeds is not None:
        notes.append(f"pictures and matrices are those of seed {seeds[0]}")
    return tuple(notes)


def write_report(path: Path, page: ReportPage) -> str:
    """Write the page, whole or not at all, and return a line that names the file and its size.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_text(path, as_unicode(render_page(page)))
    return f"report: {path} ({Path(path).stat().st_size / 1e6:.1f} MB)"


class RunReport:
    """A report that a run writes to `path` about these sequences.

    Attributes
    ----------
    panels : Panels
        For the run to gather.

    Raises
    ------
    InputError
        No file could be written at `path`.
    """

    def __init__(
        self,
        path: Path | str,
        about: str,
        config: PipelineConfig,
        variants: Sequence[Variant] | Sequence[TrajectoryVariant],
        names: Sequence[str],
        seeds: Sequence[int] | None = None,
    ):
        self._path = Path(path)
        check_replaceable(self._path, TextKind.PAGE)
        self._about, self._config, self._variants = about, config, tuple(variants)
        self._names, self._seeds = tuple(names), seeds
        self._shown = choose_shown(self._names)
        self._facts: RunFacts | None = None
        self.panels = Panels(config, self._variants, self._shown)

    def note_facts(self, session: Session) -> None:
        """Keep the facts of the session before it closes."""
        self._facts = facts_of_session(session)

    def write(self, scores: tuple[ScoreTable, ...], notes: Sequence[str]) -> str:
        """Write the file and return a line that names it and its size."""
        notes = (*notes, *panel_notes(len(self._names), len(self._shown), self._seeds))
        found = [self.panels.found[name] for name in self._shown]
        page = build_page(self._about, self._variants, self._config, self._facts, notes, scores, found)
        return write_report(self._path, page)
