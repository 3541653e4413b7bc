"""The wheel contains all code that runs and nothing else, and all statements of the version agree."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from email.parser import HeaderParser
from pathlib import Path
from typing import NamedTuple

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
ROOMS = {
    "schemas": "moseg/schemas",
    "store": "moseg/store",
    "moseg_tasks": "moseg/tasks",
    "workflows": "moseg/workflows",
}
"""Folders at the top of the checkout, with the package under which each is installed."""
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
BESIDE = ("benchmarks", "docs", "tests")
FILES = (
    ".dockerignore",
    "CHANGELOG.md",
    "CITATION.cff",
    "Dockerfile",
    "LICENSE",
    "MANIFEST.in",
    "Makefile",
    "README.md",
    "constraints.txt",
    "pyproject.toml",
    "setup.py",
)
EDITOR = "docs/editor"
"""Links to the folders, through which a checkout is imported without installation."""
FRONT = ("api/moseg/__init__.py", "api/moseg/__main__.py")
PAGE_SUFFIXES = (".html", ".css", ".js", ".onnx", ".json")


class Wheel(NamedTuple):
    """Names of a wheel's files, and the folder in which it is unpacked."""

    names: frozenset[str]
    folder: Path

    def info(self, name: str) -> str:
        """Text of a file of its metadata."""
        return (self.folder / f"moseg-{PROJECT['version']}.dist-info" / name).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def source(tmp_path_factory) -> Path:
    """Return a copy of the project's files, because setuptools leaves files of its own beside the sources."""
    folder = tmp_path_factory.mktemp("source")
    for path in _project_files():
        target = folder / path.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(path.read_bytes())
    shutil.copytree(ROOT / EDITOR, folder / EDITOR, symlinks=True)
    return folder


@pytest.fixture(scope="module")
def wheel(source, tmp_path_factory) -> Wheel:
    folder = tmp_path_factory.mktemp("wheel")
    with zipfile.ZipFile(_build("build_wheel", source, folder)) as archive:
        archive.extractall(folder / "unpacked")
        return Wheel(frozenset(archive.namelist()), folder / "unpacked")


