"""The parameters of a run that differ from their defaults."""

from enum import Enum

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.config.parameters import list_parameters, value_of
from moseg.workflows.reports.table_content import ParameterRow


def parameter_rows(config: PipelineConfig) -> tuple[ParameterRow, ...]:
    """A row for each, in the order of the stages; texts are those that ``--set`` takes."""
    rows = []
    for name, parameter in list_parameters().items():
        value = value_of(config, parameter)
        if value != parameter.default:
            unit = "" if parameter.unit is None else f" ({parameter.unit})"
            rows.append(ParameterRow(name, _text(value), _text(parameter.default), parameter.description + unit))
    return tuple(rows)


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return ",".join(map(_text, value))
    return str(value.value if isinstance(value, Enum) else "none" if value is None else value)
