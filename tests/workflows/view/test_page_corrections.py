"""Corrections in a browser: strokes, names, settings and exports, and the same result from the command line."""

import json
import shutil

import pytest

from moseg.workflows.config.corrections_file import read_corrections

HOSTILE = '<img src=x onerror="window.ran=1">\'&amp;'
# Values of the settings that the server has in force.
VALUES = """fetch('state').then((answer) => answer.json())
  .then((state) => state.result.settings.map((each) => each.value))"""


@pytest.fixture
def masks(moseg, tmp_path):
    """Return a function that gives the masks of a run of `moseg segment` with some options, by name."""

    def segment(result, *options):
        out = tmp_path / "by hand"
        shutil.rmtree(out, ignore_errors=True)
        base = (result.frames, "--section-length", "4", "--set", "sections.overlap=2", "--quiet")
        ran = moseg("segment", *base, "--out", out, "--store", result.store, *options)
        assert ran.code == 0, ran.err
        return _masks_in(out)

    return segment


def _masks_in(folder) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((folder / "masks").iterdir())}


def test_the_whole_way_gives_the_masks_of_the_command_line(serve_video, open_page, result, masks):
    page = open_page(serve_video())
    page.select(0)
    page.keyboard.press("d")
    page.wait_for(rows=1)
    page.keyboard.press("Control+z")
    page.wait_for(rows=2, edits=0)
    assert not (result.out / "corrections.yaml").exists()
    page.select(0, 1)
    page.get_by_role("button", name="Merge").click()
    page.wait_for(rows=1)
    page.locator("#name").fill(HOSTILE)
    page.keyboard.press("Enter")
    page.wait_for(edits=2)
    page.locator("#frame").fill("5")
    page.wait_for_selector("canvas[data-frame='5']")
    page.get_by_role("button", name="Paint", exact=True).click()
    page.stroke((0.5, 0.8), (0.6, 0.85))
    page.wait_for(edits=3)
    page.keyboard.press("e")
    page.stroke((0.25, 0.2), (0.25, 0.3))
    page.wait_for(edits=4)
    page.keyboard.press("Control+z")
    page.wait_for(edits=3)
    page.keyboard.press("Control+y")
    page.wait_for(edits=4)
    assert "coco.json" in page.export("coco")
    assert page.evaluate("window.ran") is None and page.faults == []
    written = _masks_in(result.out)
    kinds = [next(iter(edit.model_dump())) for edit in read_corrections(str(result.out / "corrections.yaml")).edits]
    assert kinds == ["merge", "rename", "paint", "erase"]
    assert written == masks(result, "--corrections", result.out / "corrections.yaml")
    assert written != masks(result) and len(written) == 10
    (entry,) = json.loads((result.out / "motion.json").read_text())["objects"]
    assert entry["name"] == HOSTILE and (result.out / "coco.json").exists()
    page.reload()
    page.wait_for(edits=4, rows=1)
    assert page.locator(".row-name").text_content().startswith(f"1 {HOSTILE}")
    # What the file has can be undone by a page that was opened later, too.
    page.get_by_role("button", name="Undo").click()
    page.wait_for(edits=3)


def test_short_options_stand_for_the_same_corrections(serve_video, open_page, result, masks):
    page = open_page(serve_video())
    page.select(0)
    page.keyboard.press("s")
    page.wait_for(rows=1)
    page.select(0)
    page.locator("#frame").fill("4")
    page.locator("#picture").focus()
    page.keyboard.press("x")
    page.wait_for(rows=2)
    page.export()
    assert _masks_in(result.out) == masks(result, "--static", "1", "--split", "2@4")


def test_a_rejected_proposal_is_promoted(serve_video, open_page):
    page = open_page(serve_video())
    page.locator("[data-setting='clustering.motions']").select_option("1")
    page.wait_for(rows=0, rejected=2)
    page.get_by_role("button", name="promote 2").click()
    page.wait_for(rows=1)
    assert page.edits() == ["keep 2"]
    page.get_by_role("button", name="motions as the run had it: auto").click()
    page.wait_for(rows=2)


def test_a_stroke_belongs_to_the_tool_and_the_frame_with_which_it_began(serve_video, open_page):
    page = open_page(serve_video())
    box = page.locator("#picture").bounding_box()
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    for key in ("v", "e", "End"):
        page.keyboard.press("b")
        page.mouse.move(*middle)
        page.mouse.down()
        page.mouse.move(middle[0] + 40, middle[1], steps=3)
        page.keyboard.press(key)
        page.mouse.up()
    # The brush stops the player, so that the stroke is in the frame that is seen.
    page.keyboard.press(" ")
    page.wait_until("document.querySelector('[data-play]').getAttribute('aria-pressed') === 'true'")
    page.mouse.move(*middle)
    page.mouse.down()
    assert page.locator("[data-play]").get_attribute("aria-pressed") == "false"
    frame = page.locator("#frame").input_value()
    page.mouse.up()
    page.wait_for(edits=1)
    assert page.edits() == [f"paint 3 in frame {frame}"]


