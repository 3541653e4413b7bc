"""Run every command line of moseg and make that the documents show: ``python docs/tools/check_commands.py``.

Each document gets a folder of its own with small inputs in place of those that it names (`stand_ins`): commands for
``/data/DAVIS`` run on eight tiny sequences, commands for ``s3://my-bucket`` on a server in this process. What one
document has computed another reads, unless it shows runs or the store. One line is printed for each command: ok, FAIL
or not run, with the reason. The exit code is 1 if a command failed.
"""

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from itertools import pairwise
from pathlib import Path
from textwrap import indent
from typing import NamedTuple

from services import Services
from shown_commands import DOCUMENTS, ROOT, shown_commands, variables, without_variables
from stand_ins import SCENE, STILL, write_stand_ins
from typer.core import TyperGroup
from typer.main import get_command

from moseg.workflows.cli.app import app

BIN = ROOT / ".venv" / "bin"
TIMEOUT = 1200.0
"""Longest time of a command, s: the slowest takes twenty on two idle cores."""

NOT_RUN = (
    (r"^make (test|lint|docs-check)\b", "a check of its own"),
    (r"^make (bench|peers\b)", "a benchmark of minutes to hours"),
    (
        r"^make results\b",
        "writes the pages of the working copy; tests/docs/test_results.py compares them",
    ),
    (r"^make (setup|clean|docs-pictures)\b", "changes the working copy or its environment"),
    (r"^(make|moseg) train\b", "trains for hours; tests/workflows/training runs it on tiny data"),
    (r"motion_network\.weights=", "needs a network that a user trained; tests/workflows/training runs it"),
    (
        r"^moseg segment .*--(corrections|drop|merge|split|rename)",
        "needs objects of an earlier result; tests/workflows/corrections/test_edits.py runs it",
    ),
    (r"^moseg weights (fetch|verify)\b", "downloads, or reads, gigabytes of weights"),
    (r"(^| )(gs|az)://", "no server of Google or Azure to run it against"),
    (r" tls://", "needs certificates; tests/workflows/clusters runs it"),
    (r"--install-completion|--show-completion", "changes the shell's own files"),
    (r"^moseg view\b", "serves a page until it is ended; tests/workflows/view runs it"),
    (r"^moseg status --follow", "follows until its run ends; tests/workflows/test_status.py runs it"),
)
"""Commands that are not run, with the reason; the patterns are matched against the command as shown."""
BY_A_TEST = {"docs/extending.md": "needs files that the page shows; tests/docs/test_extending.py runs it"}
"""Documents whose commands a test runs."""
WORDS = {
    "N": "1",
    "RUN": "latest",
    "KEY": "{score}",
    "score/1a2b": "{score prefix}",
    "1a2b": "{prefix}",
    "URL": "s3://my-bucket/moseg",
    "DIR": "tiny",
    "NAME": "synthetic",
    "DAVIS": "data/DAVIS",
    "VIDEO": "clip.mp4",
    "/data": "{folder}/data",
    "0:10": "0:00",
    "0:20": "0:00.5",
    "240": "1",
    "480": "6",
    "stage.name=value": "sections.length=30",
}
"""Replacements of words of a command."""
PARTS = {
    "tcp://host:8786": "{scheduler}",
    "/data/": "{folder}/data/",
    "/shared/": "{folder}/shared/",
    "/scratch/": "{folder}/scratch/",
    "folder:MASKS": "folder:masks",
    "folder:FLOW": "folder:flow",
    "folder:MAPS": "folder:depth",
    "folder:TRACKS": "folder:tracks",
    "=DIR": "=tiny",
}
"""Replacements of parts of words."""
_COMPUTED = threading.Lock()
_RUN = re.compile(r"20\d{6}T\d{4,6}(-[0-9a-f]{8})?")
VIDEO_SUFFIXES = (".mp4", ".mov", ".mkv", ".avi", ".webm")
OUTPUTS = ("-o", "--out", "--report", "--overlay")
OF_OWN_RUNS = ("moseg report", "moseg status", "moseg store")
"""Commands about the runs of a document, of which those that compute nothing leave no log, or about its store."""
OF_DATA = ("eval", "ablate", "plan", "contact-sheet")
SEQUENCES = {"synthetic": SCENE, "still": STILL}
"""Sequences that stand for all of a data set, with one of each kind."""


