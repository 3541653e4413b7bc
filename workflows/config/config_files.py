"""Configuration files: parameters of the pipeline in YAML, stage by stage."""

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.config.parameter_errors import parameter_error
from moseg.workflows.config.parameters import Parameter, list_parameters, list_stages, stage_model, value_of
from moseg.workflows.config.strict_yaml import YamlKind, read_yaml, spell_value

MAX_BYTES = 1 << 18
"""Every parameter with its comment takes a tenth of this."""
_KIND = YamlKind("configuration file", "parameters", "stages with parameters below them", MAX_BYTES)
WIDTH = 100
"""Columns of a written file's comments."""


def read_config_file(path: str | Path) -> dict[str, Any]:
    """Return the parameters of a YAML file, nested by stage, for `PipelineConfig.model_validate`; any subset of all.

    Each has been checked, and is as the file spells it: a text, ``None``, or a list of texts, which pydantic converts
    to the parameter's own type as it does for ``--set``. So ``1e-3`` is a number and ``no`` can be a name.

    Raises
    ------
    InputError
        Not UTF-8, not YAML or not a mapping; a name twice; an unknown parameter or a value that it cannot take.
    MissingInputError
        There is no such file.
    """
    values = read_yaml(path, _KIND)
    if values is None:
        raise InputError("a file without parameters", where=path, expected="stages with parameters below them, or {}")
    values = _without_empty_stages(values, PipelineConfig)
    try:
        PipelineConfig.model_validate(values)
    except ValidationError as error:
        raise parameter_error(error, path) from error
    return values


def changed_parameters(config: PipelineConfig) -> dict[str, Any]:
    """Return the parameters that differ from their defaults, by their full names."""
    return {
        name: value_of(config, parameter)
        for name, parameter in list_parameters().items()
        if value_of(config, parameter) != parameter.default
    }


def write_config(config: PipelineConfig, *, changed_only: bool = False) -> str:
    """Return a configuration as YAML that `read_config_file` reads back: each parameter with what it means above it.

    Parameters
    ----------
    config : PipelineConfig
    changed_only : bool
        Leave out parameters that have their default.
    """
    parameters = list_parameters()
    chosen = [parameters[name] for name in changed_parameters(config)] if changed_only else list(parameters.values())
    return "\n".join(_lines(config, chosen)) + "\n"


def _lines(config: PipelineConfig, parameters: list[Parameter]) -> Iterator[str]:
    yield "# Parameters of moseg. What is left out keeps its default; --set and other options override this file."
    if not parameters:
        yield "# All are as they are by default."
        yield "{}"
    stage: tuple[str, ...] = ()
    # Parameters before stages within the same stage, so that each stage is one block.
    for parameter in sorted(parameters, key=lambda each: _order(each.path)):
        *inner, name = parameter.path
        common = next(
            (i for i, (a, b) in enumerate(zip(inner, stage, strict=False)) if a != b), min(len(inner), len(stage))
        )
        for depth in range(common, len(inner)):
            yield from [""] if depth == 0 else []
            yield from _comment(list_stages()[".".join(inner[: depth + 1])], depth)
            yield f"{'  ' * depth}{inner[depth]}:"
        stage = tuple(inner)
        value = value_of(config, parameter)
        unit = f"; {parameter.unit}" if parameter.unit else ""
        changed = "" if value == parameter.default else f"; CHANGED, default {spell_value(parameter.default)}"
        yield from _comment(f"{parameter.description} [{parameter.values}{unit}{changed}]", len(inner))
        yield f"{'  ' * len(inner)}{name}: {spell_value(value)}"


def _order(path: tuple[str, ...]) -> list[tuple[bool, int]]:
    """Return a key that sorts the parameters of a stage, in the order of the model, before the stages within it."""
    order, model = [], PipelineConfig
    for name in path:
        inner = stage_model(model.model_fields[name])
        order.append((inner is not None, list(model.model_fields).index(name)))
        model = inner or model
    return order


def _comment(text: str, depth: int) -> list[str]:
    indent = "  " * depth + "# "
    return textwrap.wrap(
        text, WIDTH, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False, break_long_words=False
    )


def _without_empty_stages(values: dict[str, Any], model: type[BaseModel]) -> dict[str, Any]:
    """Return the values without stages in which every parameter is commented out."""
    kept = {}
    for name, value in values.items():
        field = model.model_fields.get(name)
        inner = None if field is None else stage_model(field)
        if inner is not None and value is None:
            continue
        kept[name] = _without_empty_stages(value, inner) if inner is not None and isinstance(value, dict) else value
    return kept
