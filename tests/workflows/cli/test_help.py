"""Help of every command: examples that work, and lines that fit the terminal."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.core import TyperGroup
from typer.main import get_command

from moseg.workflows.cli.app import app
from moseg.workflows.cli.help_texts import examples_of, with_readable_help
from moseg.workflows.config.parameters import list_parameters
from moseg.workflows.config.pipeline_choices import PARAMETER_OF, SETS_OF

COMMAND = with_readable_help(get_command(app))
_SPEC = importlib.util.spec_from_file_location("documents", Path(__file__).resolve().parents[2] / "test_docs.py")
documents = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(documents)


def _paths(command, path=()):
    yield path
    for name, inner in getattr(command, "commands", {}).items():
        yield from _paths(inner, (*path, name))


def _find(path):
    command = COMMAND
    for name in path:
        command = command.commands[name]
    return command


PATHS = list(_paths(COMMAND))
EXAMPLES = [(path, example) for path in PATHS for example in examples_of(_find(path))]


@pytest.fixture(params=[80, 120])
def columns(request, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(request.param))
    return request.param


@pytest.mark.parametrize("path", PATHS, ids=" ".join)
def test_help_fits_the_terminal_and_ends_with_examples(moseg, columns, path):
    ran = moseg(*path, "--help")
    assert (ran.code, ran.err) == (0, "")
    lines = [line.strip() for line in ran.out.splitlines()]
    assert max(map(len, ran.out.splitlines())) <= columns
    assert "<bool>" not in ran.out
    shown = lines[lines.index("Examples:") + 1 :]
    # Each on a line of its own, not broken.
    assert [line for line in shown if line] == examples_of(_find(path))


@pytest.mark.parametrize(("path", "example"), EXAMPLES, ids=[example for _, example in EXAMPLES])
def test_an_example_is_understood_and_of_its_command(path, example):
    assert example.startswith(" ".join(["moseg", *path]))
    documents.check(example)


def test_every_command_has_examples_and_every_option_an_explanation():
    for path in PATHS:
        command = _find(path)
        assert examples_of(command), " ".join(path)
        assert command.help, " ".join(path)
        for parameter in command.params:
            assert parameter.help, f"{' '.join(path)}: {parameter.name}"


def test_an_option_that_chooses_by_name_shows_the_names_that_there_are_and_the_default():
    options = {name: parameter.help for parameter in _find(("eval",)).params for name in parameter.opts}
    for option, parameter in PARAMETER_OF.items():
        if list_parameters()[parameter].choices:
            assert all(choice in options[option] for choice in list_parameters()[parameter].choices), option
            assert f"(default: {list_parameters()[parameter].default})" in options[option]
    assert "{" not in "".join(options.values())


def test_names_that_are_added_before_the_command_line_is_built_are_shown(monkeypatch):
    monkeypatch.setitem(SETS_OF["--geometry"], "mine", {})
    plan = with_readable_help(get_command(app)).commands["plan"]
    shown = next(parameter for parameter in plan.params if parameter.name == "geometry")
    assert shown.help == "Fits, affinity and clustering: default, paper or mine."
    assert "mine" in [item.value for item in shown.shell_complete(plan.make_context("plan", []), "m")]


def test_long_lists_of_options_stand_under_headings(moseg, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    text = moseg("eval", "--help").out
    headings = re.findall(r"^╭─ (.*?) ─+╮$", text, re.MULTILINE)
    assert headings == [
        "Options",
        "Data",
        "Pipeline",
        "Labelled trajectories (kt3dmoseg, hopkins155, hopkins12, mtpv62)",
        "Run and cluster",
    ]
    # Only a few stand apart.
    options = text[text.index("─ Options") : text.index("─ Data")]
    assert options.count("--") < 12


def test_a_paragraph_is_broken_where_the_terminal_ends(moseg, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    lines = [line.rstrip() for line in moseg("store", "push", "--help").out.splitlines()]
    start = next(i for i, line in enumerate(lines) if line.startswith(" All of them and the pins"))
    paragraph = lines[start : lines.index("", start)]
    assert all(len(line) > 80 for line in paragraph[:-1])


def test_help_of_groups_lists_every_command(moseg):
    for path in PATHS:
        command = _find(path)
        if isinstance(command, TyperGroup):
            text = moseg(*path, "--help").out
            assert all(re.search(rf"^│ {name} ", text, re.MULTILINE) for name in command.commands)


def test_the_version_is_one_line(moseg):
    ran = moseg("--version")
    assert (ran.code, ran.err) == (0, "")
    assert re.fullmatch(r"moseg \d+\.\d+\S*\n", ran.out)


@pytest.mark.parametrize("path", PATHS, ids=" ".join)
def test_the_short_option_shows_the_same_help(moseg, path):
    assert moseg(*path, "-h") == moseg(*path, "--help")


def test_every_output_has_the_short_option_too():
    for path in PATHS:
        options = [parameter.opts for parameter in _find(path).params if "--out" in parameter.opts]
        assert all("-o" in names for names in options), " ".join(path)


def test_the_module_is_the_command(tmp_path):
    command = [sys.executable, "-m", "moseg", "--version"]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert re.fullmatch(r"moseg \d+\.\d+\S*\n", ran.stdout)
