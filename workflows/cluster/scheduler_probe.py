"""A probe of a Dask scheduler, which reports at once why it cannot be reached.

Dask itself retries until its time is up, whatever the reason, and waits without limit for a greeting.
"""

import socket
import ssl

from moseg.schemas.errors import InputError

REACH_SEC = 5.0
"""Longest time that a host may take to accept a connection."""
PROMPT_SEC = 1.0
"""Time after which a port that has not greeted is asked whether it uses TLS."""
GREETING_SEC = 10.0
"""Longest time between the connection and the scheduler's greeting."""
SIZE_BYTES = 8
MAX_GREETING_BYTES = 2**20


def probe_scheduler(host: str, port: int, context: ssl.SSLContext | None, where: str) -> None:
    """Probe a scheduler and report why it cannot be reached: Dask greets every client, with TLS under a `context`.

    Raises
    ------
    InputError
        Nothing listens there, one side uses TLS and the other does not, the certificates are not trusted, or no
        greeting comes.
    """
    try:
        if _sends_greeting(host, port, context):
            return
        got, expected = "no greeting as Dask sends it", "a Dask scheduler's port, often 8786"
    except ssl.SSLError as error:
        # An answer that is no TLS record is a greeting without TLS.
        if error.reason in ("WRONG_VERSION_NUMBER", "RECORD_LAYER_FAILURE", "UNEXPECTED_RECORD"):
            got, expected = "a port without TLS", "tcp:// in place of tls://"
        else:
            got, expected = error, "a CA and a certificate that both sides trust"
        raise InputError("no TLS with the scheduler", where=where, got=got, expected=expected) from error
    except OSError as error:
        got, expected = error, "a running scheduler: dask scheduler --port 8786"
        raise InputError("no Dask scheduler answers", where=where, got=got, expected=expected) from error
    if context is None and _uses_tls(host, port):
        got, expected = "a port with TLS", "tls:// in place of tcp://, with --tls-ca, --tls-cert and --tls-key"
    raise InputError("no Dask scheduler answers", where=where, got=got, expected=expected)


def _sends_greeting(host: str, port: int, context: ssl.SSLContext | None) -> bool:
    with socket.create_connection((host, port), timeout=REACH_SEC) as plain:
        if context is None:
            # A TLS server waits for the client to begin, so that it can be probed early.
            is_there = _has_greeting(plain, PROMPT_SEC)
            return is_there or (not _uses_tls(host, port) and _has_greeting(plain, GREETING_SEC))
        with context.wrap_socket(plain) as encrypted:
            return _has_greeting(encrypted, GREETING_SEC)


def _has_greeting(connection: socket.socket, seconds: float) -> bool:
    """Return whether a message of Dask's arrives: it begins with its size, which is small, unlike any text."""
    connection.settimeout(seconds)
    try:
        start = connection.recv(SIZE_BYTES)
    except TimeoutError:
        return False
    return len(start) == SIZE_BYTES and int.from_bytes(start, "little") < MAX_GREETING_BYTES


def _uses_tls(host: str, port: int) -> bool:
    # No data are sent and no certificate is needed: that a handshake takes place is the answer.
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
