"""The page in a browser: looking, correcting, undoing, exporting, and the same result from the command line."""

import json
import shutil

import pytest

from moseg.workflows.config.corrections_file import read_corrections

OPTIONS = ("--section-length", "4", "--set", "sections.overlap=2")
HOSTILE = '<img src=x onerror="window.ran=1">\'&amp;'
ROWS = "document.querySelectorAll('.row').length"
EDITS = "[...document.querySelectorAll('.edits li')].map((each) => each.textContent)"
NUM_EDITS = "document.querySelectorAll('.edits li').length"
# Values of the settings that the server has in force.
VALUES = """fetch('state').then((answer) => answer.json())
  .then((state) => state.result.settings.map((each) => each.value))"""
# What the canvas shows at a share of its width and height, and the frame and the state that it shows.
PIXEL = """([x, y]) => {
  const canvas = document.getElementById('picture');
  const at = [Math.round(x * canvas.width), Math.round(y * canvas.height)];
  return [...canvas.getContext('2d').getImageData(...at, 1, 1).data].slice(0, 3);
}"""


@pytest.fixture
def open_page(new_page, wait_until):
    """Return a function that opens a server's page and waits until its result is drawn."""

    def open_in(server, **options):
        page = new_page(viewport={"width": 1280, "height": 800}, **options)
        page.faults = []
        page.on("console", lambda message: page.faults.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: page.faults.append(str(error)))
        page.goto(server.url)
        page.wait_for_selector("canvas[data-frame]")
        wait_until(page, f"document.querySelectorAll('.row .area').length === {ROWS} && {ROWS} > 0")
        return page

    return open_in


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


def _edits(page) -> list[str]:
    return page.evaluate(EDITS)


def _select(page, *rows: int) -> None:
    for place, row in enumerate(rows):
        page.locator(".row").nth(row).locator(".row-name").click(modifiers=["Shift"] if place else [])


