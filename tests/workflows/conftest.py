"""Fixtures: a store that workers filled, reports before they are rendered, a browser for pages, and injected faults."""

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from moseg.store import open_store
from moseg.workflows.reports import run_report

STRIKES = """
import os, signal, sys

steps = {steps}

def watch(event, arguments):
    global steps
    if not ({step}):
        return
    steps -= 1
    if steps == 0:
        try:
            os.close(os.open({token!r}, os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            return
        {deed}

if any("spawn_main" in word for word in sys.orig_argv) == {in_worker}:
    sys.addaudithook(watch)
"""
PAGE_PATIENCE_MS = 600_000
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


@pytest.fixture(scope="session")
def evaluated_by_workers(evaluated, tmp_path_factory):
    """Return the evaluation of the squares by two worker processes; tests only read its store."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("evaluated-by-workers")
    outputs = ("--store", str(folder / "store"), "--json", str(folder / "report.json"))
    assert run([*evaluated.arguments, *outputs, "--workers", "2"]) == 0
    return evaluated._replace(store=folder / "store", report=json.loads((folder / "report.json").read_text()))


@pytest.fixture(scope="session")
def tiny(tmp_path_factory):
    """Return a folder of tiny checkpoints of every network, made by the command in the documentation; only read it."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("tiny")
    assert run(["weights", "tiny", str(folder)]) == 0
    return folder


@pytest.fixture(scope="session")
def contents_of() -> Callable[[Path], dict]:
    """Return a function that reads all artifacts of a store: digests of their arrays, and their attributes."""

    def call(folder):
        store = open_store(str(folder), create=False)
        manifests = {ref: store.manifest(ref) for ref in store.refs()}
        return {ref: ([entry.digest for entry in found.arrays], found.attributes) for ref, found in manifests.items()}

    return call


@pytest.fixture(scope="module")
def browser():
    """Start Chromium, once for each module that uses it."""
    executable = next(filter(None, map(shutil.which, BROWSERS)), None)
    if executable is None:
        pytest.skip(f"no browser: none of {', '.join(BROWSERS)} is on the PATH")
    sync_api = pytest.importorskip("playwright.sync_api", reason="Playwright drives the browser")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


@pytest.fixture
def new_page(browser):
    """Return a function that opens an empty page in a browser with options, with timeouts for a busy machine."""
    contexts = []

    def call(**options):
        contexts.append(browser.new_context(**options))
        contexts[-1].set_default_timeout(PAGE_PATIENCE_MS)
        return contexts[-1].new_page()

    yield call
    for context in contexts:
        context.close()


@pytest.fixture(scope="session")
def wait_until() -> Callable[..., None]:
    """Wait until an expression is true in a page; the page forbids `eval`, which Playwright's own wait needs."""

    def wait(page, expression: str) -> None:
        for _ in range(6000):
            if page.evaluate(expression):
                return
            page.wait_for_timeout(50)
        pytest.fail(f"never held: {expression}")

    return wait


@pytest.fixture
def pages(monkeypatch):
    """Return the content of the pages that are written, in place of HTML files."""
    written = []

    def render(made):
        written.append(made)
        return f"<!doctype html>{made.title}"

    monkeypatch.setattr(run_report, "render_page", render)
    return written


@pytest.fixture
def strike_at(tmp_path) -> Callable[..., tuple[dict[str, str], Path]]:
    """Return a function that gives an environment with an injected fault, and the file that exists after the fault.

    The first process that reaches a step a given number of times executes a deed. The step is an expression of an audit
    `event` and its `arguments`, the deed a line of Python. The deed happens in a worker or in the client, at exactly
    that step on any machine, which no observer outside the process could ensure.
    """

    def arm(step: str, deed: str, in_worker: bool, steps: int = 1) -> tuple[dict[str, str], Path]:
        folder = tmp_path / "strike"
        folder.mkdir()
        token = folder / "done"
        site = STRIKES.format(step=step, deed=deed, in_worker=in_worker, steps=steps, token=str(token))
        # Python runs the first file of this name that it finds.
        (folder / "sitecustomize.py").write_text(site)
        paths = [str(folder), *filter(None, [os.environ.get("PYTHONPATH")])]
        return {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}, token

    return arm
