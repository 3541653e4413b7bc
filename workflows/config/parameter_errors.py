"""Errors in a configuration, as one line in terms of its parameters."""

from typing import Any

from pydantic import ValidationError

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.spelling import closest, unknown_name
from moseg.workflows.config.parameters import list_parameters, list_stages, stage_model


def parameter_error(error: ValidationError, where: object = None) -> InputError:
    """Return the error for the first parameter that is wrong; `where` is the file that holds it.

    A parameter of several types has an error for each.
    """
    errors = error.errors()
    # Of a list whose values are all wrong, pydantic reports too that it has none.
    errors = [each for each in errors if each["type"] != "too_short"] or errors
    first = errors[0]
    name = _parameter(first)
    if first["type"] == "extra_forbidden":
        return unknown_parameter(name, where)
    expected = " or ".join(dict.fromkeys(_expected(each) for each in errors if _parameter(each) == name))
    if name in list_stages() and first["type"] == "model_type":
        known = [each.partition(f"{name}.")[2] for each in list_parameters() if each.startswith(f"{name}.")]
        expected = f"parameters by name ({', '.join(known[:3])}{', …' if len(known) > 3 else ''})"
    parameter = list_parameters().get(name)
    close = closest(str(first["input"]), parameter.choices) if parameter else None
    if close is not None:
        expected += f"; did you mean {close!r}?"
    where = name if where is None else f"{where}: {name}"
    return InputError("bad parameter", where=where, got=_short(first["input"]), expected=expected)


def unknown_parameter(name: str, where: object = None) -> InputError:
    """Return the error for a ``stage.name``, or a stage, that does not exist."""
    stage, dot, last = name.rpartition(".")
    parameters, stages = list_parameters(), list_stages()
    # Without its stage, or under another one: the name itself is right. Stages within stages are less likely.
    same = sorted((each for each in parameters if each.rpartition(".")[2] == last), key=lambda each: each.count("."))
    if stage not in stages and same:
        place = "" if where is None else f" in {where}"
        return InputError(f"unknown parameter {name!r}{place}: did you mean {' or '.join(map(repr, same[:3]))}?")
    known = [*parameters, *stages]
    siblings = [each for each in known if each.startswith(f"{stage}.")] if stage in stages else []
    if not siblings or closest(name, siblings) is not None:
        siblings = siblings or (known if dot else [each for each in known if "." not in each])
        return unknown_name("parameter", name, siblings, where=where, expected="one that `moseg config show` lists")
    shown = ", ".join(siblings[:12]) + (", …" if len(siblings) > 12 else "")
    return InputError("unknown parameter", where=where, got=repr(name), expected=f"one of {shown}")


def _expected(error: Any) -> str:
    if error["type"] == "too_short":
        return "at least one value"
    return error["msg"].removeprefix("Value error, ").removeprefix("Input should be ").partition(", unable to parse")[0]


def _parameter(error: Any) -> str:
    """Return ``stage.name`` of the parameter; pydantic appends which of its types it tried."""
    names, model = [], PipelineConfig
    for part in error["loc"]:
        names.append(str(part))
        field = model.model_fields.get(part)
        inner = None if field is None else stage_model(field)
        if inner is None:
            break
        model = inner
    return ".".join(names)


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
