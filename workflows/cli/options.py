"""Options that several commands share, in groups."""

from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from moseg.schemas.configs import TrajectoryVariant, Variant
from moseg.schemas.errors import InputError
from moseg.workflows.cli import completion
from moseg.workflows.cli.named_options import enumerate_names
from moseg.workflows.config.default_store import default_store

if TYPE_CHECKING:
    from moseg.workflows.api.evaluation import DataChoice
    from moseg.workflows.api.run_settings import RunSettings

DEFAULT_STORE = ""
"""Stands for `default_store()`, which depends on the environment of the call."""

VariantName = StrEnum("VariantName", {variant.name: variant.value for variant in (*Variant, *TrajectoryVariant)})
"""Of every kind of data set."""


def _choose_store(context: typer.Context, given: str) -> str:
    """Return the store that was given, or the default; raises InputError if an empty one was given."""
    if context.resilient_parsing:
        return given
    source = context.get_parameter_source("store")
    if not given and source is not None and source.name == "COMMANDLINE":
        expected = "a folder or a URL"
        raise InputError("no artifact store named", where="--store", got="an empty string", expected=expected)
    return given or default_store()


StoreOption = Annotated[
    str,
    typer.Option(
        "--store",
        help="Artifact store: a folder, or the URL of one (file://, s3://, gs://, az://).",
        metavar="FOLDER",
        show_default="$MOSEG_STORE, else in your cache folder",
        callback=_choose_store,
    ),
]
QuietOption = Annotated[bool, typer.Option("--quiet", help="No progress on standard error.")]
NonCommercialOption = Annotated[
    bool,
    typer.Option(
        "--non-commercial", envvar="MOSEG_NON_COMMERCIAL", help="Allow weights licensed for non-commercial use only."
    ),
]
LicenceOption = Annotated[
    str | None,
    typer.Option(
        "--accept-licence",
        envvar="MOSEG_ACCEPT_LICENCE",
        help="Licences with conditions that you accept, separated by commas: SAM-License for SAM 3.",
        metavar="NAMES",
    ),
]
JsonOption = Annotated[str | None, typer.Option("--json", help="Also write the result to this file.", metavar="FILE")]
ReportOption = Annotated[
    str | None,
    typer.Option(
        "--report",
        help="Also write one page of pictures, matrices, scores and times to this file.",
        metavar="FILE",
    ),
]
VariantOption = Annotated[
    Variant, typer.Option("--variant", help=f"Row of the paper's ablation: {enumerate_names(Variant)}.", metavar="NAME")
]
VariantsOption = Annotated[
    list[VariantName] | None,
    typer.Option(
        "--variant",
        help=f"Row of the ablation; may be repeated (default: fused). Of frames: {', '.join(Variant)}; of labelled"
        f" trajectories: {', '.join(TrajectoryVariant)}.",
        metavar="NAME",
    ),
]


@dataclass(frozen=True)
class DataOptions:
    """Which sequences of which data set."""

    PANEL: ClassVar[str] = "Data"

    dataset: Annotated[
        str,
        typer.Option(
            "--dataset",
            help="Data set; `moseg datasets` lists them.",
            metavar="NAME",
            autocompletion=completion.complete_dataset,
        ),
    ] = "synthetic"
    root: Annotated[
        str | None,
        typer.Option("--root", help="The data set's folder (default: $MOSEG_DATA/<dataset>).", metavar="FOLDER"),
    ] = None
    sequences: Annotated[
        str | None,
        typer.Option(
            "--sequences",
            help="Only these, separated by commas.",
            metavar="NAMES",
            autocompletion=completion.complete_sequences,
        ),
    ] = None
    list_file: Annotated[
        str | None, typer.Option("--list", help="File naming the sequences, one a line (ytvos-moving).", metavar="FILE")
    ] = None

    def choice(self) -> "DataChoice":
        """Return the sequences that these options choose; raises InputError where none is named."""
        from moseg.workflows.api.evaluation import DataChoice

        return DataChoice(self.dataset, self.root, sequence_names(self.sequences), self.list_file)


@dataclass(frozen=True)
class RunOptions:
    """Where results lie and who computes them."""

    PANEL: ClassVar[str] = "Run and cluster"

    store: StoreOption = DEFAULT_STORE
    workers: Annotated[
        int, typer.Option("--workers", help="Worker processes; 0 runs in this process.", metavar="N")
    ] = 0
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            help="Existing Dask cluster: tcp://host:8786, tls://host:8786 or a scheduler file.",
            metavar="URL",
        ),
    ] = None
    tls_ca: Annotated[
        str | None,
        typer.Option(
            "--tls-ca", help="PEM file of the CA of a scheduler at tls:// (default: Dask's own).", metavar="FILE"
        ),
    ] = None
    tls_cert: Annotated[
        str | None, typer.Option("--tls-cert", help="PEM file of this client's certificate.", metavar="FILE")
    ] = None
    tls_key: Annotated[
        str | None,
        typer.Option("--tls-key", help="PEM file of its key, unless the certificate's file holds it.", metavar="FILE"),
    ] = None
    device: Annotated[
        str,
        typer.Option(
            "--device",
            help="Where networks run: auto, cpu, cuda, cuda:N or mps; auto takes a GPU.",
            metavar="NAME",
            autocompletion=completion.complete_device,
        ),
    ] = "auto"
    threads: Annotated[int, typer.Option("--threads", help="CPU threads of each process.", metavar="N")] = 1
    batch: Annotated[
        int | None,
        typer.Option("--batch", help="Frames in one pass of a network (default: 8 on CUDA, else 1).", metavar="N"),
    ] = None
    offline: Annotated[
        bool, typer.Option("--offline", envvar="MOSEG_OFFLINE", help="Fetch no weights; what is missing is an error.")
    ] = False
    non_commercial: NonCommercialOption = False
    accept_licence: LicenceOption = None
    quiet: QuietOption = False
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Progress of each stage for itself, in logs every 15 s.")
    ] = False

    def settings(self) -> "RunSettings":
        """Return the settings that these options make."""
        from moseg.workflows.api.run_settings import RunSettings
        from moseg.workflows.process.progress import show_details

        if self.quiet and self.verbose:
            raise InputError("two opposite options", where="--verbose", got="--quiet too", expected="one of them")
        settings = asdict(self)
        show_details(settings.pop("verbose"))
        return RunSettings(**settings)


def sequence_names(text: str | None) -> tuple[str, ...] | None:
    """Return the names of a list separated by commas; raises InputError on an empty list."""
    if text is None:
        return None
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    if not names:
        raise InputError("no sequence named", where="--sequences", got=repr(text), expected="names separated by commas")
    return names
