"""Options of the pipeline."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import typer

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import TrackObjectParams
from moseg.workflows.cli import completion
from moseg.workflows.cli.named_options import named_option
from moseg.workflows.config.pipeline_choices import CUES, PARAMETER_OF, Choice, PipelineChoices

_SENSITIVITY = TrackObjectParams().sensitivity


@dataclass(frozen=True)
class PipelineOptions:
    """How the pipeline differs from its defaults."""

    PANEL: ClassVar[str] = "Pipeline"

    preset: Annotated[
        str, named_option("--preset", "Set of backends: {choices}; the other options change single ones.")
    ] = "weights-free"
    light: Annotated[
        bool, typer.Option("--light", help="The preset's lighter networks, for a laptop; with --preset modern.")
    ] = False
    quality: Annotated[str, named_option("--quality", "What accuracy may cost: {choices}.")] = "default"
    motions: Annotated[
        str | None,
        named_option(
            "--motions",
            "Number of motions, the background's included: {choices} or N (default: {default}).",
            metavar="N",
        ),
    ] = None
    proposals: Annotated[str | None, named_option("--proposals", "{choices} (default: {default}).")] = None
    tags: Annotated[
        str | None,
        typer.Option(
            "--tags",
            help="What to look for (car,person), in place of tagging; with --proposals detections or sam3.",
            metavar="NAMES",
        ),
    ] = None
    tagger: Annotated[str | None, named_option("--tagger", "{choices} (default: {default}).")] = None
    masks: Annotated[str | None, named_option("--masks", "Masks of detections: {choices} (default: {default}).")] = None
    tracker: Annotated[
        str | None, named_option("--tracker", "Tracker of detected objects: {choices} (default: {default}).")
    ] = None
    depth: Annotated[str | None, named_option("--depth", "{choices} (default: {default}).")] = None
    flow: Annotated[str | None, named_option("--flow", "{choices} (default: {default}).")] = None
    tracks: Annotated[str | None, named_option("--tracks", "{choices} (default: {default}).")] = None
    affinity: Annotated[str | None, named_option("--affinity", "{choices} (default: {default}).")] = None
    sensitivity: Annotated[
        float | None,
        typer.Option(
            "--sensitivity",
            help="Divisor of the evidence against a rigid scene that a moving object needs: a larger one finds more,"
            " and more that does not move; with --proposals auto, tracks or motion-prompts (default:"
            f" {_SENSITIVITY:g}).",
            metavar="NUMBER",
        ),
    ] = None
    geometry: Annotated[str, named_option("--geometry", "Fits, affinity and clustering: {choices}.")] = "default"
    section_length: Annotated[
        int | None, typer.Option("--section-length", help="Frames of a section (l of the paper).", metavar="N")
    ] = None
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            help="Any parameter, as stage.name=value (fundamental.gap=5); may be repeated. See `moseg config show`.",
            metavar="NAME=VALUE",
            autocompletion=completion.complete_setting,
        ),
    ] = None
    config_file: Annotated[
        str | None,
        typer.Option(
            "--config",
            help="YAML file of parameters, as `moseg config dump` writes; it overrides --preset, --light, --quality and"
            " --geometry, and the other options here override it.",
            metavar="FILE",
        ),
    ] = None

    def choices(self) -> PipelineChoices:
        """Return the choices that these options make; raises InputError where one is not spelt correctly."""
        folders: dict[str, str] = {}
        values = {f"--{cue}": _read_cue(cue, getattr(self, cue), folders) for cue in CUES} | {
            "--motions": self.motions,
            "--tags": self.tags,
            "--tagger": self.tagger,
            "--masks": self.masks,
            "--tracker": self.tracker,
            "--affinity": self.affinity,
            "--sensitivity": self.sensitivity,
            "--section-length": self.section_length,
        }
        given = {option: value for option, value in values.items() if value is not None}
        chosen = tuple(Choice(option, PARAMETER_OF[option], value) for option, value in given.items())
        settings = tuple(map(_read_setting, self.settings or ()))
        names = (self.preset, self.quality, self.geometry)
        return PipelineChoices(self.config_file, *names, chosen, settings, folders, self.light)


def _read_cue(cue: str, text: str | None, folders: dict[str, str]) -> str | None:
    """Return the source of a cue, and put the path of ``folder:PATH`` into `folders`."""
    if text is None or not text.startswith("folder"):
        return text
    _, _, path = text.partition(":")
    if not path:
        raise InputError("no folder named", where=f"--{cue}", got=text, expected="folder:PATH")
    folders[cue] = path
    return "folder"


def _read_setting(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise InputError("not a setting", where="--set", got=text, expected="stage.name=value")
    return name.strip(), value.strip()
