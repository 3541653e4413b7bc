"""A connection to the scheduler of an existing Dask cluster; failures are reported in one line."""

import json
import logging
import ssl
import warnings
from pathlib import Path

import dask
from distributed import Client
from distributed.comm import parse_address
from distributed.comm.addressing import parse_host_port
from distributed.comm.registry import get_backend
from distributed.security import Security
from distributed.versions import VersionMismatchWarning

from moseg.schemas.errors import InputError
from moseg.workflows.cluster.scheduler_probe import probe_scheduler
from moseg.workflows.cluster.tls_files import TlsFiles

CONNECT_SEC = 10.0
"""Longest time that a scheduler may take to answer, and to come back when the connection breaks."""
EXPECTED = "tcp://host:8786, tls://host:8786 or a scheduler file"
SHORT_LOGS = {"distributed.admin.low-level-log-length": 50}
"""Dask keeps the last messages of each connection, of up to a megabyte, for its developers: a thousand by default, with
calls that were done long ago."""
DASK_TLS = "distributed.comm.tls of Dask's configuration"


def connect(scheduler: str, tls: TlsFiles) -> Client:
    """Return a client of the cluster at an address, or of the one that a scheduler file (JSON) names.

    Raises
    ------
    InputError
        No Dask scheduler answers there, the TLS files cannot be used, or one side uses TLS and the other does not.

    References
    ----------
    https://distributed.dask.org/en/stable/tls.html, and ``--scheduler-file`` of ``dask scheduler``.
    """
    address = read_scheduler_file(scheduler) if scheduler.endswith(".json") else scheduler
    where = f"--scheduler {scheduler}"
    try:
        protocol, location = parse_address(address)
        get_backend(protocol)
        host, port = parse_host_port(location)
    except ValueError as error:
        raise InputError("not the address of a scheduler", where=where, got=error, expected=EXPECTED) from error
    if tls.named() and protocol != "tls":
        got = f"{next(iter(tls.named()))} and {protocol}://"
        raise InputError("certificates are for TLS", where=where, got=got, expected="tls://host:8786")
    security = _security(tls)
    context = _context(security, tls, where) if protocol == "tls" else None
    if protocol in ("tcp", "tls"):
        probe_scheduler(host, port, context, where)
    try:
        with warnings.catch_warnings(), dask.config.set(SHORT_LOGS):
            # `ClusterCheck` reports other versions in one line for all workers.
            warnings.simplefilter("ignore", VersionMismatchWarning)
            # If the scheduler is lost later, the run ends with its own message.
            logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
            return Client(address, timeout=CONNECT_SEC, security=security, set_as_default=False)
    except (OSError, ValueError, RuntimeError, TypeError) as error:
        raise InputError("no Dask scheduler answers", where=where, got=error, expected=EXPECTED) from error


def read_scheduler_file(path: str | Path) -> str:
    """Return the address in a scheduler file; raise InputError if the file is not one."""
    try:
        return str(json.loads(Path(path).read_text(encoding="utf-8"))["address"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        got = f"{type(error).__name__}: {error}"
        expected = "a file written by `dask scheduler --scheduler-file`"
        raise InputError("not a scheduler file", where=f"--scheduler {path}", got=got, expected=expected) from error


def _security(tls: TlsFiles) -> Security:
    given = {"tls_ca_file": tls.ca, "tls_client_cert": tls.cert, "tls_client_key": tls.key}
    return Security(**{name: path for name, path in given.items() if path is not None})


def _context(security: Security, tls: TlsFiles, where: str) -> ssl.SSLContext:
    for option, path in tls.named().items():
        if not Path(path).is_file():
            raise InputError("no such file", where=option, got=path, expected="a PEM file")
    names = " and ".join(tls.named()) or DASK_TLS
    try:
        context = security.get_connection_args("client")["ssl_context"]
    except (OSError, ValueError) as error:
        expected = "PEM files: certificates of the CA, the client's own certificate and its key"
        raise InputError("no usable certificates", where=names, got=error, expected=expected) from error
    if context is None:
        expected = f"--tls-ca FILE --tls-cert FILE --tls-key FILE, or {DASK_TLS}"
        raise InputError("TLS needs certificates", where=where, got=names if tls.named() else "none", expected=expected)
    return context
