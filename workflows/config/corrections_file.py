"""Corrections from files and from Python, and files of them: one edit a line, one stroke a line."""

import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pydantic import BaseModel, ValidationError

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.corrections import KINDS, Corrections, Edit, Growing, Stroke, kind_of
from moseg.schemas.errors import InputError
from moseg.schemas.spelling import closest
from moseg.workflows.config.parameter_errors import parameter_error, unknown_parameter
from moseg.workflows.config.parameters import list_parameters, list_stages, value_of
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.config.strict_yaml import YamlKind, read_yaml, spell_value

CorrectionsLike = Corrections | Mapping[str, Any] | Iterable[Mapping[str, Any] | Edit] | str | os.PathLike
"""Corrections; a mapping as the file holds it; a list of edits (``[{"drop": 2}]``); or the path of a file."""
LAYOUT = "version, video, part, settings and edits"
MAX_BYTES = 1 << 24
"""Some ten thousand strokes."""
_WORD = re.compile("[A-Za-z][A-Za-z0-9_-]*")
_KIND = YamlKind("corrections file", "corrections", LAYOUT, MAX_BYTES, has_dots=True)


def read_corrections(given: CorrectionsLike, where: str = "corrections") -> Corrections:
    """Return corrections that were given in any of their forms, with settings of their parameters' own types.

    Parameters
    ----------
    given : Corrections, mapping, list of edits or path
    where : str
        What they were given by, for errors; those of a file name the file.

    Raises
    ------
    InputError
        Not corrections: a wrong file, version, setting, edit or value.
    """
    where = name_source(given, where)
    if isinstance(given, str | os.PathLike):
        values: Any = read_yaml(where, _KIND) or {}
        if "version" not in values:
            raise InputError("not a corrections file", where=where, got="no version", expected="version: 1")
        # What stands before nothing, where all is commented out.
        values = {name: value for name, value in values.items() if value is not None}
    elif isinstance(given, Corrections | Mapping):
        values = given
    elif isinstance(given, Iterable):
        values = {"edits": tuple(given)}
    else:
        expected = "Corrections, a mapping, a list of edits, or the path of a YAML file"
        raise InputError("not corrections", where=where, got=type(given).__name__, expected=expected)
    corrections = _validate(values, where)
    return corrections.model_copy(update={"settings": _plain_settings(corrections.settings, where)})


def read_edit(given: Mapping[str, Any] | Edit, where: str) -> Edit:
    """Return one edit; raises InputError, which names what it was given by and the value that is wrong."""
    try:
        (edit,) = Corrections.model_validate({"edits": [given]}).edits
    except ValidationError as error:
        raise _error(error, where, is_edit=True) from error
    return edit


def name_source(given: CorrectionsLike | None, argument: str) -> str:
    """Return what corrections are called in errors: the path of their file, else the argument with them."""
    return os.fsdecode(given) if isinstance(given, str | os.PathLike) else argument


def spell_corrections(corrections: Corrections) -> str:
    """Return corrections as YAML that `read_corrections` reads back; equal corrections have equal texts."""
    return "\n".join(_lines(corrections)) + "\n"


def _validate(values: Any, where: str) -> Corrections:
    try:
        return Corrections.model_validate(values)
    except ValidationError as error:
        raise _error(error, where) from error


def _plain_settings(settings: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return settings as JSON values of their parameters' own types, so that ``"3"`` and 3 are one."""
    parameters = list_parameters()
    for name in settings:
        if name in list_stages():
            raise InputError("a stage, not a parameter", where=where, got=name, expected=f"{name}.NAME")
        if name not in parameters:
            raise unknown_parameter(name, where)
    try:
        config = PipelineConfig.model_validate(PipelineChoices(settings).given_values())
    except ValidationError as error:
        raise parameter_error(error, where) from error
    values = {name: value_of(config, parameters[name]) for name in settings}
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values.items()}


