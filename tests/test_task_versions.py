"""A change of a task's code under an unchanged version is noticed."""

import importlib.util
import sys
from pathlib import Path

import pytest


def _load(name):
    """Load a script beside this file; tests are not on the path, because their folders are named like packages."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


prints = _load("task_fingerprints")
script = _load("record_task_fingerprints")

TOY = {
    "moseg.workflows.stages.toy": """
from moseg.tasks.toy import double
from moseg.workflows.stages.task import Task

def _run(params, inputs, rng):
    return double(inputs)

TOY = Task("toy", "double", version=1, run=_run)
OTHER = Task("toy", "other", version=1, run=len)
""",
    "moseg.tasks.toy": "from moseg.tasks.toy.halve import halve\nfrom moseg.tasks.toy.double import double\n",
    "moseg.tasks.toy.double": '''
"""Doubling."""
import numpy as np
from moseg.tasks.toy import scale

FACTOR = 2

def double(x):
    """Twice x."""
    # By multiplication.
    return scale.apply(np.asarray(x) * FACTOR)

def unused(x):
    return x
''',
    "moseg.tasks.toy.scale": "def apply(x):\n    return x + 0\n",
    "moseg.tasks.toy.halve": "def halve(x):\n    return x / 2\n",
}
ROOT = prints.ModuleName("moseg.workflows.stages.toy", "TOY")


@pytest.fixture(scope="module")
def current():
    """Return the current fingerprints of all tasks, each read from its sources."""
    return prints.current_fingerprints()


def _fingerprint(module=None, old="", new=""):
    """Return the fingerprint of the toy task after one edit of one module's source."""
    sources = dict(TOY)
    if module is not None:
        assert old in sources[module]
        sources[module] = sources[module].replace(old, new)
    return prints.fingerprint(ROOT, sources.get)


def test_every_task_has_the_recorded_code_or_a_higher_version(current):
    recorded = prints.recorded_fingerprints()
    moved = prints.moved_unnoticed(recorded, current)
    assert not moved, (
        f"the code behind {', '.join(moved)} changed and its version did not, so stores would serve the old code's "
        "results: raise the version where the task is defined, then run `python tests/record_task_fingerprints.py`"
    )
    outdated = sorted(name for name in recorded.keys() | current.keys() if recorded.get(name) != current.get(name))
    assert not outdated, (
        f"the record of {', '.join(outdated)} is out of date: run `python tests/record_task_fingerprints.py`"
    )


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("moseg.workflows.stages.toy", "double(inputs)", "double(inputs[0])"),
        ("moseg.tasks.toy.double", "* FACTOR", "+ FACTOR"),
        ("moseg.tasks.toy.double", "FACTOR = 2", "FACTOR = 3"),
        ("moseg.tasks.toy.double", "import numpy as np", "import scipy as np"),
        ("moseg.tasks.toy.double", "FACTOR = 2", "FACTOR = 2\nprint(FACTOR)"),
        ("moseg.tasks.toy.double", "FACTOR = 2", "FACTOR = [2]\nFACTOR[0] = 3"),
        ("moseg.tasks.toy.scale", "x + 0", "x - 0"),
        (
            "moseg.tasks.toy",
            "from moseg.tasks.toy.double import double",
            "from moseg.tasks.toy.halve import halve as double",
        ),
    ],
)
def test_another_program_is_another_fingerprint(module, old, new):
    assert _fingerprint(module, old, new) != _fingerprint()


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("moseg.workflows.stages.toy", "version=1", "version=2"),
        ("moseg.workflows.stages.toy", "run=len", "run=max"),
        ("moseg.tasks.toy.double", "# By multiplication.", "# Not by addition."),
        ("moseg.tasks.toy.double", '"""Twice x."""', '"""Two times x."""'),
        ("moseg.tasks.toy.double", '"""Twice x."""', ""),
        ("moseg.tasks.toy.double", '"""Doubling."""', ""),
        ("moseg.tasks.toy.double", "\nFACTOR", "\n\n\nFACTOR"),
        ("moseg.tasks.toy.double", "    return x\n", "    return -x\n"),
        ("moseg.tasks.toy.halve", "x / 2", "x // 2"),
    ],
)
def test_comments_docstrings_and_unused_definitions_do_not_change_a_fingerprint(module, old, new):
    assert _fingerprint(module, old, new) == _fingerprint()


def test_a_changed_function_changes_only_the_fingerprints_of_tasks_that_reach_it(current):
    module = "moseg.tasks.geometry.sampson"

    def edited(name):
        source = prints.read_source(name)
        return source.replace("+", "-") if name == module else source

    moved = set(prints.moved_unnoticed(current, prints.current_fingerprints(edited)))
    assert {"fundamental:ransac", "fundamental_residual:sampson"} <= moved
    assert not moved & {"flow:dis", "proposals:given", "segmentation:moving-objects", "ingest:images"}


def test_the_record_is_not_overwritten_under_an_unchanged_version(tmp_path, capsys):
    path = tmp_path / "record.json"
    first = {"flow:dis": prints.Fingerprint(1, "aa")}
    moved = {"flow:dis": prints.Fingerprint(1, "bb")}
    raised = {"flow:dis": prints.Fingerprint(2, "bb"), "flow:new": prints.Fingerprint(1, "cc")}
    assert script.record(first, path) == 0
    assert script.record(moved, path) == 1
    assert prints.recorded_fingerprints(path) == first
    assert "flow:dis" in capsys.readouterr().err
    assert script.record(raised, path) == 0
    assert prints.recorded_fingerprints(path) == raised
    assert script.record({"flow:dis": prints.Fingerprint(2, "dd")}, path, is_forced=True) == 0
