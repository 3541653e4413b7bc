"""The report page in a browser: pictures, controls, and no other code or request."""

import io
import zipfile

import numpy as np
import pytest
from PIL import Image

from moseg.workflows.reports.page import render_page

HOSTILE = '</script><script>window.ran=1</script><img src=x onerror="window.ran=1">\'"<!--'
NAMES = ("dog", HOSTILE)
MIDDLE = 2
FRAMES = (0, 4, 8, 12)
# How bright the frame is that the video shows; null while it seeks.
VIDEO_LEVEL = """() => {
  const video = document.querySelector('video');
  if (video.seeking) return null;
  const context = new OffscreenCanvas(1, 1).getContext('2d');
  context.drawImage(video, 0, 0, 1, 1);
  return context.getImageData(0, 0, 1, 1).data[0];
}"""


@pytest.fixture
def open_page(open_report, make_page):
    return lambda **options: open_report(make_page(*NAMES), **options)


def _pixel(page, pane: int, x: int) -> list[int]:
    script = (
        "([pane, x]) => [...document.querySelectorAll('canvas')[pane].getContext('2d').getImageData(x, 20, 1, 1).data]"
    )
    return page.evaluate(script, [pane, x])[:3]


def _shows(page, frame: int) -> None:
    page.wait_for_selector(f"canvas[data-frame='{frame}']")
    assert page.locator(".frame-number b").first.text_content() == str(frame)


def test_it_loads_without_errors_and_requests_nothing(new_page, make_page, tmp_path, wait_until):
    path = tmp_path / "report.html"
    path.write_text(render_page(make_page(*NAMES)), encoding="utf-8")
    page = new_page()
    faults, requests = [], []
    page.on("console", lambda message: faults.append(message.text))
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(path.as_uri())
    page.wait_for_selector("canvas[data-frame]")
    wait_until(page, "document.querySelector('video').readyState >= 1")
    assert faults == []
    assert [url for url in requests if not url.startswith(("data:", "blob:"))] == [path.as_uri()]


def test_hostile_names_are_text(open_page, wait_until):
    page = open_page()
    assert page.evaluate("window.ran") is None
    assert page.locator("h3").all_text_contents() == list(NAMES)
    page.locator("details.sequence").nth(1).scroll_into_view_if_needed()
    wait_until(page, "document.querySelectorAll('canvas[data-frame]').length === 4")
    assert page.evaluate("window.ran") is None
    assert page.locator("img[src=x]").count() == 0


def test_the_slider_changes_both_pictures_and_the_number(open_page):
    page = open_page()
    slider = page.locator(".frame-slider").first
    _shows(page, FRAMES[MIDDLE])
    assert _pixel(page, 0, 50) == [120, 120, 120]
    slider.fill("12")
    _shows(page, 12)
    assert _pixel(page, 0, 50) == _pixel(page, 1, 50) == [160, 160, 160]
    slider.fill("0")
    _shows(page, 0)
    assert slider.get_attribute("aria-valuetext") == "frame 0"
    for name, frame in (("next frame", 1), ("next pictured frame", 4), ("previous frame", 3), ("next frame", 4)):
        page.get_by_role("button", name=name, exact=True).first.click()
        _shows(page, frame)
    slider.focus()
    page.keyboard.press("ArrowRight")
    _shows(page, 5)


def test_frames_without_pictures_show_the_video_beside_the_mask(open_page):
    page = open_page()
    for frame in (5, 11, 1):
        page.locator(".frame-slider").first.fill(str(frame))
        _shows(page, frame)
        assert _pixel(page, 0, 50)[0] == pytest.approx(10 * frame, abs=5)
        assert _pixel(page, 1, 10) == [128, 0, 0] and _pixel(page, 1, 50) == [0, 0, 0]
    assert page.locator(".pane-caption").all_text_contents()[:2] == ["video", "mask"]


def test_the_end_of_an_earlier_seek_is_not_taken_for_that_of_a_later_one(open_page):
    page = open_page()
    page.locator(".frame-slider").first.fill("5")
    _shows(page, 5)
    video = page.locator("video").first
    # As under load: the end of a seek is reported while the next one has begun.
    video.evaluate(
        """async (video) => {
          Object.defineProperty(video, "seeking", { value: true, configurable: true });
          const ended = new Promise((resolve) => video.addEventListener("seeked", resolve, { once: true }));
          const slider = document.querySelector(".frame-slider");
          slider.value = 11;
          slider.dispatchEvent(new Event("input"));
          await ended;
          for (let turn = 0; turn < 4; turn++) await new Promise(requestAnimationFrame);
        }"""
    )
    frame_while_seeking = page.locator("canvas").first.get_attribute("data-frame")
    video.evaluate("(video) => { delete video.seeking; video.dispatchEvent(new Event('seeked')); }")
    _shows(page, 11)
    assert frame_while_seeking == "5"
    assert _pixel(page, 0, 50)[0] == pytest.approx(110, abs=5)


