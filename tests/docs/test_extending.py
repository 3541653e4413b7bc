"""The examples of docs/extending.md work: all are applied to a copy of the project, and its commands are run."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from textwrap import dedent
from typing import NamedTuple

import numpy as np
import pytest
from scipy.io import savemat

ROOT = Path(__file__).resolve().parents[2]
EDITOR = "docs/editor"
"""Links to the packages, through which the copy is imported."""
PAGE = ROOT / "docs" / "extending.md"
PACKAGES = ("schemas", "store", "moseg_tasks", "workflows")
RUN_AS_SHOWN = (
    "moseg datasets show my-benchmark --root my-data",
    "moseg eval --dataset my-benchmark --root my-data",
    "moseg backends",
)
RUN_ON_LESS = (
    "moseg eval --dataset synthetic --set fused_flow_model=affine",
    "moseg eval --dataset kt3dmoseg --root /data/KT3DMoSeg --motions gt --views translation,fundamental",
    "moseg segment holiday.mp4 --out holiday --export areas --export coco",
    "moseg eval --dataset synthetic --proposals groundtruth --affinity mean",
    "moseg eval --dataset synthetic --flow farneback",
    "moseg eval --dataset synthetic --proposals groundtruth --affinity median",
)
"""Commands that the tests run with the same options on a smaller input."""
# Runs each line of a command's words, and answers it with the exit code and the output.
SERVE = """
import contextlib, io, json, sys
from moseg.workflows.cli.app import run

for line in sys.stdin:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run(json.loads(line))
    print(json.dumps([code, out.getvalue(), err.getvalue()]), flush=True)
"""
_STEP = re.compile(r"(New file|Change in)\s+`([^`]+\.py)`[^\n]*(?:\n\S[^\n]*)*\n\n((?:(?: {4}.*)?\n)+)")


class Step(NamedTuple):
    """File that the page names, and the block of code below its name."""

    is_new: bool
    path: str
    block: str


def read_steps(text: str) -> list[Step]:
    """Return all new files and changes of the page, in its order."""
    blocks = ((found, dedent(found[3]).strip("\n") + "\n") for found in _STEP.finditer(text))
    return [Step(found[1] == "New file", found[2], block) for found, block in blocks]


def apply(step: Step, root: Path) -> None:
    """Write a new file, or replace each group of ``-`` lines by the ``+`` lines after it."""
    path = root / step.path
    if step.is_new:
        assert not path.exists(), f"{step.path} exists by now: the page needs another name"
        path.write_text(step.block, encoding="utf-8")
        return
    for group in re.findall(r"(?:^-.*\n)+(?:^\+.*\n)+", step.block, re.MULTILINE):
        marks = [(line[0], line[2:]) for line in group.splitlines()]
        old, new = ("\n".join(text for mark, text in marks if mark == sign) for sign in "-+")
        text = path.read_text(encoding="utf-8")
        old, new = (part if old in text else part.strip() for part in (old, new))
        assert text.count(old) == 1, f"{step.path} has no more exactly one place with {old!r}"
        path.write_text(text.replace(old, new), encoding="utf-8")


@pytest.fixture(scope="module")
def extended(tmp_path_factory):
    """Return a copy of the project with all examples of the page."""
    root = tmp_path_factory.mktemp("extended")
    for name in PACKAGES:
        # Compiled files spare a compilation; those that another process is about to write have one more suffix.
        shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("*.pyc.*"))
    shutil.copytree(ROOT / EDITOR, root / EDITOR, symlinks=True)
    text = PAGE.read_text(encoding="utf-8")
    for step in read_steps(text):
        apply(step, root)
    _install_plugin(text, root)
    return root


def _install_plugin(text: str, root: Path) -> None:
    """Write the metadata of the page's ``pyproject.toml`` where Python looks for installed packages."""
    block = re.search(r"`pyproject.toml` of the package:\n\n((?: {4}.*\n|\n)+)", text)[1]
    project = tomllib.loads(dedent(block))["project"]
    folder = root / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    folder.mkdir()
    heads = {"Metadata-Version": "2.1", "Name": project["name"], "Version": project["version"]}
    (folder / "METADATA").write_text("".join(f"{name}: {value}\n" for name, value in heads.items()), encoding="utf-8")
    points = project["entry-points"]["moseg.plugins"]
    lines = "".join(f"{name} = {value}\n" for name, value in points.items())
    (folder / "entry_points.txt").write_text(f"[moseg.plugins]\n{lines}", encoding="utf-8")


@pytest.fixture(scope="module")
def run(extended):
    """Return a function that runs a command line of moseg with the copy, in one process, and returns its output."""

    def run(code: str) -> str:
        server.stdin.write(json.dumps(shlex.split(code)[1:]) + "\n")
        server.stdin.flush()
        exit_code, out, err = json.loads(server.stdout.readline())
        assert exit_code == 0, f"{code}\n{out}{err}"
        return out

    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    environ = _environ(extended)
    with subprocess.Popen([sys.executable, "-c", SERVE], cwd=extended, env=environ, **pipes) as server:
        yield run


def _environ(extended: Path) -> dict[str, str]:
    """Return the environment in which Python finds the copy in place of the project."""
    return {**os.environ, "PYTHONPATH": str(extended / EDITOR), "PYTHONWARNINGS": "ignore"}