class Check(NamedTuple):
    """Outcome of one command of a document.

    Attributes
    ----------
    document, command : str
        As shown.
    verdict : str
        ``ok``, ``FAIL`` or ``not run``.
    seconds : float
    reason : str
        Why it was not run, or the end of the output of a failure.
    """

    document: str
    command: str
    verdict: str
    seconds: float = 0.0
    reason: str = ""


def main() -> int:
    """Run the commands of the given documents; exit with code 1 if one fails."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("documents", nargs="*", help="names such as README.md; all if none is given")
    parser.add_argument("--workers", type=int, default=2, help="documents at a time")
    parser.add_argument("--match", default="", help="only commands in which this regular expression is found")
    options = parser.parse_args()
    chosen = [path for path in DOCUMENTS if not options.documents or path.name in options.documents]
    started = time.perf_counter()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="moseg-docs-")))
        (folder / "inputs").mkdir()
        write_stand_ins(folder / "inputs", BIN / "moseg")
        services = stack.enter_context(Services(folder / "services"))
        # A mention without options is the same in every document.
        said: set[str] = set()
        jobs = []
        for path in chosen:
            found = [
                code for code in shown_commands(path.read_text(encoding="utf-8")) if re.search(options.match, code)
            ]
            fresh = [code for code in found if not (code in said and len(code.split()) < 4)]
            said |= set(found)
            jobs.append((path, fresh))
        jobs.sort(key=lambda job: -len(job[1]))
        with ThreadPoolExecutor(options.workers) as pool:
            runs = [pool.submit(check_document, path, codes, folder, services) for path, codes in jobs]
            checks = [check for run in runs for check in run.result()]
    counts = {verdict: sum(check.verdict == verdict for check in checks) for verdict in ("ok", "FAIL", "not run")}
    listed = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    print(f"\n{listed} in {time.perf_counter() - started:.0f} s")
    return 1 if counts["FAIL"] else 0


def check_document(path: Path, codes: list[str], folder: Path, services: Services) -> list[Check]:
    """Run a document's commands one after the other in a folder of its own, and return their outcomes."""
    name = path.relative_to(ROOT).as_posix()
    own = folder / f"work-{name.replace('/', '-')}"
    values = _lay_out(folder / "inputs", own)
    objects = own / ".moseg" / "store" / "objects"
    if not any(without_variables(code).startswith(OF_OWN_RUNS) for code in codes):
        _link_artifacts(folder / "computed", objects)
    checks = []
    for code in codes:
        check = _check(name, code, own, values, services)
        checks.append(check)
        seconds = f"{check.seconds:6.1f} s" if check.verdict != "not run" else "        "
        why = f"  ({check.reason})" if check.verdict == "not run" else ""
        failure = f"\n{indent(check.reason, ' ' * 18)}" if check.verdict == "FAIL" else ""
        print(f"{check.verdict:8}{seconds}  {name}: {code}{why}{failure}", flush=True)
    _link_artifacts(objects, folder / "computed")
    shutil.rmtree(own)
    return checks


def _link_artifacts(source: Path, target: Path) -> None:
    """Link the artifacts of one store into another, or into the folder of what was computed so far."""
    with _COMPUTED:
        for artifact in source.glob("*/*/*"):
            there = target / artifact.relative_to(source)
            if not there.exists():
                shutil.copytree(artifact, there, copy_function=os.link)


def _check(name: str, code: str, own: Path, values: dict[str, str], services: Services) -> Check:
    command = without_variables(code)
    if name in BY_A_TEST:
        return Check(name, code, "not run", reason=BY_A_TEST[name])
    for pattern, reason in NOT_RUN:
        if re.search(pattern, command):
            return Check(name, code, "not run", reason=reason)
    if is_mention(command):
        return Check(name, code, "not run", reason="only named: it needs arguments")
    environ = {**os.environ, **services.environ(command), **_environ(own)}
    environ |= {key: _fill(value, own, values, services) for key, value in variables(code).items()}
    words = [_fill(word, own, values, services) for word in _words(command) if word != "…"]
    _make_videos(words, own)
    line = " ".join(word if word in (">", "|", "&&") else shlex.quote(word) for word in shorten(words))
    started = time.perf_counter()
    try:
        ran = subprocess.run(
            ["bash", "-c", line], cwd=own, env=environ, capture_output=True, text=True, timeout=TIMEOUT, check=False
        )
        code_and_output = ran.returncode, ran.stdout + ran.stderr
    except subprocess.TimeoutExpired:
        code_and_output = None, f"not done after {TIMEOUT:.0f} s"
    seconds = time.perf_counter() - started
    if code_and_output[0] == 0:
        return Check(name, code, "ok", seconds)
    tail = "\n".join(code_and_output[1].strip().splitlines()[-6:])
    return Check(name, code, "FAIL", seconds, f"as run: {line}\nexit code {code_and_output[0]}\n{tail}")