def _stroke(page, *shares: tuple[float, float]) -> None:
    box = page.locator("#picture").bounding_box()
    places = [(box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in shares]
    page.mouse.move(*places[0])
    page.mouse.down()
    for place in places[1:]:
        page.mouse.move(*place, steps=4)
    page.mouse.up()


def _export(page, wait_until, *formats: str) -> str:
    page.get_by_role("button", name="Export…").click()
    for name in formats:
        page.locator(f"input[name=formats][value={name}]").check()
    page.get_by_role("button", name="Write").click()
    wait_until(page, "!document.getElementById('write').disabled")
    said = page.locator("#export-status").text_content()
    page.get_by_role("button", name="Close", exact=True).click()
    return said


def test_it_loads_without_errors_and_asks_no_other_server(serve_video, new_page, wait_until):
    server, page = serve_video(), new_page()
    faults, requests = [], []
    page.on("console", lambda message: faults.append(message.text))
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(server.url)
    page.wait_for_selector("canvas[data-frame]")
    wait_until(page, "document.querySelectorAll('.row img').length === 16")
    wait_until(page, "[...document.querySelectorAll('.row img')].every((each) => each.naturalWidth === 96)")
    assert faults == []
    assert {url for url in requests if not url.startswith((server.url, "data:", "blob:"))} == set()


def test_the_player_shows_every_frame_exactly(serve_video, open_page, result):
    from PIL import Image

    page = open_page(serve_video())
    page.get_by_label("masks").uncheck()
    page.get_by_label("names").uncheck()
    for frame in (7, 0, 9):
        page.locator("#frame").fill(str(frame))
        page.wait_for_selector(f"canvas[data-frame='{frame}']")
        with Image.open(result.frames / f"{frame:05d}.png") as image:
            expected = image.convert("RGB").getpixel((64, 48))
        assert page.evaluate(PIXEL, [0.5, 0.5]) == pytest.approx(list(expected), abs=12)
    page.locator("#picture").focus()
    page.keyboard.press("ArrowLeft")
    page.wait_for_selector("canvas[data-frame='8']")
    page.keyboard.press("Home")
    page.wait_for_selector("canvas[data-frame='0']")
    page.keyboard.press(" ")
    for frame in (1, 2, 9, 0):
        page.wait_for_selector(f"canvas[data-frame='{frame}']")
    page.keyboard.press(" ")
    assert page.get_by_role("button", name="play", exact=True).get_attribute("aria-pressed") == "false"


def test_the_whole_way_gives_the_masks_of_the_command_line(serve_video, open_page, result, masks, wait_until):
    page = open_page(serve_video())
    _select(page, 0)
    page.keyboard.press("d")
    wait_until(page, f"{ROWS} === 1")
    page.keyboard.press("Control+z")
    wait_until(page, f"{ROWS} === 2 && {NUM_EDITS} === 0")
    assert not (result.out / "corrections.yaml").exists()
    _select(page, 0, 1)
    page.get_by_role("button", name="Merge").click()
    wait_until(page, f"{ROWS} === 1")
    page.locator("#name").fill(HOSTILE)
    page.keyboard.press("Enter")
    wait_until(page, f"{NUM_EDITS} === 2")
    page.locator("#frame").fill("5")
    page.wait_for_selector("canvas[data-frame='5']")
    page.get_by_role("button", name="Paint", exact=True).click()
    _stroke(page, (0.5, 0.8), (0.6, 0.85))
    wait_until(page, f"{NUM_EDITS} === 3")
    page.keyboard.press("e")
    _stroke(page, (0.25, 0.2), (0.25, 0.3))
    wait_until(page, f"{NUM_EDITS} === 4")
    page.keyboard.press("Control+z")
    wait_until(page, f"{NUM_EDITS} === 3")
    page.keyboard.press("Control+y")
    wait_until(page, f"{NUM_EDITS} === 4")
    assert "coco.json" in _export(page, wait_until, "coco")
    assert page.evaluate("window.ran") is None and page.faults == []
    written = _masks_in(result.out)
    kinds = [next(iter(edit.model_dump())) for edit in read_corrections(str(result.out / "corrections.yaml")).edits]
    assert kinds == ["merge", "rename", "paint", "erase"]
    assert written == masks(result, "--corrections", result.out / "corrections.yaml")
    assert written != masks(result) and len(written) == 10
    (entry,) = json.loads((result.out / "motion.json").read_text())["objects"]
    assert entry["name"] == HOSTILE and (result.out / "coco.json").exists()
    page.reload()
    wait_until(page, f"{NUM_EDITS} === 4 && {ROWS} === 1")
    assert page.locator(".row-name").text_content().startswith(f"1 {HOSTILE}")
    # What the file has can be undone by a page that was opened later, too.
    page.get_by_role("button", name="Undo").click()
    wait_until(page, f"{NUM_EDITS} === 3")


def test_short_options_stand_for_the_same_corrections(serve_video, open_page, result, masks, wait_until):
    page = open_page(serve_video())
    _select(page, 0)
    page.keyboard.press("s")
    wait_until(page, f"{ROWS} === 1")
    _select(page, 0)
    page.locator("#frame").fill("4")
    page.locator("#picture").focus()
    page.keyboard.press("x")
    wait_until(page, f"{ROWS} === 2")
    _export(page, wait_until)
    assert _masks_in(result.out) == masks(result, "--static", "1", "--split", "2@4")


def test_a_rejected_proposal_is_promoted(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    page.locator("[data-setting='clustering.motions']").select_option("1")
    wait_until(page, f"{ROWS} === 0 && document.querySelectorAll('.rejected li').length === 2")
    page.get_by_role("button", name="promote 2").click()
    wait_until(page, f"{ROWS} === 1")
    assert _edits(page) == ["keep 2"]
    page.get_by_role("button", name="motions as the run had it: auto").click()
    wait_until(page, f"{ROWS} === 2")


def test_the_result_follows_a_slider_and_a_gesture_is_one_step(serve_video, open_page, result, wait_until):
    page = open_page(serve_video())
    slider = page.locator("[data-setting='clustering.threshold']")
    box = slider.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] - 3, box["y"] + box["height"] / 2, steps=8)
    file = result.out / "corrections.yaml"
    wait_until(page, "document.getElementById('saved').textContent.includes('1 setting saved')")
    page.mouse.up()
    wait_until(page, f"{VALUES}.then((found) => found[1] > 0.9)")
    value = read_corrections(str(file)).settings["clustering.threshold"]
    assert value > 0.9
    # What is in force is listed, settings too.
    assert page.get_by_role("list", name="settings").text_content() == f"clustering.threshold: {value}"
    page.get_by_role("button", name="Undo").click()
    wait_until(page, "document.getElementById('saved').textContent === 'no corrections'")
    assert not file.exists()


