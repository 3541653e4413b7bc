"""The report page in light and dark, on a phone, by keyboard, without scripts, with many sequences."""

import itertools
import re

import pytest

from moseg.schemas.scores import SequenceScore
from moseg.workflows.reports.page import render_page
from moseg.workflows.reports.score_tables import score_tables

PHONE = {"width": 360, "height": 740}
BODY_TEXT = (
    "h1, h3, .facts dd, .scores td, .scores th, .published td, .best, .muted, .tag, .tick, .tabs button, figcaption"
)
# Text against the first opaque ground behind it, by WCAG 2.
CONTRASTS = """selector => [...document.querySelectorAll(selector)].map(element => {
  const numbers = colour => colour.match(/[\\d.]+/g).map(Number);
  const luminance = colour => {
    const [r, g, b] = numbers(colour).map(v => v / 255).map(v => v <= .04045 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4);
    return .2126 * r + .7152 * g + .0722 * b;
  };
  const style = getComputedStyle(element);
  const isClear = node => numbers(getComputedStyle(node).backgroundColor)[3] === 0;
  let ground = element;
  while (ground.parentElement && isClear(ground)) ground = ground.parentElement;
  const ink = element instanceof SVGElement ? style.fill : style.color;
  const pair = [luminance(ink), luminance(getComputedStyle(ground).backgroundColor)].sort((a, b) => b - a);
  return [element.tagName + '.' + (element.getAttribute('class') ?? ''), (pair[0] + .05) / (pair[1] + .05)];
})"""


@pytest.fixture
def open_page(open_report, make_page):
    return lambda **options: open_report(make_page("dog", "cat"), **options)


def test_the_theme_is_switched_without_storage(new_page, make_page, tmp_path):
    path = tmp_path / "report.html"
    path.write_text(render_page(make_page("dog")), encoding="utf-8")
    page = new_page(color_scheme="light")
    page.add_init_script("Object.defineProperty(window, 'localStorage', {get() { throw new Error('none') }})")
    page.goto(path.as_uri())
    ground = "getComputedStyle(document.body).backgroundColor"
    light = page.evaluate(ground)
    page.get_by_role("button", name="switch to dark colours").click()
    assert page.evaluate(ground) != light
    page.get_by_role("button", name="switch to light colours").click()
    assert page.evaluate(ground) == light


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_has_enough_contrast(open_page, scheme):
    page = open_page(color_scheme=scheme)
    contrasts = page.evaluate(CONTRASTS, BODY_TEXT + ", .heat-map td")
    assert len(contrasts) > 40
    assert [(name, round(ratio, 2)) for name, ratio in contrasts if ratio < 4.5] == []
    assert (
        sum(int(part) for part in re.findall(r"\d+", page.evaluate("getComputedStyle(document.body).color"))) > 382
    ) == (scheme == "dark")


def test_a_phone_scrolls_vertically_only(open_page):
    page = open_page(viewport=PHONE)
    for tab in (0, 1):
        page.locator("[role=tab]").nth(tab).click()
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]


def test_published_figures_are_marked_within_the_width_of_a_phone(open_report, make_page):
    score = SequenceScore(P=1, R=2, F=3, J=4, boundary_F=5, J_objects=6, boundary_F_objects=7)
    tables = score_tables("davis-moving", "pixels", {"fused": {"dog": score}})
    page = open_report(make_page("dog")._replace(scores=tables), viewport=PHONE)
    table = page.locator("#scores .scroll")
    ends = "table => [...table.querySelectorAll('.tag, .caption-title')].map(e => e.getBoundingClientRect().right)"
    for far in (0, 1000):
        table.evaluate("(table, far) => { table.scrollLeft = far }", far)
        assert len(table.evaluate(ends)) == 2 and max(table.evaluate(ends)) <= PHONE["width"]
    assert table.evaluate("table => table.scrollLeft") > 0


def test_the_tab_key_reaches_every_control_with_a_visible_focus(open_page):
    page = open_page()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    wanted, reached = {"frame-slider", "opacity-slider", "button theme-toggle needs-script"}, set()
    for _ in range(60):
        page.keyboard.press("Tab")
        name, outline = page.evaluate(
            "[document.activeElement.className, getComputedStyle(document.activeElement).outlineStyle]"
        )
        reached.add(name)
        # The buttons within a video are the browser's own.
        assert outline != "none" or page.evaluate("document.activeElement.tagName") == "VIDEO"
    assert wanted <= reached


def test_without_scripts_tables_matrices_and_a_frame_are_visible(open_page):
    page = open_page(java_script_enabled=False)
    assert page.locator("table.scores").is_visible()
    assert page.locator(".still img").first.is_visible()
    assert page.locator(".still figcaption").first.text_content().startswith("Frame 8: frame, moving objects")
    assert all(page.locator("[role=tabpanel]").nth(number).is_visible() for number in range(3))
    assert page.locator("table.heat-map").first.is_visible()
    assert not page.locator(".transport").first.is_visible()


def test_headings_skip_no_level(open_page):
    page = open_page()
    levels = page.evaluate("[...document.querySelectorAll('h1,h2,h3,h4,h5,h6')].map(h => Number(h.tagName[1]))")
    assert levels.count(1) == 1 and levels[0] == 1
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels))
    assert page.locator("img:not([alt])").count() == 0
    assert page.evaluate("document.documentElement.lang") == "en"


def test_many_sequences_are_folded_and_filtered(new_page, make_page, tmp_path):
    path = tmp_path / "many.html"
    path.write_text(render_page(make_page(*(f"scene {number}" for number in range(9)))), encoding="utf-8")
    page = new_page()
    page.goto(path.as_uri())
    sequences = page.locator("details.sequence")
    assert [sequences.nth(number).get_attribute("open") is not None for number in range(9)] == [True] * 3 + [False] * 6
    page.locator("#filter").fill("SCENE 7")
    assert [number for number in range(9) if sequences.nth(number).is_visible()] == [7]
    assert page.locator("#filter-count").text_content() == "1 of 9"
    page.locator(".jump a:visible").click()
    page.locator("#sequence-7 canvas[data-frame]").first.wait_for()
