"""The way from what a command line or a caller chooses to the configuration of the pipeline."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from pydantic import ValidationError

from moseg.schemas.configs import POINT_PROMPTED, PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.presets import GEOMETRIES, LIGHT, PRESETS, QUALITIES, SOURCE_DEFAULTS
from moseg.schemas.spelling import unknown_name
from moseg.workflows.config.parameter_errors import parameter_error

ConfigLike = PipelineConfig | Mapping[str, Any] | str | os.PathLike
"""A whole configuration; parameters that differ from the preset's, as ``{"sections.length": 20}`` or ``{"sections":
{"length": 20}}``; or a YAML file of such parameters, as `moseg config dump` writes it."""
CUES = {"proposals": "proposal_source", "depth": "depth.method", "flow": "flow.method", "tracks": "tracks.method"}
"""Cues that can be given as files, each with the parameter that chooses its source."""
PARAMETER_OF = {f"--{cue}": parameter for cue, parameter in CUES.items()} | {
    "--motions": "clustering.motions",
    "--tags": "detections.tags",
    "--tagger": "detections.tagger",
    "--masks": "detections.masks",
    "--tracker": "detections.tracker",
    "--affinity": "affinity.method",
    "--sensitivity": "track_objects.sensitivity",
    "--section-length": "sections.length",
}
"""Parameters that have an option of their own, by option."""
SETS_OF = {"--preset": PRESETS, "--geometry": GEOMETRIES, "--quality": QUALITIES}
"""Options that choose many parameters by one name, each with its sets of values by name."""

READ_BY = {
    "detections": ("detections",),
    "detections.masks": ("motion-prompts", "detections"),
    "detections.tags": ("sam3", "detections"),
    "detections.tracker": ("sam3", "motion-prompts", "detections"),
    "track_objects": ("motion-prompts", "auto", "tracks"),
}
"""Stages or parameters whose options change something with some sources of proposals alone, each with these sources."""


class Choice(NamedTuple):
    """A parameter that has an option, or an argument, of its own, and its value."""

    option: str
    parameter: str
    value: Any


@dataclass(frozen=True)
class PipelineChoices:
    """The choices of a command line or a caller about the pipeline; later ones in this list override earlier ones.

    Attributes
    ----------
    preset, quality, geometry : str or None
        Names; the default where None.
    config : PipelineConfig, mapping, path or None
        A whole configuration, which allows none of these names beside it; or parameters on top of theirs.
    chosen : tuple of Choice
        By options of their own.
    settings : tuple of (str, str)
        Parameters as ``stage.name``, with their values, in the order in which `--set` gave them.
    folders : dict of str to str
        Where the user's own cues lie, by cue; `chosen` takes them from there.
    light : bool
        Whether the preset is taken with its lighter networks.
    corrected : mapping of str to value
        Parameters as ``stage.name`` that corrections put in place of all others.
    stored : frozenset of str
        Cues that a finished run took from folders and holds, so that no folder is needed.
    """

    config: ConfigLike | None = None
    preset: str | None = None
    quality: str | None = None
    geometry: str | None = None
    chosen: tuple[Choice, ...] = ()
    settings: tuple[tuple[str, str], ...] = ()
    folders: Mapping[str, str] = field(default_factory=dict)
    light: bool = False
    corrected: Mapping[str, Any] = field(default_factory=dict)
    stored: frozenset[str] = frozenset()

    @classmethod
    def of_run(cls, config: PipelineConfig) -> "PipelineChoices":
        """Return the choices of a finished run with this configuration, which holds the cues that it was given."""
        given = (cue for cue, parameter in CUES.items() if _value_of(config, parameter) == "folder")
        return cls(config, stored=frozenset(given))

    @property
    def names(self) -> dict[str, Any]:
        """The names that were given, by ``preset``, ``quality`` and ``geometry``; and ``light``, if it was given."""
        given = {"preset": self.preset, "quality": self.quality, "geometry": self.geometry, "light": self.light or None}
        return {kind: name for kind, name in given.items() if name is not None}

    @property
    def is_file(self) -> bool:
        """Whether `config` is the path of a file."""
        return isinstance(self.config, str | os.PathLike)

    def make_config(self) -> PipelineConfig:
        """Return the configuration; raises InputError where a name, a parameter, a value or the file is wrong."""
        if isinstance(self.config, PipelineConfig) and self.names:
            got = ", ".join(f"{kind}={name!r}" for kind, name in self.names.items())
            expected = "one of the two; a mapping of single parameters goes with a preset"
            raise InputError("a whole configuration beside a choice", got=got, expected=expected)
        self._refuse_two()
        values, given = choose_preset(**self.names), self.given_values()
        for choice in self.chosen:
            _assign(given, choice.parameter, choice.value)
        for name, value in (*self.settings, *self.corrected.items()):
            _assign(given, name, value)
        # What a source of proposals implies is more specific than the preset, and less than the user's own choice and
        # than lighter networks, which would not be light with another tracker.
        _merge(values, SOURCE_DEFAULTS.get(str(given.get("proposal_source")), {}))
        if self.light:
            _merge(values, LIGHT[self.preset])
        _merge(values, given)
        return _validate(values)

    def read_uncorrected(self) -> PipelineConfig | None:
        """Return the configuration without the settings of corrections; None if there are none."""
        return replace(self, corrected={}).read() if self.corrected else None

    def read(self) -> PipelineConfig:
        """Return the configuration of a run; raises InputError also where it needs folders that were not given."""
        config = self.make_config()
        for cue, parameter in CUES.items():
            source = _value_of(config, parameter)
            # Not by --set alone: what the data set gives must not stand in for the user's folder.
            has_files = cue in self.folders or (source == "folder" and cue in self.stored)
            if (source == "folder") != has_files:
                got, expected = f"{source} by --set or --config", f"--{cue} folder:PATH"
                raise InputError("a folder and its use disagree", where=f"--{cue}", got=got, expected=expected)
        self._check_sources(config)
        return config

    def given_values(self) -> dict[str, Any]:
        """Return the values of `config`, nested by stage; raises InputError where it is not a configuration."""
        if isinstance(self.config, PipelineConfig):
            return self.config.model_dump()
        if self.is_file:
            from moseg.workflows.config.config_files import read_config_file

            return read_config_file(os.fsdecode(self.config))
        values: dict[str, Any] = {}
        if isinstance(self.config, Mapping):
            for name, value in self.config.items():
                _merge(values, _nested(str(name), value))
        elif self.config is not None:
            expected = "a PipelineConfig, a mapping of parameters, or the path of a YAML file"
            raise InputError("not a configuration", got=type(self.config).__name__, expected=expected)
        return values

    def given_config(self) -> PipelineConfig:
        """Return what `config` alone makes of the defaults."""
        return _validate(self.given_values())

    def _refuse_two(self) -> None:
        """Raise InputError where an option and `--set` give a parameter different values."""
        settings = dict(self.settings)
        for choice in self.chosen:
            value = settings.get(choice.parameter)
            # About a folder and its use there is an error of its own.
            is_folder = choice.value == "folder"
            if value is not None and not is_folder and not are_equal(choice.parameter, value, choice.value):
                got = f"--set {choice.parameter}={value} too"
                raise InputError("two choices", where=choice.option, got=got, expected="one of them")

    def _check_sources(self, config: PipelineConfig) -> None:
        """Raise InputError where an option would change nothing, because proposals come from elsewhere."""
        given = {choice.parameter: choice for choice in self.chosen}
        for parameter, choice in given.items():
            sources = READ_BY.get(parameter, READ_BY.get(parameter.partition(".")[0]))
            if sources is not None and config.proposal_source not in sources:
                expected = " or ".join(f"--proposals {source}" for source in sources)
                if any(preset.get("proposal_source") in sources for preset in PRESETS.values()):
                    expected += ", or a preset that has it"
                what, got = f"an option of {sources[-1]}", f"proposals {config.proposal_source}"
                raise InputError(what, where=choice.option, got=got, expected=expected)
        masks = config.detections.masks
        if config.proposal_source == "motion-prompts" and masks not in POINT_PROMPTED:
            expected = " or ".join(f"--masks {name}" for name in POINT_PROMPTED)
            raise InputError("a network that takes no points as prompts", where="--masks", got=masks, expected=expected)
        if {"detections.tags", "detections.tagger"} <= given.keys():
            got = f"--tags {given['detections.tags'].value}"
            raise InputError("nothing to tag", where="--tagger", got=got, expected="one of the two")


def are_equal(parameter: str, *values: Any) -> bool:
    """Return whether values of ``stage.name`` are the same to the configuration, such as 1, "1" and "1.0"."""
    first, *others = (_read_alone(parameter, value) for value in values)
    return all(each == first for each in others)


def choose_preset(
    preset: str = "weights-free", geometry: str = "default", quality: str = "default", light: bool = False
) -> dict[str, Any]:
    """Return the values of a preset, light or not, a geometry and a quality.

    Raises
    ------
    InputError
        A name is unknown, or the preset has no lighter networks.
    """
    values: dict[str, Any] = {}
    for (option, known), name in zip(SETS_OF.items(), (preset, geometry, quality), strict=True):
        if name not in known:
            raise unknown_name(option.removeprefix("--"), name, known, where=option)
        _merge(values, known[name])
        if light and known is PRESETS:
            if preset not in LIGHT:
                expected = " or ".join(f"--preset {name}" for name in LIGHT)
                raise InputError("a preset without lighter networks", where="--light", got=preset, expected=expected)
            _merge(values, LIGHT[preset])
    return values


def refuse_ground_truth(config: PipelineConfig) -> None:
    """Raise InputError where a configuration for the user's own video takes something from ground truth."""
    for parameter in CUES.values():
        if _value_of(config, parameter) == "groundtruth":
            raise InputError("no ground truth of your own video", where=parameter, got="groundtruth")
    if config.clustering.motions == "gt":
        expected = "auto or a number"
        raise InputError("no ground truth of your own video", where="--motions", got="gt", expected=expected)


def _value_of(config: PipelineConfig, parameter: str) -> Any:
    value: Any = config
    for name in parameter.split("."):
        value = getattr(value, name)
    return value


def _read_alone(parameter: str, value: Any) -> Any:
    try:
        return _value_of(_validate(_nested(parameter, value)), parameter)
    except InputError:
        # It is refused where the whole configuration is read.
        return str(value)


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


def _assign(values: dict[str, Any], dotted: str, value: Any) -> None:
    """Put the value of ``stage.name`` into `values`; raises InputError where a parameter stands for the stage."""
    *parents, name = dotted.split(".")
    for parent in parents:
        values = values.setdefault(parent, {})
        if not isinstance(values, dict):
            raise InputError("not a setting", where="--set", got=dotted, expected="stage.name=value")
    values[name] = value


def _validate(values: dict[str, Any]) -> PipelineConfig:
    try:
        return PipelineConfig.model_validate(values)
    except ValidationError as error:
        raise parameter_error(error) from error
