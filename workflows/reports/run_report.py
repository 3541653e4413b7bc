"""The report that a run writes of itself when it has done its work."""

from collections.abc import Sequence
from pathlib import Path

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.workflows.engine.session import Session
from moseg.workflows.exports import check_writable
from moseg.workflows.reports.build import build_page, panel_notes
from moseg.workflows.reports.facts import RunFacts, facts_of_session
from moseg.workflows.reports.panels import Panels, choose_shown
from moseg.workflows.reports.table_content import ScoreTable
from moseg.workflows.reports.write import write_report


class RunReport:
    """A report to be written to `path` about these sequences.

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
        check_writable(self._path)
        self._about, self._config, self._variants = about, config, tuple(variants)
        self._names, self._seeds = tuple(names), seeds
        self._shown = choose_shown(self._names)
        self._facts: RunFacts | None = None
        self.panels = Panels(config, self._variants, self._shown)

    def note_facts(self, session: Session) -> None:
        """Keep when, where and with what the session works, while it can be asked."""
        self._facts = facts_of_session(session)

    def write(self, scores: tuple[ScoreTable, ...], notes: Sequence[str]) -> str:
        """Write the file; returns a line that says where it is and how large."""
        notes = (*notes, *panel_notes(len(self._names), len(self._shown), self._seeds))
        found = [self.panels.found[name] for name in self._shown]
        page = build_page(self._about, self._variants, self._config, self._facts, notes, scores, found)
        return write_report(self._path, page)
