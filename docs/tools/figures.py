"""Figures of the documents, taken from the files of measurements.

In a page, ``<!--=NAME/PATH-->77.5<!--/-->`` holds one figure and ``<!--table NAME-->`` to ``<!--/table-->`` a table of
`result_tables`. The text between the markers is generated. NAME is a measurement or a file of a separate measurement,
PATH leads to a number in it, and ``:.0f`` after it sets its format (``.1f`` by default):

- of scores ``fused/J`` is a variant's mean, ``fused/J@dog`` that of a sequence or of a group of sequences,
  ``fused/J#least`` the minimum over sequences, ``fused/J#lowest`` the three lowest with their names;
- ``sequences`` is the number of scored sequences;
- ``seconds`` is the time of the whole command, ``seconds_a_frame`` a share of it;
- in every other file a path consists of the keys to the number.
"""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

from measured_data import NUM_FRAMES
from measurements import CATALOGUE
from result_tables import TABLES, table

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "results"
MEASURED_APART = RESULTS / "apart"
PAGES = (
    ROOT / "README.md",
    *(
        ROOT / "docs" / f"{name}.md"
        for name in (
            "results",
            "weights_free",
            "trajectories",
            "trajectory_trials",
            "models",
            "pipeline",
            "road_scenes",
            "peers",
            "learning",
            "exports",
            "inputs",
        )
    ),
)
NOT_MEASURED = "–"
NUM_LOWEST = 3

_INLINE = re.compile(r"(<!--=(\S+?)-->)(.*?)(<!--/-->)", re.DOTALL)
_TABLE = re.compile(r"(<!--table (\S+)-->\n)(.*?)(<!--/table-->)", re.DOTALL)
_PLACE = re.compile(r"\{([^}]+)\}")


class Figures:
    """Numbers in the files of a folder, by name and path."""

    def __init__(self, folder: Path = RESULTS):
        self._folder = folder
        self._read = cache(self._read_file)

    def text(self, expression: str) -> str:
        """Return the figure as printed, or `NOT_MEASURED` without a file; raises LookupError for an unknown path."""
        path, _, form = expression.partition(":")
        name, _, rest = path.partition("/")
        said = self._read(name)
        if said is None:
            return NOT_MEASURED
        try:
            value = self._value(said, rest)
        except (KeyError, StopIteration) as error:
            raise LookupError(f"no figure {expression}") from error
        return value if isinstance(value, str) else format(value, form or ".1f")

    def seconds(self, name: str) -> float | None:
        """Return the time of a measurement's command, s; None if it has no file."""
        said = self._read(name)
        return None if said is None else said["seconds"]

    def _value(self, said: dict[str, Any], path: str) -> float | int | str:
        if path == "seconds_a_frame":
            return said["seconds"] / NUM_FRAMES[said["result"]["dataset"]]
        if path == "seconds":
            return said["seconds"]
        result = said["result"]
        if "rows" not in result:
            for key in path.split("/"):
                result = result[key]
            return result
        if path == "sequences":
            return len(result["rows"][0]["sequences"])
        variant, _, rest = path.partition("/")
        row = next(row for row in result["rows"] if row["variant"] == variant)
        if rest == "spread":
            return row["spread"]
        score, _, over = rest.partition("#")
        score, _, sequence = score.partition("@")
        if over:
            found = sorted((each[score], name) for name, each in row["sequences"].items())
            lowest = ", ".join(f"`{name}` {value:.1f}" for value, name in found[:NUM_LOWEST])
            return {"least": found[0][0], "lowest": lowest}[over]
        return (row["sequences"] | row.get("groups", {}))[sequence][score] if sequence else row["mean"][score]

    def _read_file(self, name: str) -> dict[str, Any] | None:
        """Return the content of the file of a name; None if a measurement has no file yet."""
        for path in (self._folder / f"{name}.json", self._folder / "apart" / f"{name}.json"):
            if path.exists():
                return json.loads(path.read_text(encoding="utf-8"))
        if name not in {measurement.name for measurement in CATALOGUE}:
            raise LookupError(f"no measurement {name}")
        return None


def written(text: str, figures: Figures) -> str:
    """Return the page with all figures and tables filled in; raises LookupError if one is unknown."""

    def block(found: re.Match) -> str:
        if found[2] not in TABLES:
            raise LookupError(f"no table {found[2]}")
        return found[1] + filled(table(found[2]), figures) + found[4]

    text = _TABLE.sub(block, text)
    return _INLINE.sub(lambda found: found[1] + figures.text(found[2]) + found[4], text)


def filled(text: str, figures: Figures) -> str:
    """Return the text with each ``{expression}`` replaced by its figure."""
    return _PLACE.sub(lambda found: figures.text(found[1]), text)
