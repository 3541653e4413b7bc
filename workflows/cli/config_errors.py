"""What is wrong with a configuration, in terms of the options that set it."""

from difflib import get_close_matches
from typing import Any

from pydantic import BaseModel

from schemas.configs import PipelineConfig


def explain(errors: list[dict[str, Any]]) -> dict[str, Any]:
    """What is wrong with the first parameter that is wrong; a parameter of several types has an error for each."""
    first = errors[0]
    where = _parameter(first)
    if first["type"] == "extra_forbidden":
        close = get_close_matches(where, _known_names(), n=1)
        expected = close[0] if close else f"one of {', '.join(_siblings(where))}"
        return {"what": "unknown parameter", "where": where, "expected": expected}
    messages = [error["msg"].removeprefix("Value error, ") for error in errors if _parameter(error) == where]
    expected = " or ".join(
        message.removeprefix("Input should be ").partition(", unable to parse")[0] for message in messages
    )
    return {"what": "bad parameter", "where": where, "got": repr(first["input"]), "expected": expected}


def _parameter(error: dict[str, Any]) -> str:
    """``stage.name`` of the parameter; what pydantic puts behind it says which of its types was tried."""
    names, model = [], PipelineConfig
    for part in error["loc"]:
        names.append(str(part))
        field = model.model_fields.get(part)
        if field is None or not (isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel)):
            break
        model = field.annotation
    return ".".join(names)


def _siblings(parameter: str) -> list[str]:
    """Parameters of the same stage, or the stages where there is none of that name."""
    stage = parameter.partition(".")[0]
    names = [name for name in _known_names() if name.startswith(f"{stage}.")]
    return names or list(PipelineConfig.model_fields)


def _known_names() -> list[str]:
    names = []
    for stage, field in PipelineConfig.model_fields.items():
        inner = getattr(field.annotation, "model_fields", None)
        names.extend([stage] if inner is None else [f"{stage}.{name}" for name in inner])
    return names
