"""A package with a plug-in of each kind, commands that run beside it, and programs that import it."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

METADATA = "Metadata-Version: 2.1\nName: nova\nVersion: 1.0\n"
ENTRY_POINT = "[moseg.plugins]\nnova = nova:PLUGIN\n"
# Runs each of several commands and prints their exit codes and outputs as JSON.
RUN_ALL = """
import contextlib, io, json, sys
from moseg.workflows.cli.app import run

results = []
for words in json.loads(sys.argv[1]):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run(words)
    results.append([code, out.getvalue(), err.getvalue()])
print(json.dumps(results))
"""


@pytest.fixture
def site(tmp_path) -> Path:
    """Return a folder of installed packages with the plug-in."""
    folder = tmp_path / "site"
    (folder / "nova").mkdir(parents=True)
    shutil.copy(Path(__file__).parent / "nova.py", folder / "nova" / "__init__.py")
    (folder / "nova-1.0.dist-info").mkdir()
    (folder / "nova-1.0.dist-info" / "METADATA").write_text(METADATA)
    (folder / "nova-1.0.dist-info" / "entry_points.txt").write_text(ENTRY_POINT)
    return folder


@pytest.fixture
def run_with(site, tmp_path):
    """Return a function that runs commands in one process with `site` and returns code and output of each."""

    def call(*commands: tuple) -> list[tuple[int, str, str]]:
        environ = os.environ | {"PYTHONPATH": str(site), "COLUMNS": "200", "_TYPER_FORCE_DISABLE_TERMINAL": "1"}
        words = json.dumps([list(map(str, command)) for command in commands])
        start = [sys.executable, "-c", RUN_ALL, words]
        ran = subprocess.run(start, env=environ, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stderr
        return json.loads(ran.stdout)

    return call


@pytest.fixture
def run_python(site, tmp_path):
    """Return a function that runs a program beside `site`, given as arguments of Python, and returns its output."""

    def call(*arguments: object) -> str:
        command, environ = [sys.executable, *map(str, arguments)], os.environ | {"PYTHONPATH": str(site)}
        ran = subprocess.run(command, env=environ, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stderr
        return ran.stdout

    return call
