"""Reports as they are before they are pages, and a headless browser for what is shown in one."""

import shutil

import pytest

from workflows.reports import write

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


@pytest.fixture(scope="module")
def browser():
    """Chromium, started once for each module that asks for it."""
    executable = next(filter(None, map(shutil.which, BROWSERS)), None)
    if executable is None:
        pytest.skip(f"no browser: none of {', '.join(BROWSERS)} is on the PATH")
    sync_api = pytest.importorskip("playwright.sync_api", reason="Playwright drives the browser")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


@pytest.fixture
def pages(monkeypatch):
    """The pages that are written, in place of whole files of HTML."""
    written = []

    def render(made):
        written.append(made)
        return made.title

    monkeypatch.setattr(write, "render_page", render)
    return written
