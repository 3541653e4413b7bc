"""When, where and with what a run was made, and what it cost: from its session, or from its log."""

import os
import shlex
import sys
from datetime import UTC, datetime, timedelta
from importlib.metadata import version
from typing import NamedTuple

from moseg.store import ArtifactStore
from moseg.workflows.engine.session import Session
from moseg.workflows.reports.page.numbers import duration
from moseg.workflows.reports.table_content import StageRow
from moseg.workflows.runlog.events import as_unicode, this_process
from moseg.workflows.runlog.status import RunStatus


class RunFacts(NamedTuple):
    """The head of a report, as names and values, and its stages."""

    rows: tuple[tuple[str, str], ...]
    stages: tuple[StageRow, ...]


def facts_of_session(session: Session) -> RunFacts:
    """Of a session that has done its work and is not closed yet."""
    words = [os.path.basename(sys.argv[0]), *sys.argv[1:]]
    rows = (
        ("command", as_unicode(shlex.join(words))),
        ("run", session.run_id if session.log.is_open else "computed nothing, so it left no log"),
        ("began", _moment(datetime.now(UTC) - timedelta(seconds=session.seconds))),
        ("took", duration(session.seconds)),
        ("version", f"moseg {version('moseg')}"),
        ("host", this_process()["host"]),
        ("workers", str(session.runner.num_workers())),
        ("store", session.store.url),
    )
    return RunFacts(rows, tuple(StageRow(name, *use) for name, use in session.stages().items()))


def facts_of_log(store: ArtifactStore, status: RunStatus) -> RunFacts:
    """Of a run that left a log."""
    state = status.state.value if status.message is None else f"{status.state.value}: {status.message}"
    rows = (
        ("command", shlex.join(status.command)),
        ("run", f"{status.run_id} ({state})"),
        ("began", _moment(status.started)),
        ("took", duration(status.seconds)),
        ("version", f"moseg {status.version}"),
        ("host", status.host),
        ("workers", str(status.num_workers)),
        ("store", store.url),
    )
    # What somebody else stored first was not computed by this run, whatever it had begun.
    stages = (StageRow(use.stage, use.committed, use.hits + use.lost_races, use.seconds) for use in status.stages)
    return RunFacts(rows, tuple(stages))


def _moment(moment: datetime) -> str:
    return f"{moment.astimezone(UTC):%Y-%m-%d %H:%M:%S} UTC"
