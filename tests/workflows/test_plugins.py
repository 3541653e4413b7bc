"""Plug-ins of a package or a script: found by name in all commands, with their code in the keys."""

import json
import os
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from moseg.store import open_store

METADATA = "Metadata-Version: 2.1\nName: nova\nVersion: 1.0\n"
ENTRY_POINT = "[moseg.plugins]\nnova = nova:PLUGIN\n"
NOVA = '''
"""A package that adds one of each kind."""

import cv2
import numpy as np

from moseg import Method
from moseg.tasks.motion_models.flow_model import FlowModel, terms_matrix
from moseg.tasks.point_models.affine import AffineModel
from moseg.workflows.datasets.two_trees import TwoTrees
from moseg.workflows.exports.formats import ExportFormat
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.write_text import write_text
from moseg.workflows.stages.task import Output, Task


def run_flow(params, inputs, rng):
    grey0, grey1 = (cv2.cvtColor(inputs[role].cached("image"), cv2.COLOR_RGB2GRAY) for role in ("frame0", "frame1"))
    return Output({"flow": cv2.calcOpticalFlowFarneback(grey0, grey1, None, 0.5, 5, 15, 3, 5, 1.2, 0)})


def run_affinity(params, inputs, rng):
    residuals = np.concatenate([section.array("residual") for section in inputs.all("residuals")])
    affinity = np.exp(-np.nan_to_num(residuals).mean(axis=0))
    return Output({"affinity": (affinity + affinity.T) / 2, "static_support": affinity[0]})


def view_params(config, view):
    return {}


def write_count(saved, folder, dilation=None):
    with count_folder(folder, saved.summary.name, saved.names) as target:
        write_text(target.folder / "count.txt", f"{len(saved.names)}\\n")
    return target.folder


def count_folder(folder, sequence, names):
    return OwnedFolder(folder / "count", ("count.txt",))


_SHIFT = tuple("ab")
PLUGIN = [
    Method(Task("flow", "farneback", version=1, run=run_flow), "Farneback", "OpenCV, Apache-2.0"),
    Method(Task("affinity", "nova-mean", version=1, run=run_affinity, params=view_params), "mean of residuals"),
    FlowModel(
        name="shift",
        parameters=_SHIFT,
        u_terms=terms_matrix(_SHIFT, {"a": (1, "1")}),
        v_terms=terms_matrix(_SHIFT, {"b": (1, "1")}),
        uses_depth=False,
        has_free_shift=True,
    ),
    AffineModel(name="nova-affine"),
    TwoTrees("nova-set", "frames", "masks", "instance", None, None, None, "masks", "https://example.org"),
    ExportFormat("count", "number of frames", write_count, count_folder),
]
'''
SCRIPT = """
import sys

import moseg
import nova

moseg.register(*nova.PLUGIN)

if __name__ == "__main__":
    from moseg.workflows.cli import main

    main()
"""
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
NO_LIST = "did not return a list with an Output for each input in flow by farneback, sequence squares"
TOGETHER = """
def run_together(params, inputs):
    for each in inputs:
        if each["frame0"].cached("image").mean() < 10:
            raise InputError("too dark")
    return [run_flow(params, each, None) for each in inputs]
"""
CUES = ("--set", "sections.length=4", "--set", "sections.overlap=2")


@pytest.fixture
def site(tmp_path) -> Path:
    """Return a folder of installed packages with the plug-in."""
    folder = tmp_path / "site"
    (folder / "nova").mkdir(parents=True)
    (folder / "nova" / "__init__.py").write_text(NOVA)
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
def test_only_code_of_the_user_is_followed(tmp_path, statement, is_followed):
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
    names, parts = _codes(tmp_path, tmp_path, "-c", printing).strip().split("] [")
    assert (names.count(",") == 1) == is_followed, names
    assert parts == "'part.py']"


