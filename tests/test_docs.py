"""The commands in the documents are valid, and their links lead to existing pages.

Command lines are the lines of indented blocks and the inline code that begin with `moseg` or `make`. They are parsed by
the real command line and not run; a command without anything behind it is only mentioned. Inline code that begins with
an option counts as given to the first command that has it. Placeholders: `N` is a number, `…` is left out,
`stage.name=value` stands for any parameter, names that begin with `my-` are the user's own; other words in capitals are
parsed literally.
"""

import importlib.util
import os
import re
import shlex
import shutil
import subprocess
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest
from typer.core import TyperGroup
from typer.exceptions import TyperException

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.workflows.cli.app import build_command
from moseg.workflows.cli.pipeline_options import PipelineOptions
from moseg.workflows.config.pipeline_choices import choose_preset
from moseg.workflows.datasets.registry import DATASETS
from moseg.workflows.stages.needed_weights import needed_items
from moseg.workflows.stages.registry import all_tasks
from moseg.workflows.weights.catalogue import CATALOGUE

ROOT = Path(__file__).resolve().parents[1]


def _load(path: Path):
    """Load a script outside of the packages."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


_shown_commands = _load(ROOT / "docs" / "tools" / "shown_commands.py")
DOCUMENTS, shown_code = _shown_commands.DOCUMENTS, _shown_commands.shown_code
TO_BE_UNDERSTOOD = tuple(path for path in DOCUMENTS if path.name != "extending.md")
"""Commands of extending.md need its examples, so that tests/docs/test_extending.py checks them."""
ARCHITECTURE_OF = {item.name: item.architecture for item in CATALOGUE}

_PARAMETER = re.compile(rf"(?:{'|'.join(PipelineConfig.model_fields)})\.[a-z]\w*(?:=\S+)?")
_OPTION = re.compile(r"--[a-z]")
_LINK = re.compile(r"\]\((?!\w+:)([^)#]*)(?:#([^)]+))?\)")


class Shown(NamedTuple):
    """Code that a document shows, with the document."""

    document: str
    text: str


def is_for_moseg(code: str) -> bool:
    """Return whether the code is a command line of `moseg`, or options or parameters for it."""
    return code.startswith("moseg ") or _OPTION.match(code) is not None or _PARAMETER.fullmatch(code) is not None


def check(code: str) -> None:
    """Parse a command line, options or a parameter; raises TyperException or InputError if one is invalid."""
    if not code.startswith(("moseg ", "--")):
        name, _, value = code.partition("=")
        if not value:
            stage, _, name = name.partition(".")
            known = getattr(PipelineConfig.model_fields[stage].annotation, "model_fields", {})
            if name not in known:
                raise InputError("unknown parameter", got=code, expected=", ".join(known))
            return
        code = f"--set {code}"
    words = ["1" if word == "N" else word for word in shlex.split(code) if word != "…"]
    own = {name for parameter in build_command().params for name in parameter.opts}
    # The callbacks of `moseg` itself, such as the installation of completion, are not run here.
    if words[-1] == "--help" and len(words) > 1:
        words = words[:-1]
    if words[-1] in own and words in (["moseg", words[-1]], words[-1:]):
        return
    if words[0] != "moseg":
        words = _complete(words)
        if words is None:
            return
    if not any(path[: len(words) - 1] == tuple(words[1:]) for path, _, _ in _commands()):
        _check_parsed(_parse(words[1:]))


def _parse(words: list[str]) -> dict:
    """Return the values of the parameters of a command, by name."""
    command, name, context = build_command(), "moseg", None
    while isinstance(command, TyperGroup):
        context = command.make_context(name, list(words), parent=context)
        name, command, words = command.resolve_command(context, list(words))
    return command.make_context(name, list(words), parent=context).params


def _check_parsed(values: dict) -> None:
    """Raise InputError unless the command itself would accept all values."""
    if "dataset" in values and values["dataset"] not in DATASETS:
        raise InputError("unknown data set", got=values["dataset"])
    for item in values.get("items") or ():
        _check_item(item, ARCHITECTURE_OF.get(item))
    if values.get("preset") is not None:
        choose_preset(values["preset"])
    names = [field.name for field in fields(PipelineOptions)]
    if not values.keys() >= set(names):
        return
    settings = [setting for setting in values["settings"] if setting != "stage.name=value"]
    # A shown file is the user's own.
    own = {"settings": settings, "config_file": None}
    config = PipelineOptions(**{name: values[name] for name in names} | own).choices().read()
    for item, architecture in needed_items(config).items():
        _check_item(item, architecture)
    for network in filter(None, (task.network for task in all_tasks())):
        # The tagger's item may have either architecture.
        if network.parameter != "ram.weights":
            _check_item(network.item(config), network.architecture)


def _check_item(item: str, architecture: str | None) -> None:
    if not item.startswith("my-") and (item not in ARCHITECTURE_OF or ARCHITECTURE_OF[item] != architecture):
        raise InputError("unknown weights item", got=item, expected=architecture)


def _complete(words: list[str]) -> list[str] | None:
    """Return a command line with these options; None if it is only the name of an existing command."""
    asked = {word.partition("=")[0] for word in words if word.startswith("--")}
    for path, options, num_arguments in _commands():
        if asked <= options:
            # The options of detections apply to the proposals of this preset.
            preset = ["--preset", "paper"] if "--geometry" in options else []
            return ["moseg", *path, *preset, *["x"] * num_arguments, *words] if len(words) > 1 else None
    raise InputError("no such option", got=" ".join(sorted(asked)))


@cache
def _commands(command=None, path: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], set[str], int]]:
    """Return words, options and number of required arguments of each command, `eval` before the others."""
    command = command or build_command()
    if isinstance(command, TyperGroup):
        found = [entry for name, inner in command.commands.items() for entry in _commands(inner, (*path, name))]
        return sorted(found, key=lambda entry: entry[0] != ("eval",))
    arguments = [param for param in command.params if param.param_type_name == "argument" and param.required]
    return [(path, {"--help", *(name for param in command.params for name in param.opts)}, len(arguments))]


def _shown(is_meant) -> list[Shown]:
    found = []
    for path in TO_BE_UNDERSTOOD:
        codes = [code for code in shown_code(path.read_text(encoding="utf-8")) if is_meant(code)]
        found += [Shown(path.relative_to(ROOT).as_posix(), code) for code in dict.fromkeys(codes)]
    return found


@pytest.mark.parametrize("shown", _shown(is_for_moseg), ids=lambda shown: f"{shown.document}: {shown.text}")
def test_every_shown_command_of_moseg_is_valid(shown):
    check(shown.text)


@pytest.mark.skipif(shutil.which("make") is None, reason="no make")
@pytest.mark.parametrize(
    "shown", _shown(lambda code: code.startswith("make ")), ids=lambda shown: f"{shown.document}: {shown.text}"
)
def test_every_shown_command_of_make_is_valid(shown):
    lines = dry_run(shown.text)
    if any(f"make {target}" in shown.text for target in ("eval", "ablation", "segment")):
        assert lines
    for line in lines:
        check(line)


def dry_run(code: str) -> list[str]:
    """Return command lines of `moseg` that a command line of make would run; raises InputError if one is invalid."""
    words = shlex.split(code)[1:]
    variables = set(re.findall(r"^([A-Z0-9]+)\s*[?:]?=", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    unknown = {word.partition("=")[0] for word in words if "=" in word} - variables
    if unknown:
        raise InputError("no such variable of make", got=", ".join(unknown))
    # Variables of a make that runs these tests must not be inherited.
    env = {"PATH": os.environ["PATH"]}
    ran = subprocess.run(["make", "--dry-run", *words], cwd=ROOT, env=env, capture_output=True, text=True, check=False)
    if ran.returncode:
        raise InputError("make fails", got=ran.stderr)
    prefix = ".venv/bin/"
    return [line.removeprefix(prefix) for line in ran.stdout.splitlines() if line.startswith(f"{prefix}moseg ")]


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_to_existing_pages_and_headings(path):
    broken = []
    for target, anchor in _LINK.findall(path.read_text(encoding="utf-8")):
        file = (path.parent / target).resolve() if target else path
        if not file.exists() or (anchor and anchor not in _anchors(file)):
            broken.append(f"{target}#{anchor}" if anchor else target)
    assert broken == []


def _anchors(path: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_every_document_shows_something():
    assert {item.document for item in _shown(is_for_moseg)} == {
        path.relative_to(ROOT).as_posix() for path in TO_BE_UNDERSTOOD
    }


def test_commands_are_found_in_blocks_comments_and_text():
    text = "\n".join(
        [
            "Say `moseg eval",
            "--quiet` or `A=1 moseg store ls`:",
            "",
            "    moseg segment a.mp4 --preset paper    # or: --preset modern; slow",
            "    make eval      # or: .venv/bin/moseg eval",
        ]
    )
    assert [code for code in shown_code(text) if code] == [
        "moseg segment a.mp4 --preset paper",
        "moseg segment a.mp4 --preset paper --preset modern",
        "make eval",
        "moseg eval",
        "moseg eval --quiet",
        "moseg store ls",
    ]


@pytest.mark.parametrize(
    "code",
    [
        "moseg evaluate",
        "moseg store list",
        "moseg eval --data-set synthetic",
        "moseg eval --dataset sintetic",
        "moseg eval --variant fuse",
        "moseg eval --preset papers",
        "moseg eval --geometry euclidean",
        "moseg eval --flow farneback",
        "moseg eval --tagger ram",
        "moseg eval --set fundamental.gab=3",
        "moseg eval --set raft.weights=raft-huge",
        "moseg eval --set raft.weights=pips",
        "moseg eval --workers two",
        "moseg segment --out there",
        "moseg export one two",
        "moseg weights fetch raft-huge",
        "moseg weights fetch --preset papers",
        "--workres 2",
        "--workres",
        "--forget RUN --workers 2",
        "--set sections.longness=3",
        "sections.longness",
        "sections.length=none",
    ],
)
def test_wrong_command_lines_are_noticed(code):
    assert is_for_moseg(code)
    with pytest.raises((TyperException, InputError)):
        check(code)


@pytest.mark.skipif(shutil.which("make") is None, reason="no make")
@pytest.mark.parametrize("code", ["make evaluation", "make eval DATASETS=davis16"])
def test_wrong_lines_of_make_are_noticed(code):
    with pytest.raises(InputError, match="make"):
        dry_run(code)