def shorten(words: list[str]) -> list[str]:
    """Return the command, restricted to the sequences that stand for a data set of which scenes are rendered."""
    if words[0] == "make":
        named = [word.removeprefix("DATASET=") for word in words if word.startswith("DATASET=")]
        chosen = SEQUENCES.get(named[0] if named else "synthetic")
        extra = [f"ARGS=--sequences {chosen}"] if {"eval", "ablation"} & {*words} and chosen else []
        # Set-up is done: it belongs to the working copy, which contains this folder.
        return ["make", "-f", str(ROOT / "Makefile"), "-o", ".venv/.ready", *words[1:], *extra]
    chosen = SEQUENCES.get(words[words.index("--dataset") + 1] if "--dataset" in words else "synthetic")
    if words[1] in OF_DATA and chosen and "--sequences" not in words:
        return [*words, "--sequences", chosen]
    return words


def is_mention(command: str) -> bool:
    """Return whether only a name of a command or group is given that needs arguments."""
    words = command.split()
    if words[0] == "make":
        return False
    inner, rest = get_command(app), words[1:]
    while isinstance(inner, TyperGroup) and rest and rest[0] in inner.commands:
        inner, rest = inner.commands[rest[0]], rest[1:]
    if isinstance(inner, TyperGroup):
        return not rest and not inner.invoke_without_command
    return not rest and any(param.required for param in inner.params)


def _words(command: str) -> list[str]:
    lexer = shlex.shlex(command, posix=True, punctuation_chars=">|&")
    lexer.whitespace_split = True
    return list(lexer)


def _fill(word: str, own: Path, values: dict[str, str], services: Services) -> str:
    word = "latest" if _RUN.fullmatch(word) else WORDS.get(word, word)
    for part, instead in PARTS.items():
        word = word.replace(part, instead)
    filled: dict[str, Callable[[], str]] = {"{folder}": lambda: str(own), "{scheduler}": services.scheduler}
    for name, value in values.items():
        filled[name] = lambda value=value: value
    for name, value in filled.items():
        if name in word:
            word = word.replace(name, value())
    return word


def _make_videos(words: list[str], own: Path) -> None:
    """Write a video under each name that commands read."""
    for before, word in pairwise(words):
        name = word.removeprefix("VIDEO=")
        if name.lower().endswith(VIDEO_SUFFIXES) and before not in OUTPUTS and not (own / name).exists():
            (own / name).parent.mkdir(parents=True, exist_ok=True)
            (own / name).symlink_to(own / "clip.mp4")


def _environ(own: Path) -> dict[str, str]:
    return {
        "PATH": f"{BIN}:{os.environ['PATH']}",
        "HOME": str(own),
        "MOSEG_WEIGHTS": str(own / "weights"),
        "MOSEG_OFFLINE": "1",
        "MOSEG_STORE": str(own / ".moseg" / "store"),
        "MOSEG_DATA": str(own / "data"),
        "COLUMNS": "120",
    }


def _lay_out(inputs: Path, own: Path) -> dict[str, str]:
    """Link the inputs into a document's folder with a store of its own, and return the replacements of its keys."""
    own.mkdir()
    for path in inputs.iterdir():
        if path.name not in ("store", "data"):
            (own / path.name).symlink_to(path)
    (own / "data").mkdir()
    for path in (inputs / "data").iterdir():
        (own / "data" / path.name).symlink_to(path)
    (own / ".venv").symlink_to(BIN.parent)
    for name in ("pyproject.toml", "constraints.txt"):
        (own / name).symlink_to(ROOT / name)
    shutil.copytree(inputs / "store", own / ".moseg" / "store", copy_function=os.link)
    (own / "data" / "store").symlink_to(own / ".moseg" / "store")
    key = next((own / ".moseg" / "store" / "objects" / "score").glob("*/*")).name
    return {"{score}": f"score/{key}", "{score prefix}": f"score/{key[:6]}", "{prefix}": key[:8]}


if __name__ == "__main__":
    sys.exit(main())
