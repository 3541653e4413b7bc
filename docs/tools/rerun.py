"""Repetition of one measurement: its command is run, and its result is written as JSON that names no machine."""

import json
import os
import shlex
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import fields
from importlib.metadata import version
from pathlib import Path
from typing import Any

from measured_data import DATA, TRACKS
from measurements import Measurement
from typer.core import TyperGroup
from typer.main import get_command

from moseg.workflows.cli.app import app
from moseg.workflows.cli.pipeline_options import PipelineOptions

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "results"
SCORES = (
    *("P", "R", "F", "J"),
    *("error", "median_error", "num_motions", "num_motions_true", "num_motions_correct"),
    *("false_pixels", "false_frames"),
)
"""Scores that are kept of each sequence and of their means."""
ON_FRAMES = ("flow_model", "fundamental", "affinity", "object_hypotheses", "clustering")
ON_TRAJECTORIES = (
    "fused_point_models",
    "noise_reduction",
    "hypotheses",
    "kernel",
    "clip_sections",
    "trajectory_clustering",
)
"""Parameters of the measured geometry, which are kept beside the result."""
DECIMALS = 4


def rerun(measurement: Measurement, roots: Mapping[str, str], store: Path, folder: Path) -> dict[str, Any]:
    """Run the command of a measurement and return the content of its file.

    Parameters
    ----------
    roots : mapping of str to str
        Folder of each key of `DATA`.
    store : Path
        Store of `moseg`.
    folder : Path
        Empty folder for the command's own JSON.

    Raises
    ------
    subprocess.CalledProcessError
        The command failed; its output is on the terminal.
    """
    written = folder / "written.json"
    words = [*arguments(measurement, roots), "--json", str(written)]
    if words[0] == "moseg":
        words = [str(Path(sys.executable).parent / "moseg"), *words[1:], "--store", str(store), "--quiet"]
    else:
        words[0] = sys.executable
    started = time.perf_counter()
    environ = os.environ | {"OMP_NUM_THREADS": "1"}
    subprocess.run(words, cwd=ROOT, env=environ, stdout=subprocess.DEVNULL, check=True)
    seconds = time.perf_counter() - started
    said = {"name": measurement.name, "command": measurement.command, "seconds": round(seconds, 1)}
    result = json.loads(written.read_text(encoding="utf-8"))
    if "rows" in result:
        result["rows"] = [kept(row) for row in result["rows"]]
        said["parameters"] = parameters(measurement)
    return said | {"moseg": version("moseg"), "result": rounded(result)}


def arguments(measurement: Measurement, roots: Mapping[str, str]) -> list[str]:
    """Return the words of the command with the folders of its data."""
    folders = {DATA[data].root: root for data, root in roots.items()}
    return [folders.get(word, word) for word in shlex.split(measurement.command)]


def parameters(measurement: Measurement) -> dict[str, Any]:
    """Return the values of the parameters that a command of `moseg` measures; raises if they cannot be parsed."""
    command, words, context, name = get_command(app), shlex.split(measurement.command)[1:], None, "moseg"
    while isinstance(command, TyperGroup):
        context = command.make_context(name, words, parent=context)
        name, command, words = command.resolve_command(context, words)
    values = command.make_context(name, words, parent=context).params
    config = PipelineOptions(**{field.name: values[field.name] for field in fields(PipelineOptions)}).choices().read()
    words = shlex.split(measurement.command)
    is_of_tracks = words[words.index("--dataset") + 1] in TRACKS
    stages = ON_TRAJECTORIES if is_of_tracks else ON_FRAMES
    return config.model_dump(mode="json", include={*stages})


def file_of(name: str) -> Path:
    """Return the path of the result of a measurement."""
    return RESULTS / f"{name}.json"


def write(said: dict[str, Any]) -> None:
    """Write the file of a measurement, one sequence per line."""
    text = json.dumps(said, indent=1, ensure_ascii=False)
    file_of(said["name"]).write_text(_joined(text) + "\n", encoding="utf-8")


def rounded(value: Any) -> Any:
    """Return the same value with all fractions rounded, except tiny ones."""
    if isinstance(value, dict):
        return {key: rounded(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [rounded(inner) for inner in value]
    if isinstance(value, float):
        return round(value, DECIMALS) if abs(value) > 10**-DECIMALS else float(f"{value:.1e}")
    return value


def kept(row: dict[str, Any]) -> dict[str, Any]:
    """Return a variant's row without the scores that no page shows."""
    sequences = {name: _scores(score) for name, score in row["sequences"].items()}
    found = row | {"sequences": sequences, "mean": _scores(row["mean"])}
    if "seeds" in row:
        found["seeds"] = [{name: entry[name] for name in ("seed", "mean")} for entry in row["seeds"]]
    return found


def _scores(score: dict[str, float]) -> dict[str, float]:
    return {name: score[name] for name in SCORES if name in score}


def _joined(text: str) -> str:
    """Return the same JSON with every innermost object and list on one line."""
    lines, inner = [], []
    for line in text.splitlines():
        if line.endswith(("{", "[")):
            lines += inner
            inner = [line]
        elif inner:
            inner.append(line.strip())
            if line.strip().rstrip(",") in ("}", "]"):
                lines.append(inner[0] + " ".join(inner[1:-1]) + inner[-1])
                inner = []
        else:
            lines.append(line)
    return "\n".join(lines + inner)