def test_sliders_that_move_at_once_both_keep_their_last_value(serve_video, open_page, result, wait_until):
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
    wait_until(page, f"{VALUES}.then((found) => found.includes(0.8) && found.includes(0.008))")
    settings = read_corrections(str(result.out / "corrections.yaml")).settings
    assert settings == {"clustering.threshold": 0.8, "moving_objects.min_area": 0.008}


def test_a_key_that_is_held_on_a_slider_is_one_step(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    page.locator("[data-setting='clustering.threshold']").focus()
    for _ in range(4):
        page.keyboard.down("ArrowRight")
    page.keyboard.up("ArrowRight")
    wait_until(page, "document.querySelector(\"[data-key='clustering.threshold'] + output\").textContent === '0.58'")
    wait_until(page, "document.getElementById('saved').textContent.includes('1 setting saved')")
    page.get_by_role("button", name="Undo").click()
    wait_until(page, "document.getElementById('saved').textContent === 'no corrections'")


def test_a_stroke_belongs_to_the_tool_and_the_frame_with_which_it_began(serve_video, open_page, wait_until):
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
    wait_until(page, "document.querySelector('[data-play]').getAttribute('aria-pressed') === 'true'")
    page.mouse.move(*middle)
    page.mouse.down()
    assert page.locator("[data-play]").get_attribute("aria-pressed") == "false"
    frame = page.locator("#frame").input_value()
    page.mouse.up()
    wait_until(page, f"{NUM_EDITS} === 1")
    assert _edits(page) == [f"paint 3 in frame {frame}"]


def test_a_stroke_stays_in_sight_until_the_result_has_it(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    held = []
    page.route("**/edits", lambda route: held.append(route))
    before = page.evaluate(PIXEL, [0.5, 0.9])
    page.keyboard.press("b")
    _stroke(page, (0.5, 0.9), (0.52, 0.9))
    page.mouse.move(0, 0)
    wait_until(page, "document.getElementById('saved').textContent === 'computing …'")
    drawn = page.evaluate(PIXEL, [0.5, 0.9])
    # Light blue, as the brush.
    assert drawn != before and drawn[2] > drawn[0] + 60
    held[0].continue_()
    wait_until(page, f"{NUM_EDITS} === 1 && {ROWS} === 3")


def test_a_change_of_the_page_itself_is_not_fetched_again(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    asked = []
    page.on("request", lambda request: asked.append(request.url.rpartition("/")[2]))
    _select(page, 0)
    page.keyboard.press("d")
    wait_until(page, f"{ROWS} === 1")
    page.keyboard.press("Control+z")
    wait_until(page, f"{ROWS} === 2 && document.querySelectorAll('.row .area').length === 2")
    assert "undo" in asked and "state" not in asked


def test_long_names_stay_within_the_picture(serve_video, open_page):
    page = open_page(serve_video())
    drawn = page.evaluate(
        """async () => {
          const { drawNames } = await import('./overlay.js');
          const drawn = [];
          const context = {
            measureText: (text) => ({ width: 6 * text.length }),
            strokeText: () => {},
            fillText: (text, x, y) => drawn.push([text, x - 3 * text.length, x + 3 * text.length, y]),
          };
          const labels = new Uint16Array(200 * 100);
          labels[0] = 1;
          labels[100 * 200 - 1] = 2;
          drawNames(context, labels, 200, new Map([[1, '1 ' + 'x'.repeat(90)], [2, '2 <b>&amp;']]));
          return drawn;
        }"""
    )
    assert [text for text, *_ in drawn] == ["1 " + "x" * 21 + "…", "2 <b>&amp;"]
    assert all(left >= 0 and right <= 200 and 0 <= y <= 100 for _, left, right, y in drawn)


def test_an_export_says_what_it_wrote_in_sight_and_offers_given_names(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    page.keyboard.press("Control+s")
    names = page.get_by_label("numbers and names of the objects")
    assert not names.is_checked()
    page.get_by_role("button", name="Close", exact=True).click()
    _select(page, 0)
    page.keyboard.press("F2")
    page.keyboard.type("late")
    page.keyboard.press("Enter")
    wait_until(page, f"{NUM_EDITS} === 1")
    page.keyboard.press("Control+s")
    assert names.is_checked()
    page.get_by_role("button", name="Write").click()
    wait_until(page, "!document.getElementById('write').disabled")
    said = page.locator("#export-status").bounding_box()
    assert "overlay.mp4" in page.locator("#export-status").text_content()
    assert said["y"] >= 0 and said["y"] + said["height"] <= 800


def test_a_name_that_is_emptied_stays_and_says_so(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    page.keyboard.press("1")
    for name in ("bear", ""):
        page.locator("#name").fill(name)
        page.keyboard.press("Enter")
        wait_until(page, f"{NUM_EDITS} === 1")
    assert page.locator("#name").input_value() == "bear"
    assert "still called bear" in page.locator("#message").text_content()


def test_the_affinities_have_the_names_of_the_objects(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    page.keyboard.press("1")
    page.locator("#name").fill(HOSTILE)
    page.keyboard.press("Enter")
    wait_until(page, f"{NUM_EDITS} === 1")
    page.locator("summary").click()
    page.locator(".matrix").first.wait_for()
    heads = page.locator(".matrix").first.locator("thead th").all_text_contents()
    assert heads == ["background", f"1 {HOSTILE}", "2"] and page.evaluate("window.ran") is None


def test_formats_with_frames_say_why_they_are_not_offered(serve, result, open_page, wait_until):
    server = serve(result.out, "--store", result.store, "--quiet")
    server.wait("ready")
    page = open_page(server)
    page.get_by_role("button", name="Export…").click()
    why = page.locator("#why-disabled")
    assert "contain frames" in why.text_content() and "opened without the video" in why.text_content()
    assert f"moseg export {result.out} --to FORMAT --video VIDEO" in why.text_content()
    disabled = page.locator("#export-dialog input:disabled")
    assert {each.get_attribute("value") for each in disabled.all()} >= {"colmap", "prores"}
    assert {each.get_attribute("aria-describedby") for each in disabled.all()} == {"why-disabled"}
    # With the video there is nothing to explain.
    other = open_page(serve(result.frames, "--out", result.out, "--store", result.store, *OPTIONS, "--quiet"))
    other.get_by_role("button", name="Export…").click()
    assert other.locator("#why-disabled").count() == 0 and other.locator("#export-dialog input:disabled").count() == 0


def test_a_frame_that_cannot_be_read_is_blank_with_one_line(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    message = {"status": 500, "content_type": "application/json", "body": '{"message": "a part cannot be read"}'}
    page.route("**/frames/7*", lambda route: route.fulfill(**message))
    page.locator("#frame").fill("7")
    page.wait_for_selector("canvas[data-frame='7']")
    assert page.locator("#message p").text_content() == "Frame 7 cannot be shown: a part cannot be read"
    assert page.evaluate(PIXEL, [0.5, 0.5]) == [0, 0, 0]
    page.locator("#frame").fill("8")
    page.wait_for_selector("canvas[data-frame='8']")
    assert page.locator("#message").is_hidden() and page.evaluate(PIXEL, [0.5, 0.5]) != [0, 0, 0]


def test_a_server_that_is_gone_is_said_with_what_to_do(serve_video, open_page, result, wait_until):
    server = serve_video()
    page = open_page(server)
    _select(page, 0)
    page.keyboard.press("d")
    wait_until(page, f"{NUM_EDITS} === 1")
    server.process.kill()
    wait_until(page, "!document.getElementById('message').hidden")
    assert "Your corrections are in the file" in page.locator("#message").text_content()
    page.keyboard.press("Control+z")
    wait_until(page, "!document.getElementById('message').hidden")
    assert _edits(page) == ["drop 1"]
    assert read_corrections(str(result.out / "corrections.yaml")).edits[0].drop == 1


def test_two_tabs_see_each_others_changes(serve_video, open_page, wait_until):
    server = serve_video()
    first, second = open_page(server), open_page(server)
    _select(first, 0)
    first.keyboard.press("d")
    wait_until(second, f"{ROWS} === 1 && {NUM_EDITS} === 1")
    second.get_by_role("button", name="Undo").click()
    wait_until(first, f"{ROWS} === 2 && {NUM_EDITS} === 0")
    assert first.locator("#message").is_hidden() and second.locator("#message").is_hidden()


def test_an_edit_by_another_program_is_seen_before_one_of_the_page(serve_video, open_page, result, wait_until):
    page = open_page(serve_video())
    (result.out / "corrections.yaml").write_text("version: 1\nedits:\n  - drop: 2\n")
    _select(page, 0)
    page.keyboard.press("d")
    wait_until(page, f"{NUM_EDITS} === 1 && {ROWS} === 1")
    assert "changed by another program" in page.locator("#message").text_content()
    assert _edits(page) == ["drop 2"]
    assert read_corrections(str(result.out / "corrections.yaml")).edits[0].drop == 2


def test_everything_is_reached_by_keys(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    page.keyboard.press("?")
    page.locator("#help-dialog[open]").wait_for()
    page.keyboard.press("Escape")
    page.keyboard.press("1")
    page.keyboard.press("F2")
    page.keyboard.type("bear")
    page.keyboard.press("Enter")
    wait_until(page, f"{NUM_EDITS} === 1")
    page.locator("#picture").focus()
    page.keyboard.press("b")
    for key in ("ArrowRight", "Enter", "ArrowDown", "ArrowDown", "Enter"):
        page.keyboard.press(key)
    wait_until(page, f"{NUM_EDITS} === 2")
    assert _edits(page) == ["1 is called bear", "paint 1 in frame 0"]
    page.keyboard.press("Control+s")
    page.locator("#export-dialog[open]").wait_for()
    page.keyboard.press("Escape")
    assert page.evaluate("document.activeElement !== null") and page.faults == []
    stops = []
    page.locator("#undo").focus()
    for _ in range(40):
        page.keyboard.press("Tab")
        stops.append(page.evaluate("document.activeElement.id || document.activeElement.textContent"))
    assert {"picture", "frame", "row-1", "name", "command"} <= set(stops)


def test_changes_are_told_to_a_screen_reader(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    _select(page, 1)
    wait_until(page, "document.getElementById('announcer').textContent.includes('object 2 selected')")
    page.keyboard.press("d")
    wait_until(page, "document.getElementById('announcer').textContent.includes('object 2 dropped')")
    wait_until(page, "document.getElementById('picture').getAttribute('aria-label') === 'video, frame 0: objects 1'")
    row = page.locator(".row")
    assert row.get_attribute("role") == "option" and "frames 0 to 9" in row.get_attribute("aria-label")


def test_cues_are_layers(serve_video, open_page, wait_until):
    page = open_page(serve_video())
    names = page.locator("#cue option").all_text_contents()
    assert names == ["video", "motion saliency", "optical flow", "flow relative to the background"]
    before = page.evaluate(PIXEL, [0.9, 0.9])
    page.locator("#cue").select_option("0")
    wait_until(page, "document.getElementById('picture').getAttribute('aria-label').startsWith('motion saliency')")
    assert page.evaluate(PIXEL, [0.9, 0.9]) != before
    page.locator(".key").wait_for()
    assert page.faults == []


def test_nothing_is_cut_off_on_a_tablet(serve_video, open_page):
    page = open_page(serve_video())
    for width, height in ((1280, 800), (1024, 768), (820, 1180), (1180, 820)):
        page.set_viewport_size({"width": width, "height": height})
        assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
        for name in ("#picture", "#frame", ".row", "#selection", "#export"):
            page.locator(name).first.scroll_into_view_if_needed()
            box = page.locator(name).first.bounding_box()
            assert box["x"] >= 0 and box["x"] + box["width"] <= width, (width, name)
