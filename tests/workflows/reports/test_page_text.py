"""The report page as text, without a browser."""

import re
from importlib.resources import files

import pytest

from moseg.schemas.scores import SequenceScore
from moseg.workflows.reports.content import StageRow
from moseg.workflows.reports.page import render_page
from moseg.workflows.reports.score_tables import clip_tables, score_tables

SCORE = SequenceScore(P=1, R=2, F=3, J=4, boundary_F=5, J_objects=6, boundary_F_objects=7)
POINTS = SequenceScore(P=1, R=2, F=3, J=4, J_objects=6)


def test_each_picture_lies_in_the_page_once(make_page):
    text = render_page(make_page("dog"))
    pictures = re.findall(r'id="pictures-0">(.*?)</script>', text)
    assert len(pictures) == 1 and pictures[0].count("data:image/png") == 19
    assert text.count("data:video") == 0 and text.count('id="video-0"') == 1


def test_an_empty_report_is_a_page(make_page):
    page = make_page("dog")
    bare = page.sequences[0]._replace(
        frames=(), layers=(), objects=(), variants=(), video=None, missing=("No <frame>.",)
    )
    text = render_page(page._replace(scores=(), sequences=(bare,), stages=(), parameters=(), notes=()))
    assert "Every parameter has its default." in text
    assert "No &lt;frame&gt;." in text
    assert "<h1>davis16: fused, trajs</h1>" in text


def test_shares_reused_and_bars_are_of_the_whole(make_page):
    stages = StageRow("flow", 30, 10, 60.0), StageRow("depth", 0, 40, 0.0), StageRow("tracks", 1, 0, 15)
    text = render_page(make_page("dog")._replace(stages=stages))
    assert "62 %</b> of 81 artifacts reused: 50 read from the store, 31 computed in 1 min 15 s of work." in text
    assert '<rect class="part" width="61.7"' in text and 'aria-label="62 percent reused"' in text
    assert re.findall(r'<td class="bar"><svg[^>]*><rect width="([^"]*)"', text) == ["100.0", "0.0", "25.0"]
    assert "artifacts reused" not in render_page(make_page("dog")._replace(stages=()))


def test_stages_without_time_have_a_dash(make_page):
    text = " ".join(render_page(make_page("dog")).split())
    assert '<th scope="row">ingest</th><td>26</td><td>–</td><td>–</td>' in text
    assert "56 computed in 1 min 01 s of work." in text
    short = render_page(make_page("dog")._replace(stages=(StageRow("flow", 30, 0, 0.05),)))
    assert "30 computed in 50 ms of work." in short and "<td>50 ms</td>" in short
    untimed = make_page("dog")._replace(stages=(StageRow("ingest", 26, 0, 0.0),))
    assert "26 computed.</p>" in render_page(untimed)


@pytest.mark.parametrize(
    "tables",
    [
        score_tables("davis-moving", "pixels", {"fused": {"dog": SCORE}}),
        score_tables("kt3dinsmoseg", "points", {"fused": {"clip": POINTS}}),
        clip_tables("kt3dmoseg", ()),
    ],
    ids=["below ours", "over something else", "clips"],
)
def test_published_figures_are_marked_once_with_their_extent(make_page, tables):
    text = " ".join(re.sub("<[^>]+>", " ", render_page(make_page("dog")._replace(scores=tables))).split())
    assert text.count("not measured here") == 1
    assert re.search(
        r"(for the whole data set|for all 22 clips, number of motions given)( percent, over pixels)? published, not",
        text,
    )


def test_names_that_are_not_unicode_are_escaped(make_page):
    assert "<h3>dog\\udcff</h3>" in render_page(make_page("dog\udcff")).encode().decode()


def test_template_style_and_script_are_part_of_the_package():
    names = {entry.name for entry in files("moseg.workflows.reports.page").iterdir()}
    assert {"page.html", "page.css", "page.js"} <= names
