"""Options that several commands share, in groups, and what each group makes of them."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from difflib import get_close_matches
from enum import StrEnum
from functools import wraps
from typing import Annotated, Any, TypeVar, get_type_hints

import typer
from pydantic import ValidationError

from schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from schemas.errors import InputError
from schemas.presets import GEOMETRIES, PRESETS, QUALITIES
from workflows.cli.config_errors import explain

DEFAULT_STORE = ".moseg/store"

AnyVariant = TypeVar("AnyVariant", Variant, TrajectoryVariant)
VariantName = StrEnum("VariantName", {variant.name: variant.value for variant in (*Variant, *TrajectoryVariant)})
"""Of every kind of data set; `read_variants` says which of them one has."""

StoreOption = Annotated[
    str, typer.Option("--store", help="Artifact store: a folder, or the URL of one (file://, s3://, gs://, az://).")
]
QuietOption = Annotated[bool, typer.Option("--quiet", help="No progress on standard error.")]
NonCommercialOption = Annotated[
    bool,
    typer.Option(
        "--non-commercial", envvar="MOSEG_NON_COMMERCIAL", help="Allow weights licensed for non-commercial use only."
    ),
]
JsonOption = Annotated[str | None, typer.Option("--json", help="Also write the result to this file.")]
VariantsOption = Annotated[
    list[VariantName] | None,
    typer.Option(
        "--variant",
        help="Row of the ablation; may be repeated (default: fused). Of frames: fused, oc-depth, oc, trajs, base; of"
        " labelled trajectories: fused, trajs, homography, affine.",
    ),
]


@dataclass(frozen=True)
class DataOptions:
    """Which sequences of which data set."""

    dataset: Annotated[str, typer.Option("--dataset", help="Data set; `moseg datasets` lists them.")] = "synthetic"
    root: Annotated[
        str | None, typer.Option("--root", help="The data set's folder (default: $MOSEG_DATA/<dataset>).")
    ] = None
    sequences: Annotated[str | None, typer.Option("--sequences", help="Only these, separated by commas.")] = None
    list_file: Annotated[
        str | None, typer.Option("--list", help="File naming the sequences, one a line (ytvos-moving).")
    ] = None

    def open(self, max_side: int):
        """The data set; raises InputError where it is not there or has no such sequence."""
        from workflows.datasets import open_dataset

        return open_dataset(self.dataset, self.root, sequence_names(self.sequences), self.list_file, max_side=max_side)


@dataclass(frozen=True)
class PipelineOptions:
    """How the pipeline differs from its defaults."""

    preset: Annotated[
        str,
        typer.Option(
            "--preset", help="Set of backends: weights-free, paper or modern; the other options change single ones."
        ),
    ] = "weights-free"
    quality: Annotated[str, typer.Option("--quality", help="What accuracy may cost: fast, default or best.")] = (
        "default"
    )
    motions: Annotated[
        str | None,
        typer.Option("--motions", help="Number of motions, the background's included: gt, auto or N (default: auto)."),
    ] = None
    proposals: Annotated[
        str | None,
        typer.Option("--proposals", help="saliency, detections, groundtruth or folder:PATH (default: saliency)."),
    ] = None
    tags: Annotated[
        str | None,
        typer.Option("--tags", help="What to look for (car,person), in place of tagging; with --proposals detections."),
    ] = None
    tagger: Annotated[str | None, typer.Option("--tagger", help="ram or ram-plus (default: ram).")] = None
    masks: Annotated[
        str | None, typer.Option("--masks", help="Masks of detections: sam-hq or sam2 (default: sam-hq).")
    ] = None
    tracker: Annotated[
        str | None, typer.Option("--tracker", help="Tracker of detected objects: deaot or sam2 (default: deaot).")
    ] = None
    depth: Annotated[
        str | None,
        typer.Option(
            "--depth", help="none, dpt-dinov2, depth-anything-v2, groundtruth or folder:PATH (default: none)."
        ),
    ] = None
    flow: Annotated[
        str | None, typer.Option("--flow", help="dis, raft, groundtruth or folder:PATH (default: dis).")
    ] = None
    tracks: Annotated[
        str | None,
        typer.Option("--tracks", help="lucas-kanade, pips, groundtruth or folder:PATH (default: lucas-kanade)."),
    ] = None
    affinity: Annotated[
        str | None, typer.Option("--affinity", help="residual, ork, hypotheses or combined (default: residual).")
    ] = None
    geometry: Annotated[str, typer.Option("--geometry", help="Fits, affinity and clustering: default or paper.")] = (
        "default"
    )
    section_length: Annotated[
        int | None, typer.Option("--section-length", help="Frames of a section (l of the paper).")
    ] = None
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", help="Any parameter, as stage.name=value (fundamental.gap=5); may be repeated."),
    ] = None

    def read(self) -> tuple[PipelineConfig, dict[str, str]]:
        """The configuration, and the folders of cues given by `folder:PATH`, by cue; raises InputError."""
        folders: dict[str, str] = {}
        values = choose_preset(self.preset, self.geometry, self.quality)
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
            raise InputError(**explain(error.errors())) from error
        sources = {
            "proposals": config.proposal_source,
            "depth": config.depth.method,
            "flow": config.flow.method,
            "tracks": config.tracks.method,
        }
        for cue, source in sources.items():
            # By --set alone: what the data set gives must not stand in for the user's folder.
            if (source == "folder") != (cue in folders):
                where, got = f"--{cue}", f"{source} by --set"
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


@dataclass(frozen=True)
class RunOptions:
    """Where results lie and who computes them."""

    store: StoreOption = DEFAULT_STORE
    workers: Annotated[int, typer.Option("--workers", help="Worker processes; 0 runs in this process.")] = 0
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler", help="Existing Dask cluster: tcp://host:8786, tls://host:8786 or a scheduler file."
        ),
    ] = None
    tls_ca: Annotated[
        str | None, typer.Option("--tls-ca", help="PEM file of the CA of a scheduler at tls:// (default: Dask's own).")
    ] = None
    tls_cert: Annotated[str | None, typer.Option("--tls-cert", help="PEM file of this client's certificate.")] = None
    tls_key: Annotated[
        str | None, typer.Option("--tls-key", help="PEM file of its key, unless the certificate's file holds it.")
    ] = None
    device: Annotated[
        str, typer.Option("--device", help="Where networks run: auto, cpu, cuda, cuda:N or mps; auto takes a GPU.")
    ] = "auto"
    threads: Annotated[int, typer.Option("--threads", help="CPU threads of each process.")] = 1
    batch: Annotated[
        int | None,
        typer.Option("--batch", help="Frames in one pass of a network (default: 8 on CUDA, else 1)."),
    ] = None
    offline: Annotated[
        bool, typer.Option("--offline", envvar="MOSEG_OFFLINE", help="Fetch no weights; what is missing is an error.")
    ] = False
    non_commercial: NonCommercialOption = False
    quiet: QuietOption = False

    def open(self):
        """A session, as a context manager."""
        from workflows.cluster_connection import TlsFiles
        from workflows.runs import open_session

        return open_session(
            self.store,
            workers=self.workers,
            scheduler=self.scheduler,
            tls=TlsFiles(self.tls_ca, self.tls_cert, self.tls_key),
            quiet=self.quiet,
            device=self.device,
            threads=self.threads,
            batch=self.batch,
            offline=self.offline,
            non_commercial=self.non_commercial,
        )


def with_option_groups(function: Callable[..., None]) -> Callable[..., None]:
    """The function with each parameter that is a group of options replaced by the group's options."""
    parameters, groups = [], {}
    for parameter in inspect.signature(function, eval_str=True).parameters.values():
        group = parameter.annotation
        if not is_dataclass(group):
            parameters.append(parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY))
            continue
        groups[parameter.name] = group
        hints = get_type_hints(group, include_extras=True)
        parameters.extend(
            inspect.Parameter(
                field.name, inspect.Parameter.KEYWORD_ONLY, default=field.default, annotation=hints[field.name]
            )
            for field in fields(group)
        )

    @wraps(function)
    def command(**values):
        grouped = {
            name: group(**{field.name: values.pop(field.name) for field in fields(group)})
            for name, group in groups.items()
        }
        return function(**grouped, **values)

    command.__signature__ = inspect.Signature(parameters)
    command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return command


