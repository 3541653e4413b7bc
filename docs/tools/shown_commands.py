"""Command lines that the documents show: lines of indented blocks and inline code that begin with moseg or make."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))

_CODE_LINE = re.compile(r"^ {4,}(.*)$", re.MULTILINE)
_INLINE = re.compile(r"`([^`]+)`")
_ASSIGNMENTS = re.compile(r"^(?:[A-Z_]+=\S+ +)+(?=\S)")
_PROGRAMS = ("moseg ", "make ")


def shown_code(text: str) -> list[str]:
    """Return lines of indented blocks, alternatives in their comments, and inline code, each on one line.

    Environment variables that are set for one command only are left out.
    """
    return [without_variables(code) for code in _shown(text)]


def shown_commands(text: str) -> list[str]:
    """Return the command lines of moseg and make among them, each once, with the variables that are set for them."""
    return list(dict.fromkeys(code for code in _shown(text) if without_variables(code).startswith(_PROGRAMS)))


def without_variables(code: str) -> str:
    """Return the command without variables, as called with an installed project."""
    return _ASSIGNMENTS.sub("", code).removeprefix(".venv/bin/")


def variables(code: str) -> dict[str, str]:
    """Return the environment variables that are set for the command."""
    found = _ASSIGNMENTS.match(code)
    return dict(pair.split("=", 1) for pair in found.group().split()) if found else {}


def _shown(text: str) -> list[str]:
    found = []
    for line in _CODE_LINE.findall(text):
        code, _, comment = line.partition("  #")
        found.append(code.strip())
        instead = comment.partition("or: ")[2].partition(";")[0].strip()
        # The comment gives an alternative to an option of the line: the last one counts.
        found.append(f"{code.strip()} {instead}" if instead.startswith("-") else instead)
    return found + [" ".join(code.split()) for code in _INLINE.findall(_CODE_LINE.sub("", text))]
