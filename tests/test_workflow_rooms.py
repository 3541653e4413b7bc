"""Imports between the packages of `workflows/` run one way, and no module is directly in `workflows/`."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1] / "workflows"
FRONT = ("api", "moseg")
"""Folder of the package `moseg`, which contains the rooms."""
ALLOWED = {
    "cli": {
        *("api", "config", "datasets", "exports", "plugins", "process", "reports", "runlog", "stages", "view"),
        "weights",
    },
    "view": {
        *("api", "config", "datasets", "exports", "graph", "pipelines", "process", "reports", "results"),
        *("runlog", "sources", "stages", "weights"),
    },
    "api": {
        *("cluster", "config", "datasets", "engine", "exports", "pipelines", "predictions", "process", "reports"),
        *("plugins", "runlog", "sources", "training", "weights"),
    },
    "pipelines": {
        *("datasets", "engine", "exports", "graph", "predictions", "process", "reports", "results", "runlog"),
        *("sources", "stages", "weights"),
    },
    "training": {"exports", "process", "sources"},
    "reports": {"config", "engine", "exports", "graph", "process", "results", "runlog", "sources"},
    "results": {"exports", "graph", "sources"},
    "exports": {"config", "process", "runlog", "sources"},
    "engine": {"cluster", "datasets", "process", "runlog", "stages", "weights"},
    "graph": {"stages"},
    "stages": {"process", "sources", "weights"},
    "cluster": {"plugins", "process", "weights"},
    "plugins": {"datasets", "exports", "stages"},
    "weights": {"process"},
    "datasets": {"sources"},
    "predictions": {"sources"},
    "config": set(),
    "process": set(),
    "runlog": {"process"},
    "sources": set(),
}
"""Rooms that each room imports, from the front to the back; docs/design.md draws them."""


def _imported_rooms(source: str) -> set[str]:
    """Return the rooms that a module imports anywhere in its code."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return {name.split(".")[2] for name in found if name.startswith("moseg.workflows.")}


def _modules() -> list[Path]:
    return [path for path in sorted(ROOT.rglob("*.py")) if path.relative_to(ROOT).parts[:2] != FRONT]


def test_no_module_is_directly_in_workflows():
    assert [path.name for path in ROOT.glob("*.py")] == ["__init__.py"]
    assert {path.relative_to(ROOT).parts[0] for path in _modules()} == {"__init__.py", *ALLOWED}


@pytest.mark.parametrize("room", ALLOWED)
def test_a_room_imports_exactly_the_allowed_rooms(room):
    found = set()
    for path in _modules():
        if path.relative_to(ROOT).parts[0] == room:
            found |= _imported_rooms(path.read_text(encoding="utf-8")) - {room}
    assert found == ALLOWED[room]


def test_no_room_leads_back_to_itself():
    assert set(TopologicalSorter(ALLOWED).static_order()) == set(ALLOWED)


@pytest.mark.parametrize(
    "source",
    [
        "from moseg.workflows.engine.session import Session",
        "from moseg.workflows import engine",
        "def f():\n    import moseg.workflows.engine.session",
    ],
)
def test_every_form_of_import_is_seen(source):
    assert _imported_rooms(source) == {"engine"}
