"""The console script: the command line with everything around it that a shell sees."""

import codecs
import io
import json
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from functools import partial

EXIT_FAULT, EXIT_INTERRUPTED, EXIT_TERMINATED = 1, 130, 143
_SPELLED = "moseg-spelled"
"""Name of the handling of characters that an encoding lacks."""
_KEPT = "what was finished is kept, the same command goes on from there"


class _Terminated(KeyboardInterrupt):
    """An interruption by SIGTERM: a batch system, a container or `kill` ends a run as Ctrl-C does."""


_AGAIN_SECONDS = 0.05
"""Until a dropped interruption is repeated: the callback that dropped it has returned by then, or drops it again."""
_MAX_REPETITIONS = 100
_received: list[int] = []
"""Signals that were handled, the first one first."""


def main(arguments: list[str] | None = None) -> None:
    """Run `moseg`: exit code 0 when done, 2 for bad use or input, 1 for a fault, 130 or 143 when interrupted."""
    if os.name == "posix" and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, _interrupt)
        # A process that a shell runs in the background ignores Ctrl-C.
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, _interrupt)
    _spell_other_characters()
    report_unraisable = sys.unraisablehook
    sys.unraisablehook = partial(_handle_unraisable, report_unraisable)
    try:
        # Inside the block, because it takes a while and may be interrupted.
        from moseg.workflows.cli.app import run

        code = run(sys.argv[1:] if arguments is None else arguments)
    except KeyboardInterrupt:
        code = report_interruption()
    finally:
        # What an interruption left half made is finalised until the end.
        if not _received:
            sys.unraisablehook = report_unraisable
    if code in (EXIT_INTERRUPTED, EXIT_TERMINATED) and os.name == "posix":
        # Only threads and processes that end by themselves are left: a second interruption must not print their traces.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
    sys.exit(_flush(code))


def report_interruption() -> int:
    """Print the line that ends an interrupted command, and return its exit code."""
    is_terminated = signal.SIGTERM in _received
    print(f"moseg: {'terminated' if is_terminated else 'interrupted'}; {_KEPT}", file=sys.stderr)
    return EXIT_TERMINATED if is_terminated else EXIT_INTERRUPTED


def _interrupt(number: int, frame: object) -> None:
    _received.append(number)
    raise _Terminated if number == signal.SIGTERM else KeyboardInterrupt


def _handle_unraisable(report: Callable[[object], object], unraisable: object) -> None:
    """Interrupt the main thread again if Python has dropped an interruption; report all else as before.

    What a signal raises in a callback of the garbage collector or in a finaliser goes no further. An object that was
    being made when the interruption came, as an event loop, lacks attributes that its finaliser reads: that is no news.
    """
    error = unraisable.exc_value
    if isinstance(error, KeyboardInterrupt) and hasattr(signal, "pthread_kill"):
        number = signal.SIGTERM if isinstance(error, _Terminated) else signal.SIGINT
        threading.Thread(target=_send_until_handled, args=(number, len(_received)), daemon=True).start()
        return
    is_finaliser = getattr(unraisable.object, "__name__", None) == "__del__"
    if not (_received and is_finaliser and isinstance(error, AttributeError)):
        report(unraisable)


def _send_until_handled(number: int, num_received: int) -> None:
    """Send a signal to the main thread until its handler has run.

    Once is not enough: while this thread sends it, the main thread waits for the interpreter's lock. If a blocking call
    is the next that it does, the handler would run after that.
    """
    is_counted = signal.getsignal(number) is _interrupt
    for _ in range(_MAX_REPETITIONS if is_counted else 1):
        time.sleep(_AGAIN_SECONDS)
        if len(_received) > num_received:
            return
        signal.pthread_kill(threading.main_thread().ident, number)


def _spell_other_characters() -> None:
    """Make standard output and error spell characters that their encoding lacks, such as ``\\u30af`` in Latin-1."""
    codecs.register_error(_SPELLED, _spell)
    for stream in (sys.stdout, sys.stderr):
        # Other ways of handling them are the user's choice, or the locale's.
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors=_SPELLED)


def _spell(error: UnicodeError) -> tuple[str, int]:
    """Return what stands for characters that cannot be encoded, and where they end: escapes that JSON has too."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return json.dumps(error.object[error.start : error.end])[1:-1], error.end


def _flush(code: int) -> int:
    """Write out what was printed, although the reader may have ended, as `head` does, or the disk may be full."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError as error:
        if not isinstance(error, BrokenPipeError):
            print(f"moseg: standard output cannot be written: {error.strerror}", file=sys.stderr)
        # Python would flush again at its end, and print an error.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_FAULT
    return code
