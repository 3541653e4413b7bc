"""Parameters of a plug-in's method: set like all others, and part of the keys of what it computes."""

import json
import os
import re
import subprocess
import sys

import pytest

from moseg.store import open_store

PLUGIN = '''
"""An affinity with parameters of its own."""

from typing import Literal

import numpy as np
from pydantic import Field

import moseg
from moseg.workflows.stages.task import Output, Task


class OwnParams(moseg.Parameters):
    """Affinity by the median of residuals."""

    scale: float = Field(1.5, gt=0, description="residual at which the affinity falls, px")
    statistic: Literal["median", "mean"] = Field("median", description="over frame pairs")


def run(params, inputs, rng):
    own = OwnParams.of_recipe(params["parameters"])
    residuals = np.concatenate([section.array("residual") for section in inputs.all("residuals")])
    both = getattr(np, f"nan{own.statistic}")((residuals + residuals.swapaxes(1, 2)) / 2, axis=0)
    affinity = np.exp(-both / (2 * own.scale**2))
    return Output({"affinity": affinity, "static_support": affinity[0]})


def read(config, view):
    return {"is_flow": view != "trajs"}


PLUGIN = moseg.Method(Task("affinity", "own-mean", version=1, run=run, params=read), "median", parameters=OwnParams)
'''
REGISTER = "import moseg, own\nmoseg.register(own.PLUGIN)\n"
RUN = "import json, sys\nfrom moseg.workflows.cli.app import run\nsys.exit(run(json.loads(sys.argv[1])))\n"


@pytest.fixture
def python(tmp_path):
    """Return a function that runs a program beside the plug-in, and returns its exit code and output."""
    (tmp_path / "own.py").write_text(PLUGIN)

    def call(program, *arguments):
        environ = os.environ | {"PYTHONPATH": str(tmp_path), "COLUMNS": "200", "_TYPER_FORCE_DISABLE_TERMINAL": "1"}
        command = [sys.executable, "-c", program, *arguments]
        ran = subprocess.run(command, env=environ, cwd=tmp_path, capture_output=True, text=True, check=False)
        return ran.returncode, ran.stdout + ran.stderr

    return call


@pytest.fixture
def moseg(python):
    """Return a function that runs a command in a process that has registered the plug-in."""
    return lambda *words: python(REGISTER + RUN, json.dumps(list(map(str, words))))


def test_values_are_set_checked_and_shown(moseg, tmp_path):
    code, text = moseg("config", "show", "plugins.own-mean")
    assert code == 0 and "Affinity by the median of residuals" in text and "1.5" in text and "median, mean" in text
    (tmp_path / "mine.yaml").write_text("plugins:\n  own-mean:\n    scale: 0.7\n")
    dump = ("config", "dump", "--config", tmp_path / "mine.yaml", "--set", "plugins.own-mean.statistic=mean")
    code, text = moseg(*dump)
    assert code == 0 and "  own-mean:" in text and "scale: 0.7" in text and "statistic: mean" in text
    code, text = moseg(*dump[:-1], "plugins.own-mean.scale=0")
    assert code == 2 and "plugins.own-mean.scale" in text and text.count("\n") == 1
    code, text = moseg(*dump[:-1], "plugins.own-mean.scael=1")
    assert code == 2 and "plugins.own-mean.scale" in text and text.count("\n") == 1


def test_values_are_part_of_the_keys_of_the_method_alone(moseg, squares, tmp_path):
    data = ("--dataset", "folder", "--root", squares, "--store", tmp_path / "store", "--affinity", "own-mean")
    code, text = moseg("eval", *data, "--quiet")
    assert code == 0, text
    store = open_store(str(tmp_path / "store"), create=False)
    for ref in store.refs("affinity"):
        assert store.manifest(ref).recipe.params["parameters"] == {"scale": 1.5, "statistic": "median"}
    assert "\n0 artifacts to compute" in moseg("plan", *data)[1]
    planned = moseg("plan", *data, "--set", "plugins.own-mean.scale=0.7")[1]
    assert re.search(r"affinity +│ +[1-9]", planned) and re.search(r"flow_residual +│ +0 ", planned)
    other = ("--affinity", "residual", "--set", "plugins.own-mean.scale=0.7", "--quiet")
    assert moseg("eval", *data[:-2], *other)[0] == 0
    assert all(
        "parameters" not in store.manifest(ref).recipe.params
        for ref in store.refs("affinity")
        if store.manifest(ref).recipe.params["method"] == "residual"
    )


def test_configurations_in_python_have_them_also_if_made_before(python):
    program = "import moseg\nbefore = moseg.load_config()\n" + REGISTER
    program += "after = moseg.load_config({'plugins.own-mean.scale': 2.0})\n"
    program += "print(getattr(before.plugins, 'own-mean').scale, getattr(after.plugins, 'own-mean').scale)\n"
    assert python(program) == (0, "1.5 2.0\n")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("parameters=OwnParams", "parameters=dict", "parameters that are none in affinity by own-mean"),
        ("Field(1.5, gt=0, ", "Field(gt=0, ", "a parameter without a default in affinity by own-mean"),
        ('"own-mean"', '"own.mean"', "no name for parameters in affinity by own.mean"),
    ],
)
def test_parameters_that_cannot_be_set_are_refused(python, tmp_path, old, new, message):
    (tmp_path / "own.py").write_text(PLUGIN.replace(old, new))
    program = "import moseg, own\ntry:\n    moseg.register(own.PLUGIN)\nexcept moseg.InputError as error:\n"
    code, text = python(program + "    print(error)\n")
    assert code == 0 and message in text and text.count("\n") == 1