def _error(error: ValidationError, where: str, is_edit: bool = False) -> InputError:
    """Return the error for the first thing that is wrong, with the edit that has it, counted from 1.

    Parameters
    ----------
    is_edit : bool
        Whether the corrections are one edit, of which `where` says all: an option has no first edit.
    """
    first = error.errors()[0]
    path, message = list(first["loc"]), first["msg"].removeprefix("Value error, ")
    if path[:1] == ["edits"] and len(path) > 1:
        number, inner = path[1], path[2:]
        # The kind's tag, and its only field.
        inner = inner[1:] if len(inner) > 1 and inner[0] == inner[1] else inner
        where = where if is_edit else f"{where}: edit {number + 1}"
        if first["type"].startswith("union_tag"):
            return _unknown_kind(first["input"], where)
        path = inner
    shown = path[1:] if is_edit else path
    found = first["input"]
    if isinstance(found, BaseModel | Mapping) and not shown and is_edit:
        # Of the whole edit, its value.
        found = next(iter(dict(found).values()), None)
    place = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in shown).lstrip(".")
    where = f"{where}: {place}" if place else where
    if first["type"] == "extra_forbidden":
        return InputError("an unknown name", where=where, got=_short(found), expected=_siblings(path))
    if first["type"] == "missing":
        return InputError("a missing value", where=where)
    expected = message.removeprefix("Input should be ").partition(", unable to parse")[0]
    expected = expected.replace("a valid tuple", "a list").replace("a valid dictionary", "names with values")
    if first["type"].endswith("too_short"):
        expected = f"at least {first['ctx']['min_length']}"
    if first["type"] == "string_too_long":
        expected = f"at most {first['ctx']['max_length']} characters"
    if first["type"] == "string_pattern_mismatch":
        expected = "hexadecimal digits" if path == ["video"] else "a text of one line"
    return InputError("bad corrections", where=where, got=_short(found), expected=expected)


def _unknown_kind(value: Any, where: str) -> InputError:
    known = f"one of {', '.join(KINDS)}"
    if not isinstance(value, Mapping):
        return InputError("not an edit", where=where, got=_short(value), expected=f"{known}, with its values")
    if len(value) != 1:
        got = ", ".join(map(str, value)) or "nothing"
        return InputError("not one edit", where=where, got=got, expected=known)
    (kind,) = value
    close = closest(str(kind), KINDS)
    expected = known if close is None else f"{close}?"
    return InputError("an unknown kind of edit", where=where, got=_short(kind), expected=expected)


def _siblings(path: list) -> str:
    """Return the names that are allowed in the place of the last one of a path."""
    model: Any = Corrections
    if path[0] in KINDS:
        model = KINDS[path[0]].model_fields[path[0]].annotation
    if "strokes" in path:
        model = Stroke
    return f"one of {', '.join(model.model_fields)}"


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def _lines(corrections: Corrections) -> Iterator[str]:
    yield "# Corrections of a segmentation by moseg; docs/corrections.md describes every edit."
    yield f"version: {corrections.version}"
    if corrections.video is not None:
        # Quoted: a digest may look like a number.
        yield f"video: '{corrections.video}'"
    if corrections.part is not None:
        yield f"part: {_flow(corrections.part)}"
    if corrections.settings:
        yield "settings:"
        for name, value in corrections.settings.items():
            yield f"  {name}: {spell_value(value)}"
    if corrections.edits:
        yield "edits:"
        for edit in corrections.edits:
            yield from _edit_lines(edit)


def _edit_lines(edit: Edit) -> Iterator[str]:
    kind = kind_of(edit)
    value = getattr(edit, kind)
    if not isinstance(value, BaseModel):
        yield f"  - {kind}: {value if isinstance(value, int) else _flow(value)}"
        return
    given = value.model_dump(mode="json", exclude_defaults=not isinstance(value, Growing))
    strokes = given.pop("strokes", None)
    if strokes is None:
        yield f"  - {kind}: {_flow(given)}"
        return
    yield f"  - {kind}:"
    for name, single in given.items():
        yield f"      {name}: {_flow(single)}"
    yield "      strokes:"
    for stroke in strokes:
        yield f"        - {_flow(stroke)}"


def _flow(value: Any) -> str:
    """Return a value in YAML's flow style, on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name}: {_flow(inner)}" for name, inner in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_flow, value)) + "]"
    if isinstance(value, float):
        return str(int(value)) if value.is_integer() else repr(value)
    if not isinstance(value, str):
        return str(value)
    # JSON's quotes are YAML's too, and no text in them is anything but a text.
    is_plain = _WORD.fullmatch(value) and spell_value(value) == value
    return value if is_plain else json.dumps(value, ensure_ascii=False)
