"""The drawing of the graph in the documents shows the stages and the edges of the code."""

import importlib
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def draw_graph():
    """Return the script that draws it; scripts of docs/tools import each other by name."""
    sys.path.insert(0, str(DOCS / "tools"))
    yield importlib.import_module("draw_graph")
    sys.path.remove(str(DOCS / "tools"))


@pytest.mark.parametrize("name", ["graph.svg", "graph_tracks.svg", "graph_cameras.svg", "graph_networks.svg"])
def test_the_stored_drawing_shows_every_stage_and_edge_of_the_code(draw_graph, name):
    changes, title = draw_graph.DRAWINGS[name]
    root = ElementTree.parse(DOCS / "images" / name).getroot()
    edges = {tuple(path.get("data-edge").split()) for path in root.iter(f"{SVG}path") if path.get("data-edge")}
    stages = {group.get("data-stage") for group in root.iter(f"{SVG}g")}
    expected = set(draw_graph.stage_edges(changes))
    again = "draw it again: python docs/tools/draw_graph.py"
    assert edges == expected, again
    assert stages == {stage for edge in expected for stage in edge}, again
    assert root.find(f"{SVG}title").text == title


def test_no_box_of_the_drawing_covers_another(draw_graph):
    root = ElementTree.parse(DOCS / "images" / "graph.svg").getroot()
    width = float(root.get("viewBox").split()[2])
    boxes = [group.find(f"{SVG}rect") for group in root.iter(f"{SVG}g")]
    spots = [(float(box.get("x")), float(box.get("y")), float(box.get("width"))) for box in boxes]
    assert all(x >= 0 and x + w <= width for x, _, w in spots)
    assert not [1 for i, (x, y, w) in enumerate(spots) for x2, y2, _ in spots[:i] if y == y2 and abs(x - x2) < w]
