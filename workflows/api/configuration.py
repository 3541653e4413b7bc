"""From what a caller says of the pipeline to its configuration."""

import os
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.api.arguments import Kind, check_kinds, named_as_arguments
from moseg.workflows.config.config_files import read_config_file
from moseg.workflows.config.parameter_errors import parameter_error
from moseg.workflows.config.preset_choice import choose_preset

ConfigLike = PipelineConfig | Mapping[str, Any] | str | os.PathLike
"""A whole configuration; parameters that differ from the preset's, as ``{"sections.length": 20}`` or ``{"sections":
{"length": 20}}``; or a YAML file of such parameters, as `moseg config dump` writes it."""
CUES = {"proposals": "proposal_source", "depth": "depth.method", "flow": "flow.method", "tracks": "tracks.method"}
"""What can be given as files, and the parameter that says so."""


@named_as_arguments()
def load_config(
    config: ConfigLike | None = None,
    *,
    preset: str | None = None,
    quality: str | None = None,
    geometry: str | None = None,
    motions: int | str | None = None,
) -> PipelineConfig:
    """The configuration that `segment_video` runs with for the same arguments.

    Raises
    ------
    InputError
        There is no such preset, quality, geometry or parameter, a value is none that the parameter takes, the file
        cannot be read, or a whole configuration comes with a preset that it would override.
    """
    check_kinds(Kind.TEXT, optional=True, preset=preset, quality=quality, geometry=geometry)
    check_kinds(Kind.TEXT_OR_COUNT, optional=True, motions=motions)
    values = _values(config, {"preset": preset, "quality": quality, "geometry": geometry})
    if motions is not None:
        _merge(values, {"clustering": {"motions": str(motions)}})
    return _validate(values)


def with_given_cues(config: PipelineConfig, folders: Mapping[str, str]) -> PipelineConfig:
    """The configuration with the cues that are given as files read from there; raises InputError where it takes another
    cue from files that are not given."""
    values = config.model_dump()
    for cue in folders:
        _merge(values, _nested(CUES[cue], "folder"))
    config = _validate(values)
    for cue, parameter in CUES.items():
        used = config
        for name in parameter.split("."):
            used = getattr(used, name)
        if used == "folder" and cue not in folders:
            raise InputError("no files for a cue", where=parameter, got="folder", expected=f"{cue}=PATH")
        if used == "groundtruth":
            raise InputError("no ground truth of your own video", where=parameter, got="groundtruth")
    if config.clustering.motions == "gt":
        expected = "auto or a number"
        raise InputError("no ground truth of your own video", where="motions", got="gt", expected=expected)
    return config


def _values(config: ConfigLike | None, choices: dict[str, str | None]) -> dict[str, Any]:
    if isinstance(config, PipelineConfig):
        named = [f"{name}={value!r}" for name, value in choices.items() if value is not None]
        if named:
            expected = "one of the two; a mapping of single parameters goes with a preset"
            raise InputError("a whole configuration beside a choice", got=", ".join(named), expected=expected)
        return config.model_dump()
    values = choose_preset(**{name: value for name, value in choices.items() if value is not None})
    if isinstance(config, str | os.PathLike):
        _merge(values, read_config_file(os.fsdecode(config)))
    elif isinstance(config, Mapping):
        for name, value in config.items():
            _merge(values, _nested(str(name), value))
    elif config is not None:
        expected = "a PipelineConfig, a mapping of parameters, or the path of a YAML file"
        raise InputError("not a configuration", got=type(config).__name__, expected=expected)
    return values


def _nested(dotted: str, value: Any) -> dict[str, Any]:
    for name in reversed(dotted.split(".")):
        value = {name: value}
    return value


def _merge(values: dict[str, Any], changes: Mapping[str, Any]) -> None:
    """Put `changes` into `values`, stage by stage."""
    for name, change in changes.items():
        if isinstance(change, Mapping):
            inner = values.get(name)
            values[name] = dict(inner) if isinstance(inner, Mapping) else {}
            _merge(values[name], change)
        else:
            values[name] = change


def _validate(values: dict[str, Any]) -> PipelineConfig:
    try:
        return PipelineConfig.model_validate(values)
    except ValidationError as error:
        raise parameter_error(error) from error
