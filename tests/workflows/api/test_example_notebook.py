"""The notebook of the documentation is valid and has no outputs, and its cells run in order in a notebook's kernel."""

import zipfile
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).resolve().parents[3] / "docs" / "examples" / "segment_video.ipynb"
SECONDS = 600
"""Longest time of one cell."""


def _read():
    return nbformat.read(NOTEBOOK, as_version=4)


@pytest.fixture(scope="module")
def executed(tmp_path_factory):
    """Return the folder in which the notebook was executed, and its cells with their outputs, by name."""
    folder = tmp_path_factory.mktemp("notebook")
    notebook = _read()
    NotebookClient(notebook, timeout=SECONDS, resources={"metadata": {"path": str(folder)}}).execute()
    return folder, {cell["id"]: cell["outputs"] for cell in notebook.cells if cell.cell_type == "code"}


def _printed(outputs, name="stdout"):
    return "".join(each["text"] for each in outputs if (each["output_type"], each.get("name")) == ("stream", name))


def test_the_notebook_is_valid_and_holds_no_outputs():
    notebook = _read()
    nbformat.validate(notebook)
    assert (notebook.nbformat, notebook.metadata.kernelspec.name) == (4, "python3")
    assert all(cell.outputs == [] and cell.execution_count is None for cell in notebook.cells if "outputs" in cell)


def test_results_are_shown_as_a_page_and_a_picture(executed):
    _, outputs = executed
    (result,) = (each for each in outputs["segment"] if each["output_type"] == "execute_result")
    assert "<table" in result["data"]["text/html"]
    (picture,) = outputs["look"]
    assert "image/png" in picture["data"]
    assert "object 1: frames 0 to" in _printed(outputs["objects"]) and "uint16" in _printed(outputs["labels"])


def test_progress_is_one_bar_that_goes_when_the_work_is_done(executed):
    _, outputs = executed
    shown = [each["data"]["text/html"] for each in outputs["segment"] if each["output_type"] == "display_data"]
    (notice,) = (text for text in shown if text)
    assert "moseg status" in notice and len(shown) > 1
    assert _printed(outputs["segment"], "stderr") == ""


def test_results_are_saved(executed):
    folder, _ = executed
    results = folder / "moseg_results"
    with zipfile.ZipFile(results / "out.zip") as archive:
        names = archive.namelist()
    assert {"motion.json", "overlay.mp4", "masks/00009.png"} <= set(names)
    assert (results / "report.html").stat().st_size > 100_000
