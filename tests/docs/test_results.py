"""The figures on the pages are those of the measurements, and every measurement can be repeated."""

import importlib
import json
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import pytest
from typer.exceptions import TyperException

from moseg.schemas.errors import InputError

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "results"
SCORE = {"P": 90.0, "R": 80.0, "F": 70.0, "J": 60.0}


@dataclass(frozen=True)
class Tools:
    """Scripts of docs/tools, which import each other by name."""

    figures: ModuleType
    measurements: ModuleType
    rerun: ModuleType
    tables: ModuleType
    write: ModuleType


@pytest.fixture(scope="module")
def tools():
    sys.path.insert(0, str(ROOT / "docs" / "tools"))
    names = ("figures", "measurements", "rerun", "result_tables", "write_results")
    yield Tools(*(importlib.import_module(name) for name in names))
    sys.path.remove(str(ROOT / "docs" / "tools"))


@pytest.fixture
def folder(tmp_path):
    """Return a folder of results with a single measurement, of two sequences."""
    sequences = {"dog": {**SCORE, "J": 50.0}, "cows": {**SCORE, "J": 70.0}}
    groups = {"two animals": {"J": 55.0, "num_sequences": 2}}
    rows = [{"variant": "fused", "sequences": sequences, "mean": SCORE, "groups": groups}]
    said = {"name": "davis-default", "seconds": 58.3, "result": {"dataset": "davis16", "rows": rows}}
    (tmp_path / "davis-default.json").write_text(json.dumps(said), encoding="utf-8")
    return tmp_path


def test_the_pages_show_the_measured_figures(tools):
    figures = tools.figures.Figures()
    for page in tools.figures.PAGES:
        text = page.read_text(encoding="utf-8")
        assert tools.figures.written(text, figures) == text, f"{page.name}: `make results` writes it anew"
        assert "<!--=" in text or "<!--table " in text


def test_a_number_that_is_edited_by_hand_is_noticed(tools):
    figures = tools.figures.Figures()
    for page in tools.figures.PAGES:
        text = page.read_text(encoding="utf-8")
        marked = re.finditer(r"-->(\d+\.\d+|\d+)<!--/-->", text)
        rows = re.finditer(r"<!--table \S+-->\n(?:(?!<!--/).)*?\| (\d+\.\d+)", text, re.DOTALL)
        for found in (*marked, *rows):
            edited = text[: found.start(1)] + "12.34" + text[found.end(1) :]
            assert tools.figures.written(edited, figures) == text


def test_a_measurement_that_changes_is_noticed(tools, folder):
    text = "<!--=davis-default/fused/J-->?<!--/-->"
    before = tools.figures.written(text, tools.figures.Figures(folder))
    path = folder / "davis-default.json"
    path.write_text(path.read_text(encoding="utf-8").replace('"J": 60.0', '"J": 61.0'), encoding="utf-8")
    after = tools.figures.written(before, tools.figures.Figures(folder))
    assert (before, after) == (text.replace("?", "60.0"), text.replace("?", "61.0"))


@pytest.mark.parametrize(
    ("expression", "text"),
    [
        ("davis-default/fused/F", "70.0"),
        ("davis-default/fused/J@dog", "50.0"),
        ("davis-default/fused/J@two animals", "55.0"),
        ("davis-default/fused/num_sequences@two animals:d", "2"),
        ("davis-default/fused/J#least", "50.0"),
        ("davis-default/fused/J#lowest", "`dog` 50.0, `cows` 70.0"),
        ("davis-default/fused/J:.0f", "60"),
        ("davis-default/sequences:d", "2"),
        ("davis-default/seconds_a_frame:.2f", "0.10"),
        ("davis-best/fused/J", "–"),
    ],
)
def test_a_figure_is_found_and_printed_as_asked(tools, folder, expression, text):
    assert tools.figures.Figures(folder).text(expression) == text


@pytest.mark.parametrize(
    "text",
    [
        "<!--=davis-defualt/fused/J-->1<!--/-->",
        "<!--=davis-default/fussed/J-->1<!--/-->",
        "<!--=davis-default/fused/J@camel-->1<!--/-->",
        "<!--table davsi-->\n<!--/table-->",
    ],
)
def test_a_figure_that_does_not_exist_is_an_error(tools, folder, text):
    with pytest.raises(LookupError, match="no "):
        tools.figures.written(text, tools.figures.Figures(folder))


def test_every_table_is_on_a_page_once(tools):
    text = "".join(page.read_text(encoding="utf-8") for page in tools.figures.PAGES)
    assert sorted(re.findall(r"<!--table (\S+)-->", text)) == sorted(tools.tables.TABLES)


