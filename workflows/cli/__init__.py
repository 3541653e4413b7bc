"""The command line, `moseg`."""

from moseg.workflows.cli.entry import main

__all__ = ["main"]
