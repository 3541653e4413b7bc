"""The whole way on a real video: open it, correct it in a browser, export it, and do the same from the command line."""

import json
import os
from pathlib import Path

import pytest

DATA = Path(os.environ.get("MOSEG_TEST_DATA", Path(__file__).resolve().parents[4] / "shared" / "data"))
OPTIONS = ("--end", "12", "--set", "max_side=320")
NUM_EDITS = "document.querySelectorAll('.edits li').length"
ROWS = "document.querySelectorAll('.row').length"


def _masks_in(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((folder / "masks").iterdir())}


@pytest.mark.skipif(not (DATA / "video").is_dir(), reason="no real videos: set MOSEG_TEST_DATA to their folder")
def test_the_bear_is_corrected_and_delivered(serve, new_page, wait_until, moseg, tmp_path):
    video, out, store = DATA / "video" / "bear.mp4", tmp_path / "bear", tmp_path / "store"
    server = serve(video, *OPTIONS, "--out", out, "--store", store, "--quiet")
    page = new_page(viewport={"width": 1280, "height": 800})
    page.goto(server.url)
    # It is segmented while the page shows how far that is.
    page.wait_for_selector("canvas[data-frame]")
    wait_until(page, f"{ROWS} === 1 && document.querySelectorAll('.row .area').length === 1")
    first = _masks_in(out)
    assert len(first) == 12 and (out / "overlay.mp4").exists()
    box = page.locator("#picture").bounding_box()
    page.keyboard.press("b")
    page.mouse.move(box["x"] + 0.8 * box["width"], box["y"] + 0.2 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.85 * box["width"], box["y"] + 0.25 * box["height"], steps=4)
    page.mouse.up()
    wait_until(page, f"{NUM_EDITS} === 1 && {ROWS} === 2")
    page.locator(".row-name").nth(0).click()
    page.locator(".row-name").nth(1).click(modifiers=["Shift"])
    page.keyboard.press("g")
    wait_until(page, f"{NUM_EDITS} === 2 && {ROWS} === 1")
    page.keyboard.press("Control+z")
    wait_until(page, f"{NUM_EDITS} === 1 && {ROWS} === 2")
    page.keyboard.press("Control+y")
    wait_until(page, f"{NUM_EDITS} === 2 && {ROWS} === 1")
    page.locator(".row-name").first.click()
    page.keyboard.press("F2")
    page.keyboard.type("bear")
    page.keyboard.press("Enter")
    wait_until(page, f"{NUM_EDITS} === 3")
    page.keyboard.press("Control+s")
    page.locator("input[name=formats][value=davis]").check()
    page.get_by_role("button", name="Write").click()
    wait_until(page, "document.getElementById('export-status').textContent.includes('12 frames')")
    page.reload()
    wait_until(page, f"{NUM_EDITS} === 3 && {ROWS} === 1")
    server.end()
    by_hand = tmp_path / "by hand"
    arguments = ("--corrections", out / "corrections.yaml", "--out", by_hand, "--store", store, "--quiet")
    assert moseg("segment", video, *OPTIONS, *arguments).code == 0
    assert _masks_in(by_hand) == _masks_in(out) != first
    (entry,) = json.loads((out / "motion.json").read_text())["objects"]
    assert entry["name"] == "bear" and len(list((out / "davis" / "bear").glob("*.png"))) == 12