def _codes(site: Path, tmp_path: Path, *start: str) -> str:
    """Return what a process prints whose last lines print the codes of the plug-ins."""
    environ = os.environ | {"PYTHONPATH": str(site)}
    ran = subprocess.run(
        [sys.executable, *start], env=environ, cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def test_the_key_does_not_depend_on_who_imports_an_installed_plug_in(site, tmp_path):
    printing = "from moseg.workflows.plugins import loading, registered\nloading.load_plugins()\n"
    printing += "print([(entry.package, entry.code) for entry in registered.entries])\n"
    script = tmp_path / "script.py"
    script.write_text(f"from nova import PLUGIN\n{printing}")
    expected = _codes(site, tmp_path, "-c", printing)
    assert "'nova'" in expected
    assert _codes(site, tmp_path, "-c", f"from nova import PLUGIN\n{printing}") == expected
    assert _codes(site, tmp_path, str(script)) == expected


def test_a_script_may_register_what_is_installed(site, tmp_path):
    script = "import moseg\nfrom nova import PLUGIN\nmoseg.register(*PLUGIN)\n"
    script += "print(moseg.load_config({'affinity.method': 'nova-mean'}).affinity.method)\n"
    assert _codes(site, tmp_path, "-c", script) == "nova-mean\n"


def test_a_plug_in_that_cannot_be_imported_is_one_line_in_python(site, tmp_path):
    (site / "nova" / "__init__.py").write_text("import nowhere")
    script = "import moseg\ntry:\n    moseg.load_config()\nexcept moseg.InputError as error:\n    print(error)\n"
    said = _codes(site, tmp_path, "-c", script)
    assert said.startswith("plug-in cannot be imported in nova:PLUGIN") and said.count("\n") == 1


def test_an_object_is_registered_without_a_file_only_if_it_comes_from_one(site, tmp_path):
    (site / "nova-1.0.dist-info" / "entry_points.txt").unlink()
    _codes(site, tmp_path, "-c", "import moseg, nova\nmoseg.register(*nova.PLUGIN)\n")
    made = "moseg.Method(moseg.workflows.stages.task.Task('flow', 'mine', version=1, run=nova.run_flow), '')"
    with pytest.raises(AssertionError, match="the code of a plug-in cannot be read in __main__; got no file"):
        _codes(site, tmp_path, "-c", f"import moseg, moseg.workflows.stages.task, nova\nmoseg.register({made})\n")


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


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("return {}", "return None", "parameters of a recipe that are no mapping in affinity by nova-mean; got None"),
        (
            "config, view):",
            "config):",
            "params of a method that takes other arguments in affinity by nova-mean; got def params(config); expected"
            " the configuration, view",
        ),
        (
            "return {}",
            "return {'scale': view_params}",
            "parameters that JSON cannot hold in affinity by nova-mean; got scale of function; expected names with",
        ),
        (
            "return Output({",
            "return ({",
            "no Output in flow by farneback, sequence squares; got dict",
        ),
        (
            "(affinity + affinity.T) / 2",
            "[affinity]",
            "affinity that is no array in affinity by nova-mean, sequence",
        ),
        ('affinity": (aff', 'afinity": (aff', "wrong set of arrays of affinity in affinity by nova-mean, sequence"),
        (
            "+ affinity.T) / 2",
            "+ affinity.T).astype('f4')",
            "wrong array layout of affinity.affinity in affinity by nova",
        ),
        ("rng):\n", "rng):\n    return Output([1])\n", "no Output in flow by farneback, sequence squares; got list"),
        ("run=run_flow", "run_together=lambda params, inputs: None", f"{NO_LIST}; got NoneType; expected 1 of them"),
        ("run=run_flow", "run_together=lambda params, inputs: []", f"{NO_LIST}; got 0 values; expected 1 of them"),
    ],
)
def test_what_a_method_returns_is_checked(run_with, site, squares, tmp_path, old, new, message):
    (site / "nova" / "__init__.py").write_text(NOVA.replace(old, new))
    data = ("--dataset", "folder", "--root", squares, "--store", tmp_path / "store", *CUES)
    ((code, _, err),) = run_with(("eval", *data, "--flow", "farneback", "--affinity", "nova-mean", "--quiet"))
    assert code == 2 and message in err and len(err.splitlines()) == 1


@pytest.mark.parametrize("workers", ["0", "1"])
def test_a_fault_names_the_plug_in_whose_code_ran(run_with, site, squares, tmp_path, workers):
    text = NOVA.replace("rng):\n    grey0", "rng):\n    cv2.cvtColor(None)\n    grey0")
    (site / "nova" / "__init__.py").write_text(text)
    data = ("--dataset", "folder", "--root", squares, "--store", tmp_path / "store", *CUES)
    ((code, _, err),) = run_with(("eval", *data, "--flow", "farneback", "--workers", workers, "--quiet"))
    assert code == 1 and "Traceback" in err and 'nova/__init__.py", line' in err
    assert err.splitlines()[-1].startswith("moseg: a fault in plug-in nova: ")