def test_statements_about_the_papers_geometry_follow_from_the_files(tools):
    def lead(name):
        """Return the Fu of fused minus that of the best single view."""
        said = json.loads((RESULTS / f"{name}.json").read_text(encoding="utf-8"))
        scores = {row["variant"]: row["mean"]["F"] for row in said["result"]["rows"]}
        return scores["fused"] - max(scores[view] for view in ("oc-depth", "oc", "trajs"))

    leads = {(reading, t): lead(f"exact-paper-{reading}-{t}") for reading in ("models", "objects") for t in (1, 2, 3)}
    assert {choice for choice, value in leads.items() if value > 0.05} == {
        ("models", 2),
        ("models", 3),
        ("objects", 2),
    }
    assert {choice for choice, value in leads.items() if value < -0.05} == {("models", 1), ("objects", 1)}
    settings = ("exact-residual-auto", "exact-residual-gt", "oracle-depth-residual-auto", "oracle-residual-auto")
    assert all(lead(name) >= -0.05 for name in (*settings, "synthetic-residual-auto"))


def test_no_score_on_the_page_of_results_is_written_by_hand(tools):
    text = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    text = re.sub(r"<!--table .*?<!--/table-->|<!--=\S+-->.*?<!--/-->|`[^`]+`", "", text, flags=re.DOTALL)
    assert re.findall(r"\d+\.\d+", text) == []


def test_every_command_of_a_measurement_is_valid(tools):
    for measurement in tools.measurements.CATALOGUE:
        words = measurement.command.split()
        if words[0] == "moseg":
            assert tools.rerun.parameters(measurement)
        else:
            assert words[0] == "python" and (ROOT / words[1]).is_file()


@pytest.mark.parametrize(
    "command", ["moseg evaluate", "moseg eval --data-set davis16", "moseg eval --set affinity.ork_treshold=2"]
)
def test_an_invalid_command_is_noticed(tools, command):
    with pytest.raises((TyperException, InputError)):
        tools.rerun.parameters(tools.measurements.Measurement("wrong", command, None))


def test_every_file_belongs_to_a_measurement_with_its_current_command(tools):
    commands = {measurement.name: measurement.command for measurement in tools.measurements.CATALOGUE}
    for path in RESULTS.glob("*.json"):
        said = json.loads(path.read_text(encoding="utf-8"))
        assert commands[path.stem] == said["command"], f"{path.name}: `make results RERUN={path.stem}` measures it anew"
        assert said["name"] == path.stem and said["seconds"] > 0
    for path in (RESULTS / "apart").glob("*.json"):
        assert json.loads(path.read_text(encoding="utf-8"))["provenance"] in ("measured apart", "as published")


def test_files_name_no_machine(tools):
    for path in RESULTS.rglob("*.json"):
        assert re.findall(r'["=: ](?:/|~|[A-Z]:\\)[^"]*', path.read_text(encoding="utf-8")) == []


def test_data_folders_replace_their_placeholders(tools):
    (measurement,) = tools.measurements.chosen("davis-default")
    words = tools.rerun.arguments(measurement, {"davis": "/data/DAVIS of mine"})
    assert words[words.index("--root") + 1] == "/data/DAVIS of mine"
    assert "DAVIS" in measurement.command


def test_of_a_row_the_scores_that_pages_show_are_kept(tools):
    score, groups = {"error": 2.0, "num_motions": 3}, {"two motions": {"error": 1.0}}
    seeds = [{"seed": 0, "sequences": {"cars": {**score, "seconds": 1.0}}, "mean": score}]
    row = {"sequences": {"cars": {**score, "seconds": 1.0}}, "mean": score, "spread": 0.1, "groups": groups}
    found = tools.rerun.kept({**row, "seeds": seeds})
    assert found == {**row, "sequences": {"cars": score}, "seeds": [{"seed": 0, "mean": score}]}


def test_measurements_are_chosen_by_name_and_pattern_in_their_order(tools):
    names = [m.name for m in tools.measurements.chosen("davis-default,exact-residual-*")]
    assert names == ["exact-residual-auto", "exact-residual-gt", "davis-default"]
    assert tools.measurements.chosen("all") == list(tools.measurements.CATALOGUE)
    with pytest.raises(LookupError, match="davis-defualt"):
        tools.measurements.chosen("davis-default,davis-defualt")


def test_a_rerun_writes_the_file_and_names_measurements_without_data(tools, squares, tmp_path, monkeypatch, capsys):
    command = f"moseg eval --dataset folder --root '{squares}' --motions gt"
    small = tools.measurements.Measurement("small", command, None)
    large = tools.measurements.Measurement("large", "moseg eval --dataset davis16 --root DAVIS", "davis")
    monkeypatch.setattr(tools.rerun, "RESULTS", tmp_path)
    assert tools.write._rerun([small, large], {}, tmp_path / "store") == []
    said = json.loads((tmp_path / "small.json").read_text(encoding="utf-8"))
    assert said["command"] == small.command and said["parameters"]["clustering"]["motions"] == "gt"
    (row,) = said["result"]["rows"]
    assert row["mean"] == row["sequences"]["squares"] and set(row["mean"]) == set(SCORE)
    assert "large: left as it is, DAVIS is not given" in capsys.readouterr().out
    assert not (tmp_path / "large.json").exists()
