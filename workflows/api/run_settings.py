"""Where the results of a run lie, and who computes them."""

import os
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass

from moseg.workflows.api.arguments import Kind, check_kinds, check_min
from moseg.workflows.cluster.tls_files import TlsFiles
from moseg.workflows.config.default_store import default_store
from moseg.workflows.engine.session import Session, open_session


@dataclass(frozen=True)
class RunSettings:
    """What a session is opened with: the run options of the command line, and arguments of the same names.

    Attributes
    ----------
    store : str
        A folder or a URL.
    workers : int
        Worker processes; 0 computes in this one.
    scheduler : str or None
        Address, or scheduler file, of an existing Dask cluster.
    tls_ca, tls_cert, tls_key : str or None
        PEM files for a scheduler at ``tls://``.
    device : str
        Where networks run.
    threads : int
        CPU threads of each process.
    batch : int or None
        Frames in one pass of a network.
    offline, non_commercial : bool
        Whether no weights are fetched, and whether those for non-commercial use may be.
    accept_licence : str or None
        Names of accepted licences of weights that have conditions, separated by commas.
    quiet : bool
        No progress on standard error.
    keep_cues : bool
        Whether dense maps that can be computed again stay in the store.
    """

    store: str
    workers: int = 0
    scheduler: str | None = None
    tls_ca: str | None = None
    tls_cert: str | None = None
    tls_key: str | None = None
    device: str = "auto"
    threads: int = 1
    batch: int | None = None
    offline: bool = False
    non_commercial: bool = False
    accept_licence: str | None = None
    quiet: bool = False
    keep_cues: bool = True

    def open(self) -> AbstractContextManager[Session]:
        """Open a session for a block; raises InputError where the store, the workers or the device cannot be had."""
        settings = asdict(self)
        tls = TlsFiles(*(settings.pop(f"tls_{name}") for name in TlsFiles._fields))
        return open_session(**settings, tls=tls)


def read_run_settings(
    *,
    store: str | os.PathLike | None,
    workers: int,
    scheduler: str | os.PathLike | None,
    tls_ca: str | os.PathLike | None,
    tls_cert: str | os.PathLike | None,
    tls_key: str | os.PathLike | None,
    device: str,
    threads: int,
    batch: int | None,
    offline: bool,
    non_commercial: bool,
    accept_licence: str | None,
    progress: bool,
    keep_cues: bool = True,
) -> RunSettings:
    """Return the settings that the arguments of a call ask for; raises InputError on one of another kind."""
    check_kinds(Kind.PATH, optional=True, store=store)
    files = {"scheduler": scheduler, "tls_ca": tls_ca, "tls_cert": tls_cert, "tls_key": tls_key}
    check_kinds(Kind.PATH, optional=True, **files)
    check_kinds(Kind.TEXT, device=device)
    check_kinds(Kind.TEXT, optional=True, accept_licence=accept_licence)
    check_kinds(Kind.SWITCH, offline=offline, non_commercial=non_commercial, progress=progress, keep_cues=keep_cues)
    check_min(0, workers=workers)
    check_min(1, threads=threads, **({} if batch is None else {"batch": batch}))
    return RunSettings(
        default_store() if store is None else os.fsdecode(store),
        workers,
        **{name: None if path is None else os.fsdecode(path) for name, path in files.items()},
        device=device,
        threads=threads,
        batch=batch,
        offline=offline,
        non_commercial=non_commercial,
        accept_licence=accept_licence,
        quiet=not progress,
        keep_cues=keep_cues,
    )
