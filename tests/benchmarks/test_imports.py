"""Imports of the benchmarks, which run so rarely that a missing name is noticed late, and artifacts in memory."""

import subprocess
import sys
from pathlib import Path

import pytest

from moseg.workflows.stages.inputs import ArtifactView, Inputs

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
FOLDERS = sorted({path.parent.relative_to(BENCHMARKS) for path in BENCHMARKS.rglob("*.py")})
IMPORT_ALL = "import importlib, sys\nfor name in sys.argv[1:]: importlib.import_module(name)"


@pytest.mark.parametrize("folder", FOLDERS, ids=str)
def test_all_that_the_scripts_of_a_folder_import_exists(folder):
    names = [path.stem for path in sorted((BENCHMARKS / folder).glob("*.py"))]
    program = f"import sys; sys.path[:0] = {[str(BENCHMARKS / folder), str(BENCHMARKS)]!r}\n{IMPORT_ALL}"
    done = subprocess.run([sys.executable, "-c", program, *names], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_artifacts_in_memory_have_all_that_tasks_read_of_stored_ones(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS / "engine"))
    from memory_inputs import MemoryInputs, MemoryView

    assert _public(ArtifactView) <= _public(MemoryView)
    assert set(vars(Inputs)) - {"__init__"} <= set(dir(MemoryInputs))


def _public(kind):
    return {name for name in vars(kind) if not name.startswith("_")}
