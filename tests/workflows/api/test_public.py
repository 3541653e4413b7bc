"""The package `moseg`: what it offers is there, and importing it costs nothing."""

import subprocess
import sys
import tomllib
from operator import attrgetter
from pathlib import Path

import pytest

import moseg

ROOT = Path(__file__).resolve().parents[3]


def test_everything_it_offers_is_there():
    for name in moseg.__all__:
        assert getattr(moseg, name) is not None
    assert set(moseg.__all__) <= set(dir(moseg))
    assert sorted(moseg.__all__) == moseg.__all__
    with pytest.raises(AttributeError, match="segment_videos"):
        attrgetter("segment_videos")(moseg)


def test_everything_has_a_docstring():
    undocumented = [name for name in moseg.__all__ if name != "__version__" and not getattr(moseg, name).__doc__]
    assert undocumented == []


def test_importing_it_imports_nothing_else():
    code = "import sys, moseg; print([name for name in ('numpy', 'cv2', 'workflows') if name in sys.modules])"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "[]"


def test_the_version_is_that_of_the_project():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert moseg.__version__ == project["version"]
