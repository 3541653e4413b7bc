"""Doubts about a result on its page: those of the summary, each with the way to its frame."""

import json

import pytest

DOUBT = "object 1 rests in frames 3 to 6"


@pytest.fixture
def doubted(result):
    """Return the result with a doubt in its summary."""
    file = result.out / "motion.json"
    summary = json.loads(file.read_text())
    file.write_text(json.dumps({**summary, "look_at": [DOUBT]}))
    return result


def test_the_page_has_what_the_summary_names_until_it_is_written_again(serve_video, doubted):
    server = serve_video()
    state = server.state()
    assert state["result"]["lookAt"] == [DOUBT]
    answer = server.ask("POST", "export", {"revision": state["revision"], "overlay": "none"})
    assert answer.status == 200, answer.content
    written = json.loads((doubted.out / "motion.json").read_text())["look_at"]
    assert written != [DOUBT]
    state = server.state()
    assert state["result"]["lookAt"] == written
    assert server.ask("POST", "edits", {"revision": state["revision"], "edit": {"drop": 1}}).status == 200


def test_a_doubt_leads_to_its_frame(serve_video, open_page, doubted):
    page = open_page(serve_video())
    entry = page.locator("#look-at li")
    assert entry.count() == 1 and DOUBT in entry.text_content()
    entry.get_by_role("button", name="Go to 3").click()
    page.wait_until("document.getElementById('picture').dataset.frame === '3'")
    assert page.faults == []


def test_a_result_without_doubts_has_no_such_section(serve_video, open_page):
    page = open_page(serve_video())
    assert not page.locator("#look-at").is_visible()
