"""The pictures of the documents are small, are all shown, and can be drawn again."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
IMAGES = sorted((ROOT / "docs" / "images").iterdir())
MOST_BYTES = 250_000


@pytest.fixture(scope="module")
def make_pictures():
    """Return the script that draws them."""
    sys.path.insert(0, str(ROOT / "docs" / "tools"))
    yield importlib.import_module("make_pictures")
    sys.path.remove(str(ROOT / "docs" / "tools"))


@pytest.mark.parametrize("path", IMAGES, ids=lambda path: path.name)
def test_a_picture_is_small_and_shown_with_alternative_text(path):
    assert path.stat().st_size < MOST_BYTES
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    shown = [part for page in pages for part in page.read_text(encoding="utf-8").split("![")[1:]]
    (text,) = [
        part.split("](")[0] for part in shown if part.split("](")[1].split(")")[0].endswith(f"images/{path.name}")
    ]
    assert len(text.split()) > 5


def test_a_matrix_is_light_at_zero_dark_at_one_and_leaves_unknown_values_light(make_pictures):
    matrix = make_pictures._matrix(np.array([[1.0, 0.0], [0.0, np.nan]]), 96)
    assert matrix.shape == (96, 96, 3)
    dark, light = matrix[20, 20].mean(), matrix[20, 60].mean()
    assert dark < 100 < 240 < light
    assert matrix[60, 60].mean() > 240


def test_rows_of_panels_become_one_sheet(make_pictures):
    panel = np.full((60, 100, 3), 90, np.uint8)
    rows = {name: [make_pictures.Column("frame", panel), make_pictures.Column("flow", panel)] for name in ("a", "b")}
    sheet = make_pictures._compose(rows)
    assert sheet.width > 2 * make_pictures.WIDTH and sheet.height > 2 * 60
