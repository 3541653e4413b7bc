"""The container image is small, pinned and without privileges; it is built and run where Docker is."""

import json
import os
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
TEXT = (ROOT / "Dockerfile").read_text(encoding="utf-8")
IGNORED = (ROOT / ".dockerignore").read_text(encoding="utf-8").split("\n")
TAG = "moseg-test"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def _instructions(text: str) -> list[tuple[str, str]]:
    """Return the instructions of a Dockerfile and their arguments, continued lines joined."""
    lines = re.sub(r"\\\n\s*", "", re.sub(r"^#.*\n", "", text, flags=re.MULTILINE)).splitlines()
    return [tuple(line.split(maxsplit=1)) for line in lines if line.strip()]


def _stages() -> dict[str, tuple[str, list[tuple[str, str]]]]:
    """Return the image that each stage begins with, and its instructions."""
    stages = {}
    for name, arguments in _instructions(TEXT):
        if name == "FROM":
            image, _, stage = arguments.partition(" AS ")
            stages[stage] = (image, [])
        elif stages:
            stages[stage][1].append((name, arguments))
    return stages


def test_the_base_image_is_pinned_to_a_version():
    defaults = dict(arguments.split("=", 1) for name, arguments in _instructions(TEXT) if name == "ARG")
    stages = _stages()
    bases = {image for image, _ in stages.values()} - set(stages)
    assert bases == {"python:${PYTHON}"}
    assert re.fullmatch(r"3\.11\.\d+-slim-\w+", defaults["PYTHON"])


def test_the_last_stage_runs_moseg_without_privileges():
    stages = _stages()
    assert list(stages) == ["build", "cluster", "moseg"] and stages["moseg"][0] == "cluster"
    run = stages["cluster"][1] + stages["moseg"][1]
    found = dict(run)
    assert found["USER"] == "1000:1000" and json.loads(found["ENTRYPOINT"]) == ["moseg"]
    assert [name for name, _ in run].index("USER") < [name for name, _ in run].index("ENTRYPOINT")
    # The store lies in the mounted folder and outlives the container.
    assert f"MOSEG_STORE={found['WORKDIR']}/" in found["ENV"]
    # Dask and Kubernetes give the whole command.
    assert "ENTRYPOINT" not in dict(stages["cluster"][1])


def test_it_installs_the_checkout_with_the_versions_of_the_tests():
    _, build = _stages()["build"]
    found = dict(build)
    assert "PIP_CONSTRAINT=/source/constraints.txt" in found["ENV"] and found["WORKDIR"] == "/source"
    assert '.[${EXTRAS}]"' in TEXT
    (extras,) = (arguments.partition("=")[2] for name, arguments in build if name == "ARG")
    assert set(extras.split(",")) <= set(PROJECT["optional-dependencies"])
    assert not re.search(r"\b(ADD|curl|wget|apt-get|latest|TOKEN|PASSWORD|SECRET)\b", TEXT, re.IGNORECASE)


def test_only_what_is_installed_gets_into_the_image():
    rules = [line for line in IGNORED if line and not line.startswith("#")]
    assert rules[0] == "*"
    allowed = {rule.removeprefix("!") for rule in rules if rule.startswith("!")}
    assert allowed == {
        *("schemas", "store", "moseg_tasks", "workflows"),
        *("pyproject.toml", "setup.py", "constraints.txt", "README.md", "LICENSE"),
    }
    assert all((ROOT / name).exists() for name in allowed)
    assert "**/.*" in rules[rules.index("*") + len(allowed) :]


def _has_docker() -> bool:
    """Return whether a Docker daemon answers."""
    if shutil.which("docker") is None:
        return False
    try:
        return subprocess.run(["docker", "info"], capture_output=True, timeout=30, check=False).returncode == 0
    except subprocess.TimeoutExpired:
        return False


@pytest.fixture(scope="module")
def image():
    """Build the image; needs a Docker daemon and a package index."""
    if not _has_docker():
        pytest.skip("no Docker daemon answers")
    ran = subprocess.run(["docker", "build", "--tag", TAG, ROOT], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    yield TAG
    subprocess.run(["docker", "image", "rm", "--force", TAG], capture_output=True, check=False)


def _docker_run(*arguments: object) -> str:
    command = ["docker", "run", "--rm", "--network", "none", *map(str, arguments)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def test_the_image_runs_as_a_user_without_privileges(image):
    assert _docker_run(image, "--version").strip() == f"moseg {PROJECT['version']}"
    assert _docker_run("--entrypoint", "id", image, "-u").strip() == "1000"
    _docker_run("--entrypoint", "dask", image, "scheduler", "--version")


def test_the_image_segments_a_folder_of_frames(image, squares, tmp_path):
    mounts = ("-v", f"{squares / 'squares' / 'frames'}:/frames:ro", "-v", f"{tmp_path}:/work")
    _docker_run(*mounts, "--user", f"{os.getuid()}:{os.getgid()}", image, "segment", "/frames", "--out", "result")
    assert len(list((tmp_path / "result" / "masks").glob("*.png"))) == 10
