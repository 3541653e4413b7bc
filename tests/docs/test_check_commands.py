"""`make docs-check` runs the commands of the documents, reports failures, and skips none without a reason."""

import importlib
import re
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).resolve().parents[2] / "docs" / "tools"


@pytest.fixture(scope="module")
def checks():
    """Return the script; scripts of docs/tools import each other by name."""
    sys.path.insert(0, str(TOOLS))
    yield importlib.import_module("check_commands")
    sys.path.remove(str(TOOLS))


@pytest.fixture
def document(checks, tmp_path, monkeypatch):
    """Return a function that checks a document of the given text and returns the line printed for each command."""

    def document(text: str) -> list:
        monkeypatch.setattr(checks, "ROOT", tmp_path)
        monkeypatch.setattr(checks, "BIN", Path(sys.executable).parent)
        (tmp_path / "inputs" / "data").mkdir(parents=True)
        (tmp_path / "inputs" / "store" / "objects" / "score" / "ab" / "abcdef0123").mkdir(parents=True)
        page = tmp_path / "page.md"
        page.write_text(text, encoding="utf-8")
        codes = checks.shown_commands(text)
        return checks.check_document(page, codes, tmp_path, checks.Services(tmp_path / "services"))

    return document


def test_a_working_command_is_ok_and_a_failing_one_shows_its_error(document, capsys):
    good, bad = document("    moseg datasets show synthetic\n    moseg datasets show sintetic\n")
    assert (good.verdict, bad.verdict) == ("ok", "FAIL")
    assert "exit code 2" in bad.reason and "sintetic" in bad.reason
    assert re.search(r"^FAIL .*page\.md: moseg datasets show sintetic$", capsys.readouterr().out, re.MULTILINE)


def test_a_command_that_is_not_run_is_listed_with_the_reason(document, capsys):
    named, fetched = document("`moseg score` and `moseg weights fetch raft-large`")
    assert (named.verdict, fetched.verdict) == ("not run", "not run")
    assert "needs arguments" in named.reason and "gigabytes" in fetched.reason
    assert capsys.readouterr().out.count("not run") == 2


def test_every_reason_not_to_run_a_command_matches_a_shown_command(checks):
    shown = [
        checks.without_variables(code)
        for path in checks.DOCUMENTS
        for code in checks.shown_commands(path.read_text(encoding="utf-8"))
    ]
    stale = [pattern for pattern, _ in checks.NOT_RUN if not any(re.search(pattern, code) for code in shown)]
    assert stale == []


@pytest.mark.parametrize(
    ("command", "is_mention"),
    [
        ("moseg score", True),
        ("moseg store", True),
        ("moseg store push", True),
        ("moseg segment", True),
        ("moseg datasets", False),
        ("moseg store du", False),
        ("moseg eval", False),
        ("moseg segment holiday.mp4", False),
        ("make test", False),
    ],
)
def test_only_a_name_without_its_arguments_is_a_mention(checks, command, is_mention):
    assert checks.is_mention(command) == is_mention


def test_a_run_on_all_rendered_scenes_is_shortened_and_no_other(checks):
    assert checks.shorten(["moseg", "eval"])[-2:] == ["--sequences", "two-motions"]
    assert checks.shorten(["moseg", "eval", "--dataset", "still"])[-2:] == ["--sequences", checks.STILL]
    assert "ARGS=--sequences two-motions" in checks.shorten(["make", "eval"])
    assert f"ARGS=--sequences {checks.STILL}" in checks.shorten(["make", "eval", "DATASET=still"])
    assert not [word for word in checks.shorten(["make", "eval", "DATASET=davis16"]) if word.startswith("ARGS")]
    for command in ("moseg eval --dataset davis16", "moseg eval --sequences zoom", "moseg status"):
        assert checks.shorten(command.split()) == command.split()


def test_variables_of_a_command_are_set_for_it_and_are_not_part_of_it(checks):
    (code,) = checks.shown_commands("    MOSEG_DATA=/data moseg datasets\n")
    assert checks.variables(code) == {"MOSEG_DATA": "/data"}
    assert checks.without_variables(code) == "moseg datasets"


@pytest.mark.parametrize(("shown", "num_linked"), [("moseg datasets", 1), ("moseg status latest", 0)])
def test_a_document_reads_what_another_computed_unless_it_shows_runs(shown, num_linked, checks, tmp_path, monkeypatch):
    found = []
    monkeypatch.setattr(checks, "ROOT", tmp_path)
    (tmp_path / "inputs" / "data").mkdir(parents=True)
    (tmp_path / "inputs" / "store" / "objects" / "score" / "ab" / "abcdef0123").mkdir(parents=True)
    (tmp_path / "computed" / "flow" / "cd" / "cdef").mkdir(parents=True)

    def check(name, code, own, values, services):
        found.extend((own / ".moseg" / "store" / "objects").glob("flow/*/*"))
        (own / ".moseg" / "store" / "objects" / "depth" / "01" / "0123").mkdir(parents=True)
        return checks.Check(name, code, "ok")

    monkeypatch.setattr(checks, "_check", check)
    checks.check_document(tmp_path / "page.md", [shown], tmp_path, None)
    assert len(found) == num_linked
    assert (tmp_path / "computed" / "depth" / "01" / "0123").is_dir()
