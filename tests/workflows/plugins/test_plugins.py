"""Plug-ins of a package or a script: found by name in all commands, with their code in the keys."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from moseg.store import open_store

SCRIPT = """
import sys

import moseg
import nova

moseg.register(*nova.PLUGIN)

if __name__ == "__main__":
    from moseg.workflows.cli import main

    main()
"""
CUES = ("--set", "sections.length=4", "--set", "sections.overlap=2")


def _recipe(store: Path, task: str):
    opened = open_store(str(store), create=False)
    return opened.manifest(next(iter(opened.refs(task)))).recipe


def test_an_installed_package_is_found_by_every_command(run_with):
    commands = (
        "backends",
        "datasets",
        "eval --flow nonsense",
        "config show flow.method",
        "eval --help",
        "export --help",
    )
    backends, datasets, refused, shown, evaluation, export = run_with(*(command.split() for command in commands))
    assert "--flow farneback" in backends[1] and "mean of residuals" in backends[1]
    assert "nova-set" in datasets[1]
    assert refused[0] == 2 and "'folder' or 'farneback'" in refused[2]
    assert "farneback" in shown[1]
    assert "or nova-mean" in evaluation[1] and "webm or count" in export[1]


def test_a_method_and_a_model_are_computed_and_their_code_is_part_of_the_keys(run_with, site, squares, tmp_path):
    store = tmp_path / "store"
    data = ("--dataset", "folder", "--root", squares, "--store", store, *CUES)
    chosen = ("--flow", "farneback", "--affinity", "nova-mean", "--set", "fused_flow_model=shift")
    (code, _, err), (_, planned, _) = run_with(("eval", *data, *chosen, "--quiet"), ("plan", *data, *chosen))
    assert code == 0, err
    flow, model = _recipe(store, "flow"), _recipe(store, "flow_model")
    assert flow.params["method"] == "farneback" and len(flow.params["code"]) == 32
    assert model.params["model"] == "shift" and model.params["model_code"] == flow.params["code"]
    assert "\n0 artifacts to compute" in planned
    path = site / "nova" / "__init__.py"
    path.write_text(path.read_text() + "# Changed.\n")
    ((_, planned, _),) = run_with(("plan", *data, *chosen))
    assert "\n0 artifacts to compute" not in planned and "flow" in planned
    # Artifacts that do not read it are unchanged.
    assert "code" not in _recipe(store, "tracks").params


def test_other_modules_of_the_user_are_part_of_the_keys(run_with, site, squares, tmp_path):
    path = site / "nova" / "__init__.py"
    path.write_text(path.read_text().replace("import cv2", "import cv2\nimport nova_math"))
    (site / "nova_math.py").write_text("from os import path\n\nif path:\n    import json, nova_deep as deep\n")
    (site / "nova_deep.py").write_text("FACTOR = 1\n")
    data = ("--dataset", "folder", "--root", squares, "--store", tmp_path / "store", *CUES, "--affinity", "nova-mean")
    ((code, _, err), (_, planned, _)) = run_with(("eval", *data, "--quiet"), ("plan", *data))
    assert code == 0, err
    assert "\n0 artifacts to compute" in planned
    (site / "nova_deep.py").write_text("FACTOR = 2\n")
    ((_, planned, _),) = run_with(("plan", *data))
    assert "\n0 artifacts to compute" not in planned and "affinity" in planned


@pytest.mark.parametrize(
    ("statement", "is_followed"),
    [
        ("import helper", True),
        ("\ufeffimport helper", True),
        ("import \\\r\n    helper\r\n", True),
        ("from helper . sub import x", True),
        ("def run():\n    from helper import *", True),
        ("import wave", True),
        ("import package.part", True),
        ('"""Words\nimport helper\n"""', False),
        ("import empty", False),
        ("import library", False),
        ("from test import support", False),
        ("import json", False),
    ],
)
def test_only_code_of_the_user_is_followed(run_python, tmp_path, statement, is_followed):
    files = {
        "helper.py": "",
        "wave.py": "",
        "package/part.py": "",
        "package/.#part.py": None,
        "package/.venv/pyvenv.cfg": "",
        "package/.venv/broken.py": "",
        "package/env/pyvenv.cfg": "",
        "package/env/broken.py": "",
        "empty/notes.txt": "",
        "library.py": "",
        "library-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: library\nVersion: 1.0\n",
        "library-1.0.dist-info/RECORD": "library.py,,\n",
        "mine.py": statement,
    }
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if text is None:
            path.symlink_to("nowhere")
        else:
            path.write_bytes(text.encode())
    printing = "from moseg.workflows.plugins import code\n"
    printing += "print(code._with_imports({'mine'}), [p.name for p in code._python_files(code.Path('package'))])\n"
    names, parts = run_python("-c", printing).strip().split("] [")
    assert (names.count(",") == 1) == is_followed, names
    assert parts == "'part.py']"


def test_the_key_does_not_depend_on_who_imports_an_installed_plug_in(run_python, tmp_path):
    printing = "from moseg.workflows.plugins import loading, registered\nloading.load_plugins()\n"
    printing += "print([(entry.package, entry.code) for entry in registered.entries])\n"
    script = tmp_path / "script.py"
    script.write_text(f"from nova import PLUGIN\n{printing}")
    expected = run_python("-c", printing)
    assert "'nova'" in expected
    assert run_python("-c", f"from nova import PLUGIN\n{printing}") == expected
    assert run_python(str(script)) == expected


def test_a_script_may_register_what_is_installed(run_python):
    script = "import moseg\nfrom nova import PLUGIN\nmoseg.register(*PLUGIN)\n"
    script += "print(moseg.load_config({'affinity.method': 'nova-mean'}).affinity.method)\n"
    assert run_python("-c", script) == "nova-mean\n"


def test_a_script_registers_for_worker_processes_too(site, squares, tmp_path):
    (site / "nova-1.0.dist-info" / "entry_points.txt").unlink()
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    words = ("eval", "--dataset", "folder", "--root", squares, "--store", tmp_path / "store", *CUES)
    command = [sys.executable, script, *words, "--flow", "farneback", "--workers", "1", "--quiet"]
    environ = os.environ | {"PYTHONPATH": str(site)}
    ran = subprocess.run([*map(str, command)], env=environ, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert len(_recipe(tmp_path / "store", "flow").params["code"]) == 32


def test_an_export_of_a_plug_in_is_written(run_with, squares, tmp_path):
    video = squares / "squares" / "frames"
    command = ("segment", video, "--out", tmp_path / "out", "--export", "count", *CUES, "--quiet")
    ((code, _, err),) = run_with(command)
    assert code == 0, err
    assert (tmp_path / "out" / "count" / "count.txt").read_text() == "10\n"


def test_a_second_thread_waits_until_plug_ins_are_loaded(run_python, site):
    path = site / "nova" / "__init__.py"
    path.write_text("import time\n\ntime.sleep(1)\n" + path.read_text())
    script = """
from concurrent.futures import ThreadPoolExecutor
from moseg.workflows.plugins import loading, registered

def load(number):
    loading.load_plugins()
    return len(registered.entries)

with ThreadPoolExecutor(4) as threads:
    print(set(threads.map(load, range(4))))
"""
    assert run_python("-c", script) == "{6}\n"
