"""The command line, `moseg`."""

from workflows.cli.app import main

__all__ = ["main"]
