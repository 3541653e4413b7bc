"""Commands that compute nothing import no library that computes."""

import os
import subprocess
import sys

import pytest

HEAVY = ("av", "cv2", "dask", "distributed", "scipy", "sklearn", "torch", "zarr")
PROGRAM = f"""
import sys
from moseg.workflows.cli import main

try:
    main()
finally:
    print(*[name for name in {HEAVY} if name in sys.modules], file=sys.stderr)
"""
TYPED = {"_MOSEG_COMPLETE": "complete_bash", "COMP_WORDS": "moseg eval --flow ", "COMP_CWORD": "3"}


@pytest.mark.parametrize(
    ("words", "environment"),
    [("--help", {}), ("eval --help", {}), ("backends", {}), ("datasets", {}), ("config show", {}), ("", TYPED)],
)
def test_a_command_that_computes_nothing_imports_nothing_for_it(tmp_path, words, environment):
    command = [sys.executable, "-c", PROGRAM, *words.split()]
    ran = subprocess.run(
        command, cwd=tmp_path, env=os.environ | environment, capture_output=True, text=True, check=False
    )
    assert (ran.returncode, ran.stderr) == (0, "\n")
    assert ran.stdout


def test_an_evaluation_whose_results_are_stored_computes_nothing_and_imports_nothing_for_it(evaluated):
    command = [sys.executable, "-c", PROGRAM, *evaluated.arguments, "--store", str(evaluated.store)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 0
    assert not {"distributed", "scipy", "sklearn", "torch"} & {*ran.stderr.split()}, ran.stderr
