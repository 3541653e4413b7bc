"""The command line, `moseg`."""

from workflows.cli.entry import main

__all__ = ["main"]
