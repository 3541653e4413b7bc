"""Options of the pipeline."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import typer

from moseg.schemas.errors import InputError
from moseg.workflows.cli import completion
from moseg.workflows.config.pipeline_choices import CUES, Choice, PipelineChoices


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

    def choices(self) -> PipelineChoices:
        """Return what these options say; raises InputError where one is not spelt as it must be."""
        folders: dict[str, str] = {}
        values = {
            "--motions": ("clustering.motions", self.motions),
            "--proposals": (CUES["proposals"], _read_cue("proposals", self.proposals, folders)),
            "--tags": ("detections.tags", self.tags),
            "--tagger": ("detections.tagger", self.tagger),
            "--masks": ("detections.masks", self.masks),
            "--tracker": ("detections.tracker", self.tracker),
            "--depth": (CUES["depth"], _read_cue("depth", self.depth, folders)),
            "--flow": (CUES["flow"], _read_cue("flow", self.flow, folders)),
            "--tracks": (CUES["tracks"], _read_cue("tracks", self.tracks, folders)),
            "--affinity": ("affinity.method", self.affinity),
            "--section-length": ("sections.length", self.section_length),
        }
        chosen = tuple(Choice(option, name, value) for option, (name, value) in values.items() if value is not None)
        settings = tuple(map(_read_setting, self.settings or ()))
        names = (self.preset, self.quality, self.geometry)
        return PipelineChoices(self.config_file, *names, chosen, settings, folders)


def _read_cue(cue: str, text: str | None, folders: dict[str, str]) -> str | None:
    """The source of a cue; the path of ``folder:PATH`` is put into `folders`."""
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
