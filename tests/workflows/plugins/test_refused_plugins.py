"""Plug-ins that cannot be used, or whose code fails: one line names them, and what is expected."""

from pathlib import Path

import cv2
import numpy as np
import pytest

NOVA = (Path(__file__).parent / "nova.py").read_text()
NO_LIST = "did not return a list with an Output for each input in flow by farneback, sequence squares"
TOGETHER = """
def run_together(params, inputs):
    for each in inputs:
        if each["frame0"].cached("image").mean() < 10:
            raise InputError("too dark")
    return [run_flow(params, each, None) for each in inputs]
"""
CUES = ("--set", "sections.length=4", "--set", "sections.overlap=2")


def test_a_plug_in_that_cannot_be_imported_is_one_line_in_python(run_python, site):
    (site / "nova" / "__init__.py").write_text("import nowhere")
    script = "import moseg\ntry:\n    moseg.load_config()\nexcept moseg.InputError as error:\n    print(error)\n"
    said = run_python("-c", script)
    assert said.startswith("plug-in cannot be imported in nova:PLUGIN") and said.count("\n") == 1


def test_an_object_is_registered_without_a_file_only_if_it_comes_from_one(run_python, site):
    (site / "nova-1.0.dist-info" / "entry_points.txt").unlink()
    run_python("-c", "import moseg, nova\nmoseg.register(*nova.PLUGIN)\n")
    made = "moseg.Method(moseg.workflows.stages.task.Task('flow', 'mine', version=1, run=nova.run_flow), '')"
    with pytest.raises(AssertionError, match="the code of a plug-in cannot be read in __main__; got no file"):
        run_python("-c", f"import moseg, moseg.workflows.stages.task, nova\nmoseg.register({made})\n")


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
