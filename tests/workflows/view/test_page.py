"""The page in a browser: what it shows, by the mouse, by keys, to a screen reader and on a tablet."""

import pytest

HOSTILE = '<img src=x onerror="window.ran=1">\'&amp;'


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
        assert page.pixel(0.5, 0.5) == pytest.approx(list(expected), abs=12)
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


def test_a_frame_that_cannot_be_read_is_blank_with_one_line(serve_video, open_page):
    page = open_page(serve_video())
    message = {"status": 500, "content_type": "application/json", "body": '{"message": "a part cannot be read"}'}
    page.route("**/frames/7*", lambda route: route.fulfill(**message))
    page.locator("#frame").fill("7")
    page.wait_for_selector("canvas[data-frame='7']")
    assert page.locator("#message p").text_content() == "Frame 7 cannot be shown: a part cannot be read"
    assert page.pixel(0.5, 0.5) == [0, 0, 0]
    page.locator("#frame").fill("8")
    page.wait_for_selector("canvas[data-frame='8']")
    assert page.locator("#message").is_hidden() and page.pixel(0.5, 0.5) != [0, 0, 0]


def test_cues_are_layers(serve_video, open_page):
    page = open_page(serve_video())
    names = page.locator("#cue option").all_text_contents()
    assert names == ["video", "motion saliency", "optical flow", "flow relative to the background"]
    before = page.pixel(0.9, 0.9)
    page.locator("#cue").select_option("0")
    page.wait_until("document.getElementById('picture').getAttribute('aria-label').startsWith('motion saliency')")
    assert page.pixel(0.9, 0.9) != before
    page.locator(".key").wait_for()
    assert page.faults == []


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


def test_the_affinities_have_the_names_of_the_objects(serve_video, open_page):
    page = open_page(serve_video())
    page.keyboard.press("1")
    page.locator("#name").fill(HOSTILE)
    page.keyboard.press("Enter")
    page.wait_for(edits=1)
    page.locator("summary").click()
    page.locator(".matrix").first.wait_for()
    heads = page.locator(".matrix").first.locator("thead th").all_text_contents()
    assert heads == ["background", f"1 {HOSTILE}", "2"] and page.evaluate("window.ran") is None


def test_formats_with_frames_say_why_they_are_not_offered(serve, serve_video, result, open_page):
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
    other = open_page(serve_video("--quiet"))
    other.get_by_role("button", name="Export…").click()
    assert other.locator("#why-disabled").count() == 0 and other.locator("#export-dialog input:disabled").count() == 0


def test_everything_is_reached_by_keys(serve_video, open_page):
    page = open_page(serve_video())
    page.keyboard.press("?")
    page.locator("#help-dialog[open]").wait_for()
    page.keyboard.press("Escape")
    page.keyboard.press("1")
    page.keyboard.press("F2")
    page.keyboard.type("bear")
    page.keyboard.press("Enter")
    page.wait_for(edits=1)
    page.locator("#picture").focus()
    page.keyboard.press("b")
    for key in ("ArrowRight", "Enter", "ArrowDown", "ArrowDown", "Enter"):
        page.keyboard.press(key)
    page.wait_for(edits=2)
    assert page.edits() == ["1 is called bear", "paint 1 in frame 0"]
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


def test_changes_are_told_to_a_screen_reader(serve_video, open_page):
    page = open_page(serve_video())
    page.select(1)
    page.wait_until("document.getElementById('announcer').textContent.includes('object 2 selected')")
    page.keyboard.press("d")
    page.wait_until("document.getElementById('announcer').textContent.includes('object 2 dropped')")
    page.wait_until("document.getElementById('picture').getAttribute('aria-label') === 'video, frame 0: objects 1'")
    row = page.locator(".row")
    assert row.get_attribute("role") == "option" and "frames 0 to 9" in row.get_attribute("aria-label")


def test_nothing_is_cut_off_on_a_tablet(serve_video, open_page):
    page = open_page(serve_video())
    for width, height in ((1280, 800), (1024, 768), (820, 1180), (1180, 820)):
        page.set_viewport_size({"width": width, "height": height})
        assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
        for name in ("#picture", "#frame", ".row", "#selection", "#export"):
            page.locator(name).first.scroll_into_view_if_needed()
            box = page.locator(name).first.bounding_box()
            assert box["x"] >= 0 and box["x"] + box["width"] <= width, (width, name)