def test_where_the_browser_cannot_decode_the_video_the_mask_is_shown(open_report, make_page):
    report = make_page("dog")
    panel = report.sequences[0]
    broken = panel._replace(video=panel.video._replace(data=b"no video"))
    page = open_report(report._replace(sequences=(broken,)))
    for frame in (5, 11):
        page.locator(".frame-slider").fill(str(frame))
        _shows(page, frame)
        assert _pixel(page, 1, 10) == [128, 0, 0]
    assert page.locator(".pane-caption").all_text_contents() == ["video (none for this frame)", "mask"]
    page.locator(".frame-slider").fill("12")
    _shows(page, 12)
    assert _pixel(page, 0, 50) == [160, 160, 160]


def test_a_slider_says_which_frames_it_has(open_report, make_page):
    def said(report):
        page = open_report(report)
        slider = page.locator(".frame-slider")
        assert page.locator(f"#{slider.get_attribute('aria-describedby')}").is_visible()
        return page.locator(".reach").text_content(), int(slider.get_attribute("max")) + 1

    beside = "4 have pictures of all layers; the others show the video and the masks."
    assert said(make_page("dog")) == (f"The slider has every frame. {beside}", 13)
    # Every second of 13 frames, which include the pictured ones.
    assert said(make_page("dog", video_step=2)) == (f"The slider has 7 of 13 frames and skips 6. {beside}", 7)
    report = make_page("dog")
    bare = report.sequences[0]._replace(video=None, masks=None)
    assert said(report._replace(sequences=(bare,))) == ("The slider has 4 of 13 frames and skips 9.", 4)


def test_timelines_lead_to_the_frames_where_a_mask_changes(open_page):
    page = open_page()
    first = page.locator(".timeline").first
    assert first.locator(".change-jump").all_text_contents() == [
        "6 shrinks to 31 %",
        "11 splits into 2 parts, at the edge",
    ]
    first.get_by_role("button", name="splits into 2 parts").focus()
    page.keyboard.press("Enter")
    _shows(page, 11)
    assert first.locator(".change-jump[aria-current]").text_content().startswith("11")
    assert first.locator(".playhead").get_attribute("x1") == "11.5"
    area = first.locator(".area")
    area.click(position={"x": area.bounding_box()["width"] * 3.5 / 13, "y": 5})
    _shows(page, 3)
    thumbnails = first.locator("button.thumbnail")
    assert [each.get_attribute("tabindex") for each in thumbnails.all()] == ["0", "-1"]
    thumbnails.first.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    _shows(page, 10)


def test_masks_are_downloaded_as_they_are(open_page, tmp_path):
    page = open_page()
    for number, name in (
        (0, "dog_masks.zip"),
        (1, "script_script_window.ran_1_script_img_src_x_onerror_window.ran_1_masks.zip"),
    ):
        page.locator("details.sequence").nth(number).scroll_into_view_if_needed()
        page.locator("canvas[data-frame]").nth(2 * number).wait_for()
        with page.expect_download() as download:
            page.get_by_role("button", name="Download masks").nth(number).click()
        assert download.value.suggested_filename == name
    with zipfile.ZipFile(download.value.path()) as archive:
        assert archive.namelist() == [f"{frame:05d}.png" for frame in range(13)]
        assert archive.testzip() is None
        mask = np.asarray(Image.open(io.BytesIO(archive.read("00003.png"))))
    assert (mask[:, :32] == 1).all() and (mask[:, 32:] == 0).all()


def test_playing_continues_until_it_is_paused(open_page):
    page = open_page()
    page.get_by_role("button", name="play", exact=True).first.click()
    for frame in (12, 0, 4):
        page.wait_for_selector(f"canvas[data-frame='{frame}']")
    page.get_by_role("button", name="pause").first.click()
    stopped = page.locator(".frame-number b").first.text_content()
    page.wait_for_timeout(400)
    assert page.locator(".frame-number b").first.text_content() == stopped


def test_errors_lie_beside_what_was_found(open_page):
    page = open_page()
    assert _pixel(page, 0, 10) == [230, 0, 0]
    assert _pixel(page, 1, 10) == [255, 160, 40]
    assert page.locator(".pane-caption").all_text_contents()[:2] == ["frame + moving objects", "frame + errors"]


