"""The console script: the command line with everything around it that a shell sees."""

import os
import signal
import sys

EXIT_FAULT, EXIT_INTERRUPTED = 1, 130
INTERRUPTED = "moseg: interrupted; what was finished is kept, the same command goes on from there"


def main(arguments: list[str] | None = None) -> None:
    """Run `moseg`: exit code 0 when done, 2 for bad use or input, 1 for a fault, 130 when interrupted."""
    try:
        # Inside the block, because it takes a while and may be interrupted.
        from moseg.workflows.cli.app import run

        code = run(sys.argv[1:] if arguments is None else arguments)
    except KeyboardInterrupt:
        print(INTERRUPTED, file=sys.stderr)
        code = EXIT_INTERRUPTED
    if code == EXIT_INTERRUPTED and os.name == "posix":
        # Only threads and processes that end by themselves are left: a second interruption must not print their traces.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_flush(code))


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
