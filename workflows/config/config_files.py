"""Configuration files: parameters of the pipeline in YAML, stage by stage."""

import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, ValidationError

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.config.parameter_errors import parameter_error
from moseg.workflows.config.parameters import Parameter, list_parameters, list_stages, stage_model, value_of

MAX_BYTES = 1 << 18
"""Every parameter with its comment takes a tenth of this."""
MAX_DEPTH = 10
"""Of lists and mappings within each other; parameters lie four deep."""
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
    text = _read_text(Path(path))
    try:
        values = yaml.load(text, _Loader)
    except yaml.YAMLError as error:
        raise _not_yaml(error, path) from error
    if values is None:
        raise InputError("a file without parameters", where=path, expected="stages with parameters below them, or {}")
    if not isinstance(values, dict):
        kind = "a list" if isinstance(values, list) else f"the text {str(values)[:40]!r}"
        raise InputError("not a configuration", where=path, got=kind, expected="stages with parameters below them")
    values = _without_empty_stages(values, PipelineConfig)
    try:
        PipelineConfig.model_validate(values)
    except ValidationError as error:
        raise parameter_error(error, path) from error
    return values


def write_config(config: PipelineConfig, *, changed_only: bool = False) -> str:
    """Return a configuration as YAML that `read_config_file` reads back: each parameter with what it means above it.

    Parameters
    ----------
    config : PipelineConfig
    changed_only : bool
        Leave out parameters that have their default.
    """
    chosen = [
        parameter
        for parameter in list_parameters().values()
        if not changed_only or value_of(config, parameter) != parameter.default
    ]
    return "\n".join(_lines(config, chosen)) + "\n"


def spell_value(value: Any) -> str:
    """Return a parameter's value in YAML, on one line."""
    plain = list(value) if isinstance(value, tuple) else value
    text = yaml.safe_dump(plain, default_flow_style=True, allow_unicode=True, width=float("inf"))
    return text.removesuffix("\n...\n").rstrip("\n")


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


class _Loader(yaml.SafeLoader):
    """Reads scalars as they are spelt, and refuses what a configuration has no use for: aliases and names twice."""

    yaml_implicit_resolvers: dict = {}
    _depth = 0

    def compose_node(self, parent, index):
        event = self.peek_event()
        # Nested aliases expand a few lines to gigabytes.
        if isinstance(event, yaml.AliasEvent):
            raise yaml.composer.ComposerError(None, None, "an alias (*), which is not read", event.start_mark)
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise yaml.composer.ComposerError(None, None, "nested too deep", event.start_mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_mapping(self, node, deep=False):
        seen = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.constructor.ConstructorError(None, None, "a name that is no text", key.start_mark)
            if key.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"{key.value!r} twice", key.start_mark)
            if "." in key.value:
                problem = f"{key.value!r}, a name with a dot"
                raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep=deep)

    def construct_text(self, node: yaml.ScalarNode) -> str | None:
        """Return the scalar's text; None for an empty value and for a plain null."""
        return None if node.style is None and node.value in ("", "~", "null", "Null", "NULL") else node.value


_Loader.add_constructor("tag:yaml.org,2002:str", _Loader.construct_text)


def _read_text(path: Path) -> str:
    try:
        if path.is_dir():
            raise InputError("a folder, not a file", where=path, expected="a YAML file of parameters")
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except FileNotFoundError as error:
        raise MissingInputError("no such configuration file", where=path) from error
    except OSError as error:
        raise InputError("a file that cannot be read", where=path, got=error.strerror) from error
    if len(content) > MAX_BYTES:
        raise InputError("too large for parameters", where=path, expected=f"at most {MAX_BYTES >> 10} KiB")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        got = f"byte 0x{content[error.start]:02x} at {error.start}"
        raise InputError("not UTF-8", where=path, got=got, expected="a YAML file of parameters") from error


def _not_yaml(error: yaml.YAMLError, path: str | Path) -> InputError:
    mark = getattr(error, "problem_mark", None)
    where = path if mark is None else f"{path}, line {mark.line + 1}"
    problem = getattr(error, "problem", None) or getattr(error, "reason", None) or "unreadable"
    return InputError("not a configuration", where=where, got=problem, expected="YAML: stages with parameters below")


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