@pytest.fixture(scope="module")
def sequence(extended, write_squares):
    """Write the sequence of two squares in the layout of the page's data set and of `folder`."""
    source = write_squares(extended / "squares", num_frames=4)
    shutil.copytree(source / "frames", extended / "my-data" / "frames" / "squares")
    shutil.copytree(source / "masks", extended / "my-data" / "labels" / "squares")
    return source


def test_every_command_of_the_page_is_run_here():
    shown = re.findall(r"^    (moseg .*)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert set(shown) == {*RUN_AS_SHOWN, *RUN_ON_LESS}


def test_the_page_has_an_example_of_every_kind_of_extension():
    steps = read_steps(PAGE.read_text(encoding="utf-8"))
    assert sum(step.is_new for step in steps) == 10
    assert {step.path for step in steps if not step.is_new} >= {
        "workflows/datasets/registry.py",
        "moseg_tasks/motion_models/registry.py",
        "moseg_tasks/point_models/registry.py",
        "workflows/exports/formats/registry.py",
        "workflows/stages/registry.py",
        "workflows/graph/frame_cues.py",
        "workflows/stages/affinity.py",
        "workflows/stages/flow.py",
    }


def test_the_data_set_is_scored(run, sequence):
    described, scored, _ = (run(command) for command in RUN_AS_SHOWN)
    assert "squares" in described and "squares" in scored


def test_the_flow_model_is_fitted(run, extended, sequence):
    options = "--proposals groundtruth --variant fused --store fits"
    run(f"moseg eval --dataset my-benchmark --root my-data --set fused_flow_model=affine {options}")
    # The recipes of a flow model's artifacts name it.
    assert '"affine"' in _recipe(extended / "fits", "flow_model")


def test_the_affinity_is_computed(run, extended, sequence):
    options = "--proposals groundtruth --variant fused --store means"
    run(f"moseg eval --dataset my-benchmark --root my-data --affinity mean {options}")
    assert '"mean"' in _recipe(extended / "means", "affinity")


def test_the_affinity_of_the_plug_in_is_computed(run, extended, sequence):
    options = "--proposals groundtruth --variant fused --store medians"
    run(f"moseg eval --dataset my-benchmark --root my-data --affinity median {options}")
    recipe = _recipe(extended / "medians", "affinity")
    assert '"median"' in recipe and '"code"' in recipe
    assert "median of residuals" in run("moseg backends")


def test_the_script_registers_the_method(extended, sequence):
    shutil.rmtree(next(extended.glob("my_affinities-*.dist-info")))
    # A folder of frames replaces the video.
    shutil.copytree(sequence / "frames", extended / "holiday.mp4")
    options = {"cwd": extended, "env": _environ(extended), "text": True, "capture_output": True}
    ran = subprocess.run([sys.executable, "median.py"], check=False, **options)
    assert ran.returncode == 0, ran.stderr
    manifests = (extended / ".moseg" / "store" / "objects" / "affinity").rglob("manifest.json")
    assert any('"median"' in manifest.read_text(encoding="utf-8") for manifest in manifests)


def test_the_backend_gives_the_flow(run, extended, sequence):
    run("moseg eval --dataset my-benchmark --root my-data --flow farneback --variant base --store flows")
    assert '"farneback"' in _recipe(extended / "flows", "flow")
    assert "--flow farneback" in run("moseg backends")


def test_the_point_model_is_a_view(run, extended):
    rng = np.random.default_rng(0)
    start, label = rng.uniform(0, 300, (60, 1, 2)), np.repeat([1, 2], 30)
    points = (
        start + np.arange(6)[:, None] * np.where(label == 1, 1.0, -3.0)[:, None, None] + rng.normal(0, 0.05, (60, 6, 2))
    )
    homogeneous = np.concatenate([points.transpose(2, 0, 1), np.ones((1, 60, 6))])
    (extended / "clips").mkdir()
    fields = {"ySparse": homogeneous, "visibleSparse": np.ones((60, 6)), "GtLabel": label + 0.0}
    savemat(extended / "clips" / "Seq005_Clip01_Tracks.mat", {"Data": fields})
    command = "moseg eval --dataset kt3dmoseg --root clips --motions gt --views translation,fundamental"
    assert "Seq005_Clip01" in run(f"{command} --set hypotheses.num_hypotheses=50 --variant fused")


def test_the_export_is_written(run, extended, sequence):
    run("moseg segment squares/frames --out holiday --export areas --export coco")
    lines = next((extended / "holiday").rglob("areas.csv")).read_text(encoding="utf-8").splitlines()
    assert lines[0] == "frame,pixels" and len(lines) == 5


def test_the_stage_is_computed_once_and_then_read(extended):
    command, options = [sys.executable, "sharpness.py"], {"cwd": extended, "env": _environ(extended), "text": True}
    first, again = (subprocess.run(command, capture_output=True, check=True, **options).stdout for _ in range(2))
    assert len([float(word) for word in re.findall(r"\d+\.\d+", first)]) == 3
    assert again == first


def _recipe(store: Path, task: str) -> str:
    """Return the manifest of one of the task's artifacts, which contains its recipe."""
    return next((store / "objects" / task).rglob("manifest.json")).read_text(encoding="utf-8")
