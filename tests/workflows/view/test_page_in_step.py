"""The page keeps in step with its server, with another page and with the file of corrections."""

from moseg.workflows.config.corrections_file import read_corrections


def test_a_change_of_the_page_itself_is_not_fetched_again(serve_video, open_page):
    page = open_page(serve_video())
    asked = []
    page.on("request", lambda request: asked.append(request.url.rpartition("/")[2]))
    page.select(0)
    page.keyboard.press("d")
    page.wait_for(rows=1)
    page.keyboard.press("Control+z")
    page.wait_for(rows=2, areas=2)
    assert "undo" in asked and "state" not in asked


def test_two_tabs_see_each_others_changes(serve_video, open_page):
    server = serve_video()
    first, second = open_page(server), open_page(server)
    first.select(0)
    first.keyboard.press("d")
    second.wait_for(rows=1, edits=1)
    second.get_by_role("button", name="Undo").click()
    first.wait_for(rows=2, edits=0)
    assert first.locator("#message").is_hidden() and second.locator("#message").is_hidden()


def test_an_edit_by_another_program_is_seen_before_one_of_the_page(serve_video, open_page, result):
    page = open_page(serve_video())
    (result.out / "corrections.yaml").write_text("version: 1\nedits:\n  - drop: 2\n")
    page.select(0)
    page.keyboard.press("d")
    page.wait_for(edits=1, rows=1)
    assert "changed by another program" in page.locator("#message").text_content()
    assert page.edits() == ["drop 2"]
    assert read_corrections(str(result.out / "corrections.yaml")).edits[0].drop == 2


def test_a_server_that_is_gone_is_said_with_what_to_do(serve_video, open_page, result):
    server = serve_video()
    page = open_page(server)
    page.select(0)
    page.keyboard.press("d")
    page.wait_for(edits=1)
    server.process.kill()
    page.wait_until("!document.getElementById('message').hidden")
    assert "Your corrections are in the file" in page.locator("#message").text_content()
    page.keyboard.press("Control+z")
    page.wait_until("!document.getElementById('message').hidden")
    assert page.edits() == ["drop 1"]
    assert read_corrections(str(result.out / "corrections.yaml")).edits[0].drop == 1
