"""Knocking at the door of a Dask scheduler, to say at once why it does not open.

Dask itself tries again until its time is up, whatever the reason, and waits without end for a greeting.
"""

import socket
import ssl

from moseg.schemas.errors import InputError

REACH_SEC = 5.0
"""For how long a host may take to accept a connection."""
GREETING_SEC = 10.0
"""For how long a scheduler that has accepted one may be busy before it greets."""
SIZE_BYTES = 8
MAX_GREETING_BYTES = 2**20


def knock(host: str, port: int, context: ssl.SSLContext | None, where: str) -> None:
    """Connect and wait to be greeted: a Dask scheduler greets whoever connects, with TLS under a `context`.

    Raises
    ------
    InputError
        Nobody listens, the two sides do not both speak TLS or do not trust each other, or no greeting comes.
    """
    try:
        if _greets(host, port, context):
            return
        got, expected = "no greeting as Dask gives it", "a Dask scheduler's port, often 8786"
    except ssl.SSLError as error:
        # What is no record of TLS is a greeting in clear.
        if error.reason in ("WRONG_VERSION_NUMBER", "RECORD_LAYER_FAILURE", "UNEXPECTED_RECORD"):
            got, expected = "a port that does not speak TLS", "tcp:// in place of tls://"
        else:
            got, expected = error, "a CA and a certificate that both sides trust"
        raise InputError("no TLS with the scheduler", where=where, got=got, expected=expected) from error
    except OSError as error:
        got, expected = error, "a running scheduler: dask scheduler --port 8786"
        raise InputError("no Dask scheduler answers", where=where, got=got, expected=expected) from error
    if context is None and _speaks_tls(host, port):
        got, expected = "a port that speaks TLS", "tls:// in place of tcp://, with --tls-ca, --tls-cert and --tls-key"
    raise InputError("no Dask scheduler answers", where=where, got=got, expected=expected)


def _greets(host: str, port: int, context: ssl.SSLContext | None) -> bool:
    with socket.create_connection((host, port), timeout=REACH_SEC) as plain:
        if context is None:
            # A TLS server waits for us to begin, and nothing is lost by asking it soon.
            return _is_greeted(plain, 1.0) or (not _speaks_tls(host, port) and _is_greeted(plain, GREETING_SEC))
        with context.wrap_socket(plain) as encrypted:
            return _is_greeted(encrypted, GREETING_SEC)


def _is_greeted(connection: socket.socket, seconds: float) -> bool:
    """Whether a message of Dask's begins: with its size, which of a greeting is small, and of any text is not."""
    connection.settimeout(seconds)
    try:
        start = connection.recv(SIZE_BYTES)
    except TimeoutError:
        return False
    return len(start) == SIZE_BYTES and int.from_bytes(start, "little") < MAX_GREETING_BYTES


def _speaks_tls(host: str, port: int) -> bool:
    # Nothing is sent and nobody trusted: that there is a handshake at all is the answer.
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    try:
        with socket.create_connection((host, port), timeout=REACH_SEC) as plain, context.wrap_socket(plain):
            return True
    except ssl.SSLError as error:
        return error.reason != "WRONG_VERSION_NUMBER" and "ALERT" in str(error.reason)
    except OSError:
        return False
