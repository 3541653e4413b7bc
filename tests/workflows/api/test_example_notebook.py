"""The notebook of the documentation is valid, has no outputs, and its cells run in order in one process."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

NOTEBOOK = Path(__file__).resolve().parents[3] / "docs" / "examples" / "segment_video.ipynb"
RUN = """
import ast, json, sys

names = {"__name__": "__main__"}
for cell in json.load(sys.stdin)["cells"]:
    if cell["cell_type"] != "code":
        continue
    tree = ast.parse("".join(cell["source"]))
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, cell["id"], "exec"), names)
    if last is not None:
        # As a notebook: the value of the last expression is shown, as a page or picture where it has one.
        value = eval(compile(ast.Expression(last.value), cell["id"], "eval"), names)
        shown = [getattr(value, name)() for name in ("_repr_html_", "_repr_png_") if hasattr(value, name)]
        print(cell["id"], "shows", len(shown[0]) if shown else repr(value))
"""


def _read() -> dict:
    return json.loads(NOTEBOOK.read_text(encoding="utf-8"))


def test_the_notebook_is_valid_and_holds_no_outputs():
    notebook = _read()
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    assert notebook["metadata"]["kernelspec"]["name"] == "python3"
    names = [cell["id"] for cell in notebook["cells"]]
    assert len(set(names)) == len(names)
    for cell in notebook["cells"]:
        assert cell["cell_type"] in ("markdown", "code") and all(isinstance(line, str) for line in cell["source"])
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None


def test_the_cells_run_in_order(tmp_path):
    command = [sys.executable, "-W", "error", "-c", RUN]
    text = NOTEBOOK.read_text(encoding="utf-8")
    ran = subprocess.run(command, cwd=tmp_path, input=text, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert "segment shows" in ran.stdout and "look shows" in ran.stdout
    assert "object 1: frames 0 to" in ran.stdout and "uint16" in ran.stdout
    results = tmp_path / "moseg_results"
    with zipfile.ZipFile(results / "out.zip") as archive:
        names = archive.namelist()
    assert {"motion.json", "overlay.mp4", "masks/00009.png"} <= set(names)
    assert (results / "report.html").stat().st_size > 100_000
