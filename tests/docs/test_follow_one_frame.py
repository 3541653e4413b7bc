"""Every function and file that "Follow one frame" names is there."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TEXT = " ".join((ROOT / "docs" / "follow_one_frame.md").read_text(encoding="utf-8").split())
NAMED = re.findall(r"`(\w+)` in `([\w/]+\.py)`", TEXT)


def test_there_are_ten_stops():
    assert re.findall(r"(?<= )(\d+)\. \*\*", TEXT) == [str(number) for number in range(1, 11)]
    assert len(NAMED) > 20


@pytest.mark.parametrize(("name", "path"), NAMED)
def test_a_name_is_defined_in_its_file(name, path):
    found = set()
    for node in ast.parse((ROOT / path).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Assign):
            found |= {target.id for target in node.targets if isinstance(target, ast.Name)}
    assert name in found


def test_every_path_exists():
    for path in re.findall(r"`([\w]+/[\w/]*(?:\.py)?)`", TEXT):
        assert (ROOT / path).exists(), path