def test_a_stroke_stays_in_sight_until_the_result_has_it(serve_video, open_page):
    page = open_page(serve_video())
    held = []
    page.route("**/edits", lambda route: held.append(route))
    before = page.pixel(0.5, 0.9)
    page.keyboard.press("b")
    page.stroke((0.5, 0.9), (0.52, 0.9))
    page.mouse.move(0, 0)
    page.wait_until("document.getElementById('saved').textContent === 'computing …'")
    drawn = page.pixel(0.5, 0.9)
    # Light blue, as the brush.
    assert drawn != before and drawn[2] > drawn[0] + 60
    held[0].continue_()
    page.wait_for(edits=1, rows=3)


def test_a_name_that_is_emptied_stays_and_says_so(serve_video, open_page):
    page = open_page(serve_video())
    page.keyboard.press("1")
    for name in ("bear", ""):
        page.locator("#name").fill(name)
        page.keyboard.press("Enter")
        page.wait_for(edits=1)
    assert page.locator("#name").input_value() == "bear"
    assert "still called bear" in page.locator("#message").text_content()


def test_the_result_follows_a_slider_and_a_gesture_is_one_step(serve_video, open_page, result):
    page = open_page(serve_video())
    slider = page.locator("[data-setting='clustering.threshold']")
    box = slider.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] - 3, box["y"] + box["height"] / 2, steps=8)
    file = result.out / "corrections.yaml"
    page.wait_until("document.getElementById('saved').textContent.includes('1 setting saved')")
    page.mouse.up()
    # The slider sends values while it moves: wait until the last one is in force.
    chosen = float(slider.input_value())
    assert chosen > 0.9
    page.wait_until(f"{VALUES}.then((found) => found[1] === {chosen})")
    # What is in force is listed, settings too.
    listed = "document.querySelector('ul[aria-label=settings]')?.textContent"
    page.wait_until(f"{listed} === 'clustering.threshold: {chosen}'")
    assert read_corrections(str(file)).settings == {"clustering.threshold": chosen}
    page.get_by_role("button", name="Undo").click()
    page.wait_until("document.getElementById('saved').textContent === 'no corrections'")
    assert not file.exists()


def test_sliders_that_move_at_once_both_keep_their_last_value(serve_video, open_page, result):
    page = open_page(serve_video())
    page.evaluate(
        """() => {
          for (const value of [0.6, 0.7, 0.8]) for (const name of ['clustering.threshold', 'moving_objects.min_area']) {
            const slider = document.querySelector(`[data-setting='${name}']`);
            slider.value = name === 'clustering.threshold' ? value : value / 100;
            slider.dispatchEvent(new Event('input', { bubbles: true }));
          }
        }"""
    )
    page.wait_until(f"{VALUES}.then((found) => found.includes(0.8) && found.includes(0.008))")
    settings = read_corrections(str(result.out / "corrections.yaml")).settings
    assert settings == {"clustering.threshold": 0.8, "moving_objects.min_area": 0.008}


def test_a_slider_does_not_jump_back_to_a_value_before_its_last(serve_video, open_page):
    page = open_page(serve_video())
    page.evaluate(
        """() => {
          const slider = () => document.querySelector("[data-setting='clustering.threshold']");
          window.shown = [];
          new MutationObserver(() => window.shown.push(slider().value)).observe(
            document.getElementById("settings"), { childList: true });
          for (const value of [0.6, 0.8]) {
            slider().value = value;
            slider().dispatchEvent(new Event("input", { bubbles: true }));
          }
        }"""
    )
    page.wait_until(f"{VALUES}.then((found) => found[1] === 0.8) && window.shown.length > 0")
    assert set(page.evaluate("window.shown")) == {"0.8"}


def test_a_key_that_is_held_on_a_slider_is_one_step(serve_video, open_page):
    page = open_page(serve_video())
    page.locator("[data-setting='clustering.threshold']").focus()
    for _ in range(4):
        page.keyboard.down("ArrowRight")
    page.keyboard.up("ArrowRight")
    page.wait_until("document.querySelector(\"[data-key='clustering.threshold'] + output\").textContent === '0.58'")
    page.wait_until("document.getElementById('saved').textContent.includes('1 setting saved')")
    page.get_by_role("button", name="Undo").click()
    page.wait_until("document.getElementById('saved').textContent === 'no corrections'")


def test_an_export_says_what_it_wrote_in_sight_and_offers_given_names(serve_video, open_page):
    page = open_page(serve_video())
    page.keyboard.press("Control+s")
    names = page.get_by_label("numbers and names of the objects")
    assert not names.is_checked()
    page.get_by_role("button", name="Close", exact=True).click()
    page.select(0)
    page.keyboard.press("F2")
    page.keyboard.type("late")
    page.keyboard.press("Enter")
    page.wait_for(edits=1)
    page.keyboard.press("Control+s")
    assert names.is_checked()
    page.get_by_role("button", name="Write").click()
    page.wait_until("!document.getElementById('write').disabled")
    said = page.locator("#export-status").bounding_box()
    assert "overlay.mp4" in page.locator("#export-status").text_content()
    assert said["y"] >= 0 and said["y"] + said["height"] <= 800
