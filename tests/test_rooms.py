"""Imports between the top-level packages run one way, and no code runs data as code."""

import ast
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {
    "schemas": "moseg.schemas",
    "store": "moseg.store",
    "moseg_tasks": "moseg.tasks",
    "workflows": "moseg.workflows",
}
"""Folders of the packages, and the names under which they are imported."""
ROOMS = tuple(PACKAGES)
SCIENCE = {
    "PIL",
    "cv2",
    "google",  # protobuf, whose errors onnx raises
    "kmedoids",
    "numpy",
    "onnx",
    "poselib",
    "pydantic",
    "scipy",
    "sklearn",
    "torch",
    "transformers",
}
OUTSIDE_WORLD = {
    "glob",
    "http",
    "io",
    "os",
    "pathlib",
    "random",
    "shutil",
    "socket",
    "subprocess",
    "tempfile",
    "urllib",
}


class Rule(NamedTuple):
    """Allowed imports of a package: other packages, libraries, and the standard library except `no_stdlib`."""

    rooms: set[str]
    libraries: set[str]
    no_stdlib: set[str] = frozenset()


RULES = {
    "schemas": Rule(set(), {"numpy", "pydantic", "pydantic_core"}),
    "store": Rule({"schemas"}, {"botocore", "google_crc32c", "numcodecs", "numpy", "obstore", "pydantic", "zarr"}),
    "moseg_tasks": Rule({"schemas"}, SCIENCE, OUTSIDE_WORLD),
    "workflows": Rule(
        {"schemas", "store", "moseg_tasks"},
        SCIENCE
        | {
            "av",
            "dask",
            "distributed",
            "filelock",
            "jinja2",
            "psutil",
            "pycocotools",
            "rich",
            "safetensors",
            "starlette",
            "threadpoolctl",
            "typer",
            "uvicorn",
            "yaml",
        },
    ),
}


def _imports(tree: ast.AST) -> set[str]:
    """Return the packages that a module imports anywhere in its code: rooms of ours, else top-level packages.

    Relative imports count as imports of their own room.
    """
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {_package(alias.name) for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names = [f"moseg.{alias.name}" for alias in node.names] if node.module == "moseg" else [node.module]
            found |= {_package(name) for name in names}
    return found


def _package(module: str) -> str:
    """Return the room of a module of ours, else its top-level package."""
    first, _, rest = module.partition(".")
    return f"moseg.{rest.partition('.')[0]}" if first == "moseg" else first


def _forbidden_imports(room: str, source: str) -> set[str]:
    rule = RULES[room]
    allowed = (
        {PACKAGES[room]}
        | {PACKAGES[other] for other in rule.rooms}
        | rule.libraries
        | (sys.stdlib_module_names - rule.no_stdlib)
    )
    return _imports(ast.parse(source)) - allowed


def _code_from_data(source: str) -> list[str]:
    """Return calls that can run their data: ``eval``, ``exec``, pickles, NumPy or torch files that may hold pickles."""
    tree = ast.parse(source)
    pickles = {"cloudpickle", "dill", "joblib", "marshal", "pickle", "shelve"}
    found = sorted(_imports(tree) & pickles)
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = ast.unparse(node.func)
        words = {word.arg: word.value for word in node.keywords}
        pickled, weights_only = words.get("allow_pickle"), words.get("weights_only")
        is_weights_only = isinstance(weights_only, ast.Constant) and weights_only.value is True
        is_pickled = pickled is not None and not (isinstance(pickled, ast.Constant) and pickled.value is False)
        if (
            name in ("eval", "exec", "compile", "__import__")
            or is_pickled
            or (name.endswith("torch.load") and not is_weights_only)
        ):
            found.append(f"{name} in line {node.lineno}")
    return found


def _opens_files(source: str) -> list[int]:
    calls = (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call))
    files = {"open", "cv2.imread", "cv2.imwrite", "cv2.VideoCapture", "np.load", "np.save", "np.savez", "np.fromfile"}
    return [call.lineno for call in calls if ast.unparse(call.func) in files]


def _sources(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_imports_only_what_it_may(room):
    found = {path.relative_to(ROOT).as_posix(): _forbidden_imports(room, path.read_text()) for path in _sources(room)}
    assert found, f"no source below {room}/"
    assert {name: imports for name, imports in found.items() if imports} == {}


def test_science_opens_no_files():
    found = {path.relative_to(ROOT).as_posix(): _opens_files(path.read_text()) for path in _sources("moseg_tasks")}
    assert {name: lines for name, lines in found.items() if lines} == {}


def test_no_code_runs_the_data_it_reads():
    # These benchmarks compare the store with joblib, which pickles.
    sources = set(_sources(*ROOMS, "benchmarks")) - {ROOT / "benchmarks/joblib_memory.py"}
    found = {path.relative_to(ROOT).as_posix(): _code_from_data(path.read_text()) for path in sources}
    assert {name: calls for name, calls in found.items() if calls} == {}


@pytest.mark.parametrize(
    ("room", "source"),
    [
        ("schemas", "import moseg.store"),
        ("schemas", "def f():\n    from zarr import open_group"),
        ("store", "import moseg.tasks.flow"),
        ("store", "from dask import delayed"),
        ("store", "import cv2"),
        ("moseg_tasks", "from pathlib import Path"),
        ("moseg_tasks", "import os.path"),
        ("moseg_tasks", "from moseg.workflows.sources.resize import resize_labels"),
        ("moseg_tasks", "import distributed"),
        ("moseg_tasks", "import moseg"),
        ("schemas", "from moseg import store"),
        ("workflows", "import schemas"),
        ("workflows", "import zarr"),
    ],
)
def test_a_forbidden_import_is_noticed(room, source):
    assert _forbidden_imports(room, source)


@pytest.mark.parametrize(
    "source",
    [
        "eval(x)",
        "exec(x)",
        "import pickle",
        "torch.load(p)",
        "torch.load(p, weights_only=False)",
        "np.load(p, allow_pickle=True)",
        "np.load(p, allow_pickle=a)",
    ],
)
def test_code_that_runs_data_is_noticed(source):
    assert _code_from_data(source)
    assert not _code_from_data("torch.load(p, weights_only=True)")
    assert not _code_from_data("model.eval()\nnp.load(p, allow_pickle=False)\nre.compile(x)")
