"""Facts of a run: when, where and with what it was made, what it cost, and which parameters differ from defaults."""

import os
import shlex
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from enum import Enum
from importlib.metadata import version
from typing import NamedTuple

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.stretch_choice import StretchChoice
from moseg.store import ArtifactStore
from moseg.workflows.config.parameters import list_parameters, value_of
from moseg.workflows.engine.session import Session
from moseg.workflows.reports.content import ParameterRow, StageRow
from moseg.workflows.reports.page.numbers import duration
from moseg.workflows.runlog.choices import describe_choices
from moseg.workflows.runlog.events import as_unicode, this_process
from moseg.workflows.runlog.status import RunStatus


class RunFacts(NamedTuple):
    """The head of a report, as names and values, and its stages."""

    rows: tuple[tuple[str, str], ...]
    stages: tuple[StageRow, ...]


def facts_of_session(session: Session) -> RunFacts:
    """Return the facts of a session that has done its work and is not closed yet."""
    words = [os.path.basename(sys.argv[0]), *sys.argv[1:]]
    rows = (
        ("command", as_unicode(shlex.join(words))),
        ("run", session.run_id if session.log.is_open else "computed nothing, so it left no log"),
        ("began", _format_time(datetime.now(UTC) - timedelta(seconds=session.seconds))),
        ("took", duration(session.seconds)),
        ("version", f"moseg {version('moseg')}"),
        ("host", this_process()["host"]),
        ("workers", str(session.runner.num_workers())),
        ("store", session.store.url),
        *_choice_rows(session.log.choices),
    )
    return RunFacts(rows, tuple(StageRow(name, *use) for name, use in session.stages().items()))


def facts_of_log(store: ArtifactStore, status: RunStatus) -> RunFacts:
    """Return the facts of a run that left a log."""
    state = status.state.value if status.message is None else f"{status.state.value}: {status.message}"
    rows = (
        ("command", shlex.join(status.command)),
        ("run", f"{status.run_id} ({state})"),
        ("began", _format_time(status.started)),
        ("took", duration(status.seconds)),
        ("version", f"moseg {status.version}"),
        ("host", status.host),
        ("workers", str(status.num_workers)),
        ("store", store.url),
        *_choice_rows(status.choices),
    )
    # An artifact that another run stored first was not computed by this run, even if this run had begun it.
    stages = (StageRow(use.stage, use.committed, use.hits + use.lost_races, use.seconds) for use in status.stages)
    return RunFacts(rows, tuple(stages))


def parameter_rows(config: PipelineConfig) -> tuple[ParameterRow, ...]:
    """Return the parameters that differ from their defaults, by stage; texts are those that ``--set`` takes."""
    rows = []
    for name, parameter in list_parameters().items():
        value = value_of(config, parameter)
        if value != parameter.default:
            unit = "" if parameter.unit is None else f" ({parameter.unit})"
            texts = _format_value(value), _format_value(parameter.default)
            rows.append(ParameterRow(name, *texts, parameter.description + unit))
    return tuple(rows)


def _choice_rows(choices: Mapping[str, Sequence[StretchChoice]]) -> tuple[tuple[str, str], ...]:
    """Return a row about the sources of proposals, where they were left to the camera's motion."""
    return (("proposals", describe_choices(choices)),) if choices else ()


def _format_time(moment: datetime) -> str:
    return f"{moment.astimezone(UTC):%Y-%m-%d %H:%M:%S} UTC"


def _format_value(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return ",".join(map(_format_value, value))
    return str(value.value if isinstance(value, Enum) else "none" if value is None else value)