def test_only_the_sequence_that_an_error_is_about_is_named(run_with, site, write_squares, tmp_path):
    text = NOVA.replace("import cv2", "import cv2\nfrom moseg.schemas.errors import InputError")
    text = text.replace("def run_affinity", f"{TOGETHER}\n\ndef run_affinity").replace(
        "run=run_flow", "run_together=run_together"
    )
    (site / "nova" / "__init__.py").write_text(text)
    root = tmp_path / "data"
    for name in ("first", "second"):
        write_squares(root / name)
    for path in (root / "second" / "frames").iterdir():
        cv2.imwrite(str(path), np.zeros_like(cv2.imread(str(path))))
    data = ("eval", "--dataset", "folder", "--root", root, *CUES, "--flow", "farneback", "--quiet")
    runs = ((*data, "--batch", number, "--store", tmp_path / number) for number in ("1", "40"))
    alone, together, status = run_with(*runs, ("status", "latest", "--store", tmp_path / "1"))
    assert (alone[0], alone[2]) == (2, "moseg: too dark in sequence second\n")
    assert (together[0], together[2]) == (2, "moseg: too dark\n")
    assert ": too dark\nended by: too dark in sequence second\n" in status[1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import nowhere", "plug-in cannot be imported in nova:PLUGIN; got ModuleNotFoundError: No module named"),
        ("PLUGIN = 3", "nothing that a plug-in can add in nova; got 3"),
        (NOVA.replace('"farneback"', '"dis"'), "method exists in stage flow; got dis"),
        (NOVA.replace('Task("flow"', 'Task("flows"'), "unknown stage 'flows': did you mean 'flow'?"),
        (
            NOVA.replace("params=view_params", "params=None"),
            "params that is no function in affinity by nova-mean of nova; got None",
        ),
        (NOVA.replace('"nova-set"', '"davis16"'), "data set exists in plug-in; got davis16"),
        (
            NOVA.replace('"farneback", version=1', '"farneback", version="1"'),
            "wrong version in flow by farneback of nova; got '1'",
        ),
        (NOVA.replace('"farneback", version', '"folder", version'), "no name for a method in flow by folder of nova"),
        (
            NOVA.replace("def run_flow(params, inputs, rng)", "def run_flow(image0, image1)"),
            "run of other arguments in flow",
        ),
        (
            NOVA.replace('AffineModel(name="nova-affine")', "AffineModel"),
            "nothing that a plug-in can add in nova; got <class",
        ),
        (NOVA.replace('"instance", None', '"instances", None'), "wrong kind in data set nova-set; got 'instances'"),
        (NOVA + "\nPLUGIN[0].nothing", "pip uninstall nova"),
    ],
)
def test_an_invalid_plug_in_is_rejected_in_one_line(run_with, site, text, message):
    (site / "nova" / "__init__.py").write_text(text)
    ((code, _, err),) = run_with(["--version"])
    assert code == 2 and message in err and len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('"static_support": affinity[0]})', '"static_support": affinity[0, 1:]})', "axis object of two lengths"),
        ("(affinity + affinity.T) / 2", "affinity * 7 - 3", "affinity out of range in affinity by nova-mean"),
        (
            "affinity[0]})",
            'affinity[0]}, {"mean": affinity.mean()})',
            "attributes that cannot be stored in affinity by",
        ),
    ],
)
def test_an_affinity_that_its_stage_cannot_take_is_named(run_with, site, squares, tmp_path, before, after, message):
    text = (site / "nova" / "__init__.py").read_text()
    (site / "nova" / "__init__.py").write_text(text.replace(before, after))
    data = ("--dataset", "folder", "--root", squares, "--store", tmp_path / "store", *CUES)
    ((code, _, err),) = run_with(("eval", *data, "--affinity", "nova-mean", "--quiet"))
    assert code == 2 and message in err and len(err.splitlines()) == 1


def test_a_second_thread_waits_until_plug_ins_are_loaded(site, tmp_path):
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
    assert _codes(site, tmp_path, "-c", script) == "{6}\n"