def _build(kind: str, source: Path, folder: Path) -> Path:
    code = f"from setuptools.build_meta import {kind}; import sys; print({kind}(sys.argv[1]))"
    command = [sys.executable, "-c", code, folder]
    ran = subprocess.run(command, cwd=source, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return folder / ran.stdout.split()[-1]


def _project_files() -> list[Path]:
    folders = [ROOT / folder for folder in (*ROOMS, *BESIDE)]
    found = [
        path
        for folder in folders
        for path in folder.rglob("*")
        if path.is_file() and not path.is_symlink() and path.suffix != ".pyc"
    ]
    return [*found, *(ROOT / name for name in FILES)]


def _expected_names() -> set[str]:
    """Return the installed names of the modules and of the parts of pages."""
    found = set()
    for room in ROOMS:
        for path in (ROOT / room).rglob("*"):
            name = f"{ROOMS[room]}/{path.relative_to(ROOT / room).as_posix()}"
            if path.suffix in (".py", *PAGE_SUFFIXES):
                found.add(name.removeprefix("moseg/workflows/api/") if name.endswith(FRONT) else name)
    return found


def test_the_wheel_holds_every_module_and_every_part_of_a_page(wheel):
    assert _expected_names() - wheel.names == set()
    assert {"moseg/__init__.py", "moseg/__main__.py"} <= wheel.names


def test_the_wheel_holds_nothing_else(wheel):
    more = {name for name in wheel.names - _expected_names() if ".dist-info/" not in name}
    assert more == set()
    assert {name.partition("/")[0] for name in wheel.names} == {
        "moseg",
        f"moseg-{PROJECT['version']}.dist-info",
    }


def test_the_source_distribution_holds_the_whole_project(source, tmp_path):
    with tarfile.open(_build("build_sdist", source, tmp_path)) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {path.relative_to(ROOT).as_posix() for path in _project_files()} <= names


def test_every_file_of_a_room_is_of_a_kind_that_is_installed():
    kinds = {path.suffix for room in ROOMS for path in (ROOT / room).rglob("*") if path.is_file()}
    assert kinds <= {".py", ".pyc", *PAGE_SUFFIXES}


def test_metadata_describe_the_project_and_its_requirements(wheel):
    metadata = HeaderParser().parsestr(wheel.info("METADATA"))
    assert (metadata["Name"], metadata["Version"]) == ("moseg", PROJECT["version"])
    assert metadata["License-Expression"] == "MIT"
    assert metadata["Requires-Python"] == PROJECT["requires-python"]
    required = {re.split(r"[<>=]", need)[0] for need in metadata.get_all("Requires-Dist") if "extra ==" not in need}
    assert required == {re.split(r"[<>=]", need)[0] for need in PROJECT["dependencies"]}
    assert {"cluster", "models", "test", "view"} == set(metadata.get_all("Provides-Extra"))
    assert "moseg = moseg.workflows.cli:main" in wheel.info("entry_points.txt")
    assert wheel.info("licenses/LICENSE") == (ROOT / "LICENSE").read_text(encoding="utf-8")


def test_the_wheel_runs_without_the_checkout(wheel, squares, tmp_path):
    run = "import sys; from moseg.workflows.cli import main; main(sys.argv[1:])"
    # Only the unpacked wheel and its dependencies are on the path, not the checkout.
    environ = {"PATH": os.environ["PATH"], "HOME": str(tmp_path), "PYTHONPATH": str(wheel.folder)}
    where = "import moseg, moseg.schemas, moseg.workflows; print(moseg.__file__, moseg.schemas.__file__)"

    def python(code: str, *arguments: object) -> str:
        command = [sys.executable, "-P", "-c", code, *map(str, arguments)]
        ran = subprocess.run(command, cwd=tmp_path, env=environ, capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stderr
        return ran.stdout

    assert python(where).count(str(wheel.folder)) == 2
    assert "segment" in python(run, "--help")
    assert python(run, "--version").strip() == f"moseg {PROJECT['version']}"
    python(run, "segment", squares / "squares" / "frames", "--set", "sections.length=4", "--set", "sections.overlap=2")
    assert len(list((tmp_path / "out" / "masks").iterdir())) == 10


@pytest.mark.parametrize("is_installed", [True, False])
def test_a_script_imports_moseg_beside_modules_of_any_name(wheel, tmp_path, is_installed):
    (tmp_path / "store").mkdir()
    for name in ("schemas.py", "workflows.py", "moseg_tasks.py", "tasks.py", "store/__init__.py"):
        (tmp_path / name).write_text("raise ImportError('the user's own')\n")
    script = tmp_path / "script.py"
    script.write_text("import moseg\nprint(moseg.segment_video, moseg.evaluate, moseg.load_config().flow.method)\n")
    path = wheel.folder if is_installed else ROOT / EDITOR
    environ = {"PATH": os.environ["PATH"], "HOME": str(tmp_path), "PYTHONPATH": str(path)}
    ran = subprocess.run(
        [sys.executable, script], cwd=tmp_path, env=environ, capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.endswith(" dis\n")


def test_installed_code_and_the_checkout_have_the_same_fingerprint(wheel, source):
    code = "from moseg.workflows.cluster.process_facts import code_fingerprint; print(code_fingerprint())"
    found = set()
    for folder in (wheel.folder, source / EDITOR):
        environ = {"PATH": os.environ["PATH"], "PYTHONPATH": str(folder)}
        command = [sys.executable, "-P", "-c", code]
        found.add(subprocess.run(command, env=environ, capture_output=True, text=True, check=True).stdout)
    assert len(found) == 1


def test_every_requirement_has_a_pinned_version():
    pinned = {
        _canonical(line.partition("==")[0])
        for line in (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
        if "==" in line
    }
    needed = [
        *PROJECT["dependencies"],
        *(need for extra in PROJECT["optional-dependencies"].values() for need in extra),
    ]
    assert {_canonical(re.split(r"[<>=]", need)[0]) for need in needed} - pinned == set()


def _canonical(name: str) -> str:
    """Return a project's name as package indexes compare it (PEP 503)."""
    return re.sub(r"[-_.]+", "-", name).lower()


def test_the_citation_file_has_this_version_and_names_the_paper():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= set(citation)
    assert (citation["version"], citation["license"]) == (PROJECT["version"], PROJECT["license"])
    (paper,) = citation["references"]
    assert paper["title"].startswith("Zero-Shot Monocular Motion Segmentation in the Wild")
    assert [author["family-names"] for author in paper["authors"]] == ["Huang", "Chen", "Zelek"]


def test_the_changelog_has_an_entry_for_this_version():
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    versions = re.findall(r"^## \[(.+?)\](?: - (\d{4}-\d{2}-\d{2}))?$", text, re.MULTILINE)
    released = [version for version, date in versions if date]
    assert released[0] == PROJECT["version"]
    assert [version for version, date in versions if not date] in ([], ["Unreleased"])
