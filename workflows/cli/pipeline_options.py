"""Options of the pipeline, and the configuration that they and a file of parameters make."""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import typer
from pydantic import ValidationError

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.cli import completion
from moseg.workflows.config.parameter_errors import parameter_error
from moseg.workflows.config.preset_choice import choose_preset


@dataclass(frozen=True)
class PipelineOptions:
    """How the pipeline differs from its defaults."""

    PANEL: ClassVar[str] = "Pipeline"

    preset: Annotated[
        str,
        typer.Option(
            "--preset",
            help="Set of backends: weights-free, paper or modern; the other options change single ones.",
            metavar="NAME",
            autocompletion=completion.complete_preset,
        ),
    ] = "weights-free"
    quality: Annotated[
        str,
        typer.Option(
            "--quality",
            help="What accuracy may cost: fast, default or best.",
            metavar="NAME",
            autocompletion=completion.complete_quality,
        ),
    ] = "default"
    motions: Annotated[
        str | None,
        typer.Option(
            "--motions",
            help="Number of motions, the background's included: gt, auto or N (default: auto).",
            metavar="N",
            autocompletion=completion.complete_motions,
        ),
    ] = None
    proposals: Annotated[
        str | None,
        typer.Option(
            "--proposals",
            help="saliency, detections, groundtruth or folder:PATH (default: saliency).",
            metavar="NAME",
            autocompletion=completion.complete_proposals,
        ),
    ] = None
    tags: Annotated[
        str | None,
        typer.Option(
            "--tags",
            help="What to look for (car,person), in place of tagging; with --proposals detections.",
            metavar="NAMES",
        ),
    ] = None
    tagger: Annotated[
        str | None,
        typer.Option(
            "--tagger",
            help="ram or ram-plus (default: ram).",
            metavar="NAME",
            autocompletion=completion.complete_tagger,
        ),
    ] = None
    masks: Annotated[
        str | None,
        typer.Option(
            "--masks",
            help="Masks of detections: sam-hq or sam2 (default: sam-hq).",
            metavar="NAME",
            autocompletion=completion.complete_masks,
        ),
    ] = None
    tracker: Annotated[
        str | None,
        typer.Option(
            "--tracker",
            help="Tracker of detected objects: deaot or sam2 (default: deaot).",
            metavar="NAME",
            autocompletion=completion.complete_tracker,
        ),
    ] = None
    depth: Annotated[
        str | None,
        typer.Option(
            "--depth",
            help="none, dpt-dinov2, depth-anything-v2, groundtruth or folder:PATH (default: none).",
            metavar="NAME",
            autocompletion=completion.complete_depth,
        ),
    ] = None
    flow: Annotated[
        str | None,
        typer.Option(
            "--flow",
            help="dis, raft, groundtruth or folder:PATH (default: dis).",
            metavar="NAME",
            autocompletion=completion.complete_flow,
        ),
    ] = None
    tracks: Annotated[
        str | None,
        typer.Option(
            "--tracks",
            help="lucas-kanade, pips, groundtruth or folder:PATH (default: lucas-kanade).",
            metavar="NAME",
            autocompletion=completion.complete_tracks,
        ),
    ] = None
    affinity: Annotated[
        str | None,
        typer.Option(
            "--affinity",
            help="residual, ork, hypotheses or combined (default: residual).",
            metavar="NAME",
            autocompletion=completion.complete_affinity,
        ),
    ] = None
    geometry: Annotated[
        str,
        typer.Option(
            "--geometry",
            help="Fits, affinity and clustering: default or paper.",
            metavar="NAME",
            autocompletion=completion.complete_geometry,
        ),
    ] = "default"
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
            help="YAML file of parameters, as `moseg config dump` writes; the other options here override it.",
            metavar="FILE",
        ),
    ] = None

    def read(self) -> tuple[PipelineConfig, dict[str, str]]:
        """The configuration, and the folders of cues given by `folder:PATH`, by cue; raises InputError."""
        folders: dict[str, str] = {}
        values = choose_preset(self.preset, self.geometry, self.quality)
        if self.config_file is not None:
            values = _merge(values, self.read_file())
        chosen = {
            "clustering.motions": self.motions,
            "proposal_source": _folder_choice("proposals", self.proposals, folders),
            "detections.tags": self.tags,
            "detections.tagger": self.tagger,
            "detections.masks": self.masks,
            "detections.tracker": self.tracker,
            "depth.method": _folder_choice("depth", self.depth, folders),
            "flow.method": _folder_choice("flow", self.flow, folders),
            "tracks.method": _folder_choice("tracks", self.tracks, folders),
            "affinity.method": self.affinity,
            "sections.length": self.section_length,
        }
        for name, value in chosen.items():
            if value is not None:
                _assign(values, name, value)
        for setting in self.settings or []:
            name, equals, value = setting.partition("=")
            if not equals:
                raise InputError("not a setting", where="--set", got=setting, expected="stage.name=value")
            _assign(values, name.strip(), value.strip())
        try:
            config = PipelineConfig.model_validate(values)
        except ValidationError as error:
            raise parameter_error(error) from error
        sources = {
            "proposals": config.proposal_source,
            "depth": config.depth.method,
            "flow": config.flow.method,
            "tracks": config.tracks.method,
        }
        for cue, source in sources.items():
            # By --set alone: what the data set gives must not stand in for the user's folder.
            if (source == "folder") != (cue in folders):
                where, got = f"--{cue}", f"{source} by --set or --config"
                raise InputError("a folder and its use disagree", where=where, got=got, expected=f"--{cue} folder:PATH")
        if config.proposal_source != "detections":
            options = {"--tags": self.tags, "--tagger": self.tagger, "--masks": self.masks, "--tracker": self.tracker}
            for option, value in options.items():
                if value is not None:
                    expected = "--proposals detections, or a preset that has it"
                    got = f"proposals {config.proposal_source}"
                    raise InputError("an option of detections", where=option, got=got, expected=expected)
        elif self.tags is not None and self.tagger is not None:
            raise InputError("nothing to tag", where="--tagger", got=f"--tags {self.tags}", expected="one of the two")
        return config, folders

    def read_file(self) -> dict[str, Any]:
        """Parameters of the configuration file, nested by stage; none where there is no file. Raises InputError."""
        from moseg.workflows.config.config_files import read_config_file

        return {} if self.config_file is None else read_config_file(self.config_file)


def _folder_choice(cue: str, text: str | None, folders: dict[str, str]) -> str | None:
    if text is None or not text.startswith("folder"):
        return text
    _, _, path = text.partition(":")
    if not path:
        raise InputError("no folder named", where=f"--{cue}", got=text, expected="folder:PATH")
    folders[cue] = path
    return "folder"


def _merge(values: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    """The values with those of `more` in place of the same ones, stage by stage."""
    merged = dict(values)
    for name, value in more.items():
        inner = merged.get(name)
        merged[name] = _merge(inner, value) if isinstance(inner, dict) and isinstance(value, dict) else value
    return merged


def _assign(values: dict[str, Any], dotted: str, value: Any) -> None:
    *parents, name = dotted.split(".")
    for parent in parents:
        values = values.setdefault(parent, {})
        if not isinstance(values, dict):
            raise InputError("not a setting", where="--set", got=dotted, expected="stage.name=value")
    values[name] = value