def sequence_names(text: str | None) -> tuple[str, ...] | None:
    """Names out of a list separated by commas."""
    if text is None:
        return None
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    if not names:
        raise InputError("no sequence named", where="--sequences", got=repr(text), expected="names separated by commas")
    return names


def read_variants(names: list[VariantName] | None, kind: type[AnyVariant], dataset: str) -> tuple[AnyVariant, ...]:
    """The variants named, each once, ``fused`` where there is none; raises InputError on one that is not of `kind`."""
    known = [variant.value for variant in kind]
    for name in names or ():
        if name not in known:
            what = f"no such variant of data set {dataset}"
            raise InputError(what, where="--variant", got=name.value, expected=" or ".join(known))
    return tuple(kind(name) for name in dict.fromkeys(names or (VariantName.FUSED,)))


def choose_preset(preset: str, geometry: str = "default", quality: str = "default") -> dict[str, Any]:
    """Values of a preset, a geometry and a quality; raises InputError where there is none of the name."""
    options = (("--preset", preset, PRESETS), ("--geometry", geometry, GEOMETRIES), ("--quality", quality, QUALITIES))
    values: dict[str, Any] = {}
    for option, name, known in options:
        if name not in known:
            close = get_close_matches(name, known, n=1)
            expected = f"{close[0]}?" if close else " or ".join(known)
            raise InputError(f"no such {option.removeprefix('--')}", where=option, got=name, expected=expected)
        for stage, chosen in known[name].items():
            values[stage] = {**values.get(stage, {}), **chosen} if isinstance(chosen, Mapping) else chosen
    return values


def _folder_choice(cue: str, text: str | None, folders: dict[str, str]) -> str | None:
    if text is None or not text.startswith("folder"):
        return text
    _, _, path = text.partition(":")
    if not path:
        raise InputError("no folder named", where=f"--{cue}", got=text, expected="folder:PATH")
    folders[cue] = path
    return "folder"


def _assign(values: dict[str, Any], dotted: str, value: Any) -> None:
    *parents, name = dotted.split(".")
    for parent in parents:
        values = values.setdefault(parent, {})
        if not isinstance(values, dict):
            raise InputError("not a setting", where="--set", got=dotted, expected="stage.name=value")
    values[name] = value
