"""Notebook of this process, where there is one: text of HTML below the cell that runs, and later in its place."""

import sys
from collections.abc import Callable
from html import escape
from importlib import import_module
from typing import Any


class Html:
    """Text of HTML as notebooks display it."""

    def __init__(self, text: str, plain: str):
        self._text, self._plain = text, plain

    def _repr_html_(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return self._plain


def notebook() -> Callable[[Html], Any] | None:
    """Return a function that displays something and gives a handle to update it, or None without a notebook."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    # A shell on a terminal has no kernel.
    if getattr(shell, "kernel", None) is None:
        return None
    # The package of the notebook that runs this, and no requirement of ours.
    display = import_module("IPython.display").display
    return lambda content: display(content, display_id=True)


def print_notice(line: str) -> None:
    """Print a line on standard error; a notebook displays it instead, since it marks standard error as a failure."""
    if (show := notebook()) is None:
        print(line, file=sys.stderr, flush=True)
    else:
        show(Html(f"<small>{escape(line)}</small>", line))