def test_layers_are_chosen_for_each_picture(open_page, wait_until):
    page = open_page()
    page.get_by_label("moving objects in pane A").first.uncheck()
    wait_until(page, "document.querySelector('.pane-caption').textContent === 'frame'")
    assert _pixel(page, 0, 10) == [120, 120, 120]
    page.get_by_label("optical flow in pane A").first.check()
    wait_until(page, "document.querySelector('.pane-caption').textContent === 'optical flow'")
    assert _pixel(page, 0, 10) == [0, 0, 200]
    page.locator(".frame-slider").first.fill("12")
    _shows(page, 12)
    assert page.locator(".pane-caption").first.text_content() == "optical flow (none for this frame)"
    page.locator(".opacity-slider").first.fill("0")
    wait_until(
        page, "document.querySelectorAll('canvas')[1].getContext('2d').getImageData(10, 20, 1, 1).data[0] === 160"
    )


def test_the_video_plays_in_the_browser_and_follows_the_slider(open_page, wait_until):
    page = open_page()
    wait_until(page, "document.querySelector('video').readyState >= 2")
    assert page.evaluate("document.querySelector('video').duration") == pytest.approx(13 / 12, abs=0.05)
    page.locator(".frame-slider").first.fill("12")
    wait_until(page, "Math.abs(document.querySelector('video').currentTime - 12.5 / 12) < 0.05")
    assert page.evaluate("document.querySelector('video').videoWidth") == 64
    assert page.evaluate("document.querySelector('video').muted")


@pytest.mark.parametrize(("step", "caption"), [(1, "Every frame, moving"), (2, "One frame in 2, moving")])
def test_the_video_is_at_the_frame_of_the_slider_and_its_caption_names_its_frames(
    open_report, make_page, wait_until, step, caption
):
    page = open_report(make_page("dog", video_step=step))
    wait_until(page, "document.querySelector('video').readyState >= 2")
    assert page.locator(".video figcaption").text_content().startswith(caption)
    for frame in reversed(FRAMES):
        page.locator(".frame-slider").fill(str(frame // step))
        _shows(page, frame)
        wait_until(page, f"({VIDEO_LEVEL})() !== null && Math.abs(({VIDEO_LEVEL})() - {10 * frame}) < 5")


def test_groups_of_motions_have_the_colours_of_their_objects(open_page):
    page = open_page()
    swatches = "panel => [...panel.querySelectorAll('.motions .entry')].map(entry => "
    swatches += "[entry.textContent, entry.querySelector('rect')?.getAttribute('fill') ?? null])"
    panels = page.locator("#sequence-0 .variant")
    assert panels.nth(0).evaluate(swatches) == [["background", None], ["2 dog", None], ["1", "#e60000"]]
    assert panels.nth(1).evaluate(swatches) == [["background", None], ["1", None], ["2 dog", "#00a000"]]


def test_tabs_react_to_clicks_and_arrows(open_page):
    page = open_page()
    tabs, panels = page.locator("[role=tab]"), page.locator("[role=tabpanel]")

    def shown() -> list[int]:
        return [number for number in range(3) if panels.nth(number).is_visible()]

    assert shown() == [0]
    tabs.nth(1).click()
    assert shown() == [1]
    assert tabs.nth(1).get_attribute("aria-selected") == "true"
    for key, expected in (("ArrowRight", 2), ("ArrowRight", 0), ("End", 2), ("ArrowLeft", 1)):
        page.keyboard.press(key)
        assert shown() == [expected]
        assert page.evaluate("document.activeElement.textContent") == ("fused", "trajs", "base")[expected]


def test_arrows_move_within_a_matrix(open_page):
    page = open_page()
    figure = page.locator("figure.matrix").first
    figure.locator("tbody td").first.focus()
    page.keyboard.press("ArrowRight")
    value = figure.locator("tbody td").nth(1).text_content()
    assert figure.locator(".readout").text_content() == f"background × 1: {value} px"
    assert figure.locator("tbody td").first.get_attribute("class") == "nan"


def test_the_plot_marks_the_number_of_motions(open_page):
    page = open_page()
    plot = page.locator("figure.plot").first
    assert plot.locator("circle").count() == 4
    assert plot.locator("circle.is-chosen").count() == 2
    assert plot.locator(".cut-label").text_content() == "2 motions"
    assert page.locator("figure.plot").nth(1).locator(".series").count() == 2


def test_best_measured_values_are_marked(open_page):
    page = open_page()
    assert [text.split(" ")[0] for text in page.locator(".best").all_text_contents()] == ["78.3", "86.2"]
    published = page.locator("tbody.published")
    assert (
        " ".join(published.locator(".group-title").text_content().split()) == "the paper published, not measured here"
    )
    assert published.locator("td").all_text_contents() == ["99.9", "99.8", "99.7"]
