"""Make the pictures of `docs/view.md`: ``python docs/tools/picture_view.py`` writes docs/images/view*.webp.

A scene of the embedded synthetic data set becomes a video, `moseg view` opens it, and Chromium, driven by Playwright,
corrects it and takes pictures of the page.
"""

import argparse
import io
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright
from stand_ins import write_video

from moseg.tasks.synthetic import SCENES, render_scene

IMAGES = Path(__file__).resolve().parents[1] / "images"
SCENE = "two-motions"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
QUALITY = 80
PATIENCE_MS = 300_000
LIGHT = {"viewport": {"width": 1280, "height": 800}, "color_scheme": "light"}
TABLET = {"viewport": {"width": 820, "height": 1180}, "color_scheme": "dark"}


def main() -> None:
    """Write the pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=IMAGES, help="folder of the pictures")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "walk.mp4"
        write_video(video, render_scene(SCENES[SCENE]).images)
        command = ["view", video.name, "--store", "store", "--out", "walk", "--no-browser", "--quiet"]
        server = subprocess.Popen(
            [sys.executable, "-m", "moseg", *command], cwd=folder, stdout=subprocess.PIPE, text=True
        )
        try:
            url = server.stdout.readline().split()[-1]
            _take_pictures(url, options.out)
        finally:
            server.terminate()
            server.wait()


def _take_pictures(url: str, out: Path) -> None:
    executable = next(filter(None, map(shutil.which, BROWSERS)))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=["--no-sandbox", "--disable-gpu"])
        page = _open(browser, url, LIGHT)
        page.keyboard.press("1")
        page.locator("#name").fill("box")
        page.keyboard.press("Enter")
        page.locator(".edits li").nth(0).wait_for()
        page.locator("#frame").fill("12")
        page.wait_for_selector("canvas[data-frame='12']")
        _save(page, out / "view.webp")
        page = _open(browser, url, TABLET)
        page.locator("#cue").select_option("0")
        page.get_by_role("button", name="Paint", exact=True).click()
        box = page.locator("#picture").bounding_box()
        page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.3 * box["height"])
        page.mouse.down()
        page.mouse.move(box["x"] + 0.42 * box["width"], box["y"] + 0.38 * box["height"], steps=12)
        _save(page, out / "view_tablet.webp")
        page.mouse.up()
        page.locator(".edits li").nth(1).wait_for()
        browser.close()


def _open(browser, url: str, options: dict) -> Page:
    """Open the page and wait until the result and its pictures are there."""
    page = browser.new_context(**options).new_page()
    page.set_default_timeout(PATIENCE_MS)
    page.goto(url)
    page.wait_for_selector("canvas[data-frame]")
    page.locator(".row .area").first.wait_for()
    while not page.evaluate("[...document.querySelectorAll('.row img')].every((each) => each.complete)"):
        page.wait_for_timeout(50)
    return page


def _save(page: Page, path: Path) -> None:
    Image.open(io.BytesIO(page.screenshot())).convert("RGB").save(path, quality=QUALITY, method=6)
    print(path)


if __name__ == "__main__":
    main()
