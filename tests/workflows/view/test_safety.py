"""Nothing is lost: killed servers, removed videos, stale edits, and what is open but not wanted."""

import json
import resource
import shlex
import shutil
import signal
import socket
from pathlib import Path

import pytest

from moseg.store import open_store
from moseg.workflows.config.corrections_file import read_corrections

OPTIONS = ("--section-length", "4", "--set", "sections.overlap=2")


def _edit(server, edit, revision=None):
    revision = server.state()["revision"] if revision is None else revision
    return server.ask("POST", "edits", {"revision": revision, "edit": edit})


def test_a_killed_server_loses_nothing(serve_video, result):
    server = serve_video()
    assert _edit(server, {"drop": 2}).status == 200
    server.process.kill()
    server.process.wait()
    assert read_corrections(str(result.out / "corrections.yaml")).edits[0].drop == 2
    state = serve_video().state()
    assert state["result"]["corrections"]["edits"] == ["drop 2"]
    assert [each["identity"] for each in state["result"]["objects"]] == [1]


@pytest.mark.parametrize(
    ("number", "code", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "term")]
)
def test_a_signal_ends_it_with_one_line(serve_video, number, code, word):
    server = serve_video("--quiet")
    code_, errors = server.end(number)
    assert code_ == code and word in errors and "Traceback" not in errors


def test_a_signal_ends_a_run_that_is_under_way(serve, segmented, tmp_path):
    arguments = (segmented.frames, "--out", tmp_path / "out", "--store", tmp_path / "store", "--section-length", "4")
    server = serve(*arguments, "--set", "sections.overlap=2", "--quiet")
    code, errors = server.end(signal.SIGTERM)
    assert code == 143 and "Traceback" not in errors


def test_an_edit_of_a_stale_revision_is_refused(serve_video, result):
    server = serve_video()
    revision = server.state()["revision"]
    assert _edit(server, {"drop": 2}, revision).status == 200
    refused = _edit(server, {"drop": 1}, revision)
    assert (refused.status, "changed in another tab" in refused.json()["message"]) == (409, True)
    assert len(read_corrections(str(result.out / "corrections.yaml")).edits) == 1


def test_a_wrong_edit_is_one_line_and_changes_nothing(serve_video, result):
    server = serve_video()
    before = server.state()
    for edit in (
        *({"drop": 9}, {"fly": 1}, None, {"merge": [1]}, {"drop": "x" * 9}, {"paint": {"object": 1, "frame": 0}}),
        {"split": {"object": 1, "frame": 99, "into": 5}},
    ):
        refused = _edit(server, edit)
        assert refused.status == 400 and "\n" not in refused.json()["message"], edit
        assert server.state() == before and not (result.out / "corrections.yaml").exists()


def test_a_video_that_is_removed_is_missed_only_where_it_is_needed(serve_video, result, tmp_path):
    frames = tmp_path / "squares" / "frames"
    shutil.copytree(result.frames, frames)
    server = serve_video("--quiet", frames=frames)
    shutil.rmtree(frames)
    assert _edit(server, {"drop": 2}).status == 200
    assert server.ask("GET", "frames/3").status == 200
    export = {"revision": server.state()["revision"], "sets": ["colmap"]}
    refused = server.ask("POST", "export", export)
    assert refused.status == 400 and str(frames) in refused.json()["message"]
    assert server.ask("POST", "export", {**export, "sets": []}).status == 200
    _, errors = server.end()
    assert [str(frames) in line for line in errors.splitlines()].count(True) == 1 and "Traceback" not in errors


@pytest.fixture
def damage(result, tmp_path):
    """Return the result with a copy of the store, and a function that flips a byte of each artifact of a stage."""
    store = tmp_path / "copied store"
    shutil.copytree(result.store, store)

    def flip(stage):
        for path in (store / "objects" / stage).rglob("arrays.zip"):
            content = bytearray(path.read_bytes())
            content[len(content) // 2] ^= 255
            path.write_bytes(content)

    return result._replace(store=store), flip


def test_a_damaged_or_lost_frame_and_mask_are_made_again(serve, damage):
    whole, flip = damage
    server = serve(whole.frames, "--out", whole.out, "--store", whole.store, *OPTIONS, "--quiet")
    key = server.wait("ready")["result"]["key"]
    addresses = {"frame": "frames/3", "proposals": f"labels/{key}/6", "saliency": "cues/0/5"}
    before = {stage: server.ask("GET", address).content for stage, address in addresses.items()}
    server.end()
    server = serve(whole.frames, "--out", whole.out, "--store", whole.store, *OPTIONS, "--quiet")
    server.wait("ready")
    for stage, address in addresses.items():
        flip(stage)
        answer = server.ask("GET", address)
        assert (answer.status, answer.content) == (200, before[stage]), (stage, answer.content[:200])
    shutil.rmtree(whole.store / "objects" / "frame")
    assert server.ask("GET", "frames/3").content == before["frame"]
    assert "Traceback" not in server.end()[1]


def test_a_damaged_frame_of_a_result_without_its_video_is_one_line(serve, damage):
    whole, flip = damage
    server = serve(whole.out, "--store", whole.store, "--quiet")
    server.wait("ready")
    flip("frame")
    answer = server.ask("GET", "frames/3")
    message = answer.json()["message"]
    assert answer.status == 500 and message.startswith("a part of the store cannot be read in frame/")
    assert f"`moseg view VIDEO --out {whole.out}`" in message and "\n" not in message
    # The rest of the page works on.
    assert _edit(server, {"drop": 2}).status == 200
    _, errors = server.end()
    assert errors.splitlines()[0] == f"moseg: {message}" and "Traceback" not in errors


def test_settings_of_a_folder_without_its_video_may_reach_the_frames(serve, result):
    file = result.out / "corrections.yaml"
    file.write_text("version: 1\nsettings:\n  components.min_area: 0.02\n")
    server = serve(result.out, "--store", result.store, "--quiet")
    assert server.wait("ready")["result"]["corrections"]["settings"] == ["components.min_area: 0.02"]


def test_only_pictures_of_the_result_that_was_asked_about_are_kept(serve_video):
    server = serve_video("--quiet")
    grid = server.ask("GET", f"grid/{server.state()['result']['key']}").json()
    address = f"thumbnails/2/{grid['objects']['2']['best']}?of="
    assert "immutable" in server.ask("GET", address + grid["objects"]["2"]["tag"]).headers["cache-control"]
    strokes = [{"radius": 6, "points": [[64, 48]]}]
    assert _edit(server, {"paint": {"object": 2, "frame": 5, "strokes": strokes}}).status == 200
    late = server.ask("GET", address + grid["objects"]["2"]["tag"])
    assert late.status == 200 and late.headers["cache-control"] == "no-store"


def test_several_processes_compute_the_same(serve_video, result, moseg, tmp_path):
    server = serve_video("--workers", "2", "--quiet")
    strokes = [{"radius": 6, "points": [[20, 20], [30, 25]]}]
    assert _edit(server, {"paint": {"object": 5, "frame": 5, "strokes": strokes}}).status == 200
    change = {"revision": server.state()["revision"], "name": "affinity.scale", "value": 0.43, "gesture": "a"}
    assert server.ask("POST", "settings", change).status == 200
    assert server.ask("POST", "export", {"revision": server.state()["revision"]}).status == 200
    code, errors = server.end()
    assert code == 143 and "Traceback" not in errors
    base = ("segment", result.frames, "--store", tmp_path / "other", "--out", tmp_path / "out", *OPTIONS, "--quiet")
    assert moseg(*base, "--corrections", result.out / "corrections.yaml").code == 0
    for path in sorted((result.out / "masks").iterdir()):
        assert path.read_bytes() == (tmp_path / "out" / "masks" / path.name).read_bytes()


def test_a_full_disk_is_one_line_and_nothing_changes(serve_video, result):
    server = serve_video("--quiet")
    assert _edit(server, {"drop": 2}).status == 200
    file, before = result.out / "corrections.yaml", server.state()
    content, (soft, hard) = file.read_bytes(), resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE)
    # From now on the system lets the process write nothing into any file, as on a full disk.
    resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, (0, hard))
    refused = _edit(server, {"drop": 1})
    assert refused.status == 400
    assert refused.json()["message"] == f"cannot write in {file}; got File too large"
    assert server.state() == before and file.read_bytes() == content
    # Neither a setting, whose result would be stored, nor an export is lost or done by half.
    setting = {"revision": before["revision"], "name": "affinity.scale", "value": 0.41, "gesture": "a"}
    for path, sent in (("settings", setting), ("export", {"revision": before["revision"]})):
        refused = server.ask("POST", path, sent)
        message = refused.json()["message"]
        assert refused.status in (400, 500) and "File too large" in message and "\n" not in message, message
        assert server.state() == before and file.read_bytes() == content
    resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, (soft, hard))
    # What was refused is in no export either.
    assert server.ask("POST", "export", {"revision": before["revision"]}).status == 200
    assert [each["identity"] for each in json.loads((result.out / "motion.json").read_text())["objects"]] == [1]
    assert _edit(server, {"drop": 1}).status == 200
    _, errors = server.end()
    assert errors.splitlines()[0] == f"moseg: cannot write in {file}; got File too large" and "Traceback" not in errors


def test_a_disk_that_is_full_while_a_video_is_dropped_in_is_one_line(serve, tmp_path):
    server = serve("--out", tmp_path / "new", "--store", tmp_path / "store", "--quiet")
    limits = resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE)
    resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, (1000, limits[1]))
    name = {"Content-Type": "application/octet-stream", "X-File-Name": "holiday.mp4"}
    refused = server.ask("PUT", "upload", b"x" * 5000, name)
    assert refused.status == 400 and "File too large" in refused.json()["message"]
    assert not [path for path in (tmp_path / "new").rglob("*") if path.is_file()]
    assert server.state()["phase"] == "empty"


def test_results_of_another_video_are_one_line(serve, result, write_squares, tmp_path):
    other = write_squares(tmp_path / "other", seed=1) / "frames"
    server = serve(other, "--out", result.out, "--store", result.store)
    state = server.wait("failed")
    assert "results of another video" in state["message"] and "\n" not in state["message"]


def test_a_port_in_use_is_one_line(moseg, tmp_path):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        ran = moseg("view", "--port", port, "--out", tmp_path, "--store", tmp_path / "store", "--no-browser")
    assert ran.code == 2 and ran.err.count("\n") == 1 and str(port) in ran.err


def test_missing_libraries_are_named_with_their_installation(moseg, monkeypatch, tmp_path):
    from moseg.workflows.view import start

    monkeypatch.setattr(start, "find_spec", lambda name: None if name == "uvicorn" else object())
    ran = moseg("view", "--out", tmp_path, "--store", tmp_path / "store", "--no-browser")
    assert ran.code == 2 and "uvicorn" in ran.err and "pip install 'moseg[view]'" in ran.err


@pytest.mark.parametrize("what", ["missing.mp4", "20200101T0000", "-", "latest"])
def test_what_cannot_be_opened_is_one_line(moseg, what, in_empty_folder):
    ran = moseg("view", what, "--no-browser")
    assert ran.code == 2 and ran.err.count("\n") == 1


@pytest.mark.parametrize("what", ["1999", "199901", "19990101", "19990101T", "19990101T1200", "19990101T120000-3f"])
def test_a_beginning_of_a_runs_name_is_looked_up_as_a_run(moseg, result, what):
    ran = moseg("view", what, "--out", result.out, "--store", result.store, "--no-browser")
    assert (ran.code, ran.err.count("\n")) == (2, 1)
    assert "no such run" in ran.err and repr(what) in ran.err


def test_a_run_opens_by_the_beginning_of_its_name(serve, segmented, tmp_path, moseg):
    files = ("--out", tmp_path / "out", "--store", tmp_path / "store", "--quiet")
    assert moseg("segment", segmented.frames, *files, "--section-length", "4").code == 0
    (run_id,) = open_store(str(tmp_path / "store"), create=False).logs()
    server = serve(run_id[:6], *files)
    assert server.wait("ready")["name"] == "frames"


def test_a_file_that_is_named_as_a_run_begins_is_a_file(moseg, result, in_empty_folder):
    Path("2026").write_text("no video")
    ran = moseg("view", "2026", "--out", result.out, "--store", result.store, "--no-browser")
    assert ran.code == 2 and "not a video in " in ran.err


def test_a_folder_of_results_and_a_run_open_without_the_video(serve, segmented, result):
    for what in (result.out, "latest", "latest"):
        server = serve(what, "--out", result.out, "--store", result.store, "--quiet")
        shown = server.wait("ready")["result"]
        assert (shown["numFrames"], shown["width"], shown["height"]) == (10, 128, 96)
        assert [each["identity"] for each in shown["objects"]] == [1, 2]
        assert shown["hasVideo"] is False
        # Another page, or this process, may have made the run. What a page computes is a run of its own: the command
        # of one that continues it names its video, not the folder or the run that was opened.
        words = shlex.split(shown["command"])
        assert words[:2] == ["moseg", "segment"] and (words[2] == "VIDEO" or words[2].endswith("squares/frames"))
        assert words[-2:] == ["--out", str(result.out)] and "--no-browser" not in words
        assert _edit(server, {"drop": 1}).status == 200
        assert server.ask("POST", "undo", {"revision": server.state()["revision"]}).status == 200
        server.end()


def test_a_video_is_dropped_in(serve, result, tmp_path, moseg):
    assert (result.out / "overlay.mp4").exists()
    content = (result.out / "overlay.mp4").read_bytes()
    server = serve("--out", tmp_path / "new", "--store", tmp_path / "store", "--section-length", "4", "--quiet")
    name = {"Content-Type": "application/octet-stream", "X-File-Name": "..%2F..%2Fholi%20day.mp4"}
    assert server.ask("PUT", "upload", content, name).status == 200
    state = server.wait("ready")
    assert state["name"] == "holi_day" and (tmp_path / "new" / "input" / "holi_day.mp4").read_bytes() == content
    assert (tmp_path / "new" / "motion.json").exists()
    assert server.ask("PUT", "upload", content, name).status == 400


def test_a_dropped_file_that_is_no_video_is_one_line(serve, tmp_path):
    server = serve("--out", tmp_path / "new", "--store", tmp_path / "store", "--quiet")
    name = {"Content-Type": "application/octet-stream", "X-File-Name": "page.mp4"}
    assert server.ask("PUT", "upload", b"<html>", name).status == 200
    message = server.wait("empty")["message"]
    assert message and "\n" not in message
    assert not (tmp_path / "new" / "input").exists()
    # Another one may be dropped in.
    assert server.ask("PUT", "upload", b"x", {**name, "X-File-Name": "x.py"}).status == 400
    assert server.ask("PUT", "upload", b"<html>", name).status == 200


def test_only_the_dropped_file_that_is_refused_is_removed(serve, result, tmp_path):
    folder = result.out / "input"
    folder.mkdir()
    (folder / "clip.mp4").write_bytes(b"of before")
    server = serve("--out", result.out, "--store", tmp_path / "store", "--quiet")
    name = {"Content-Type": "application/octet-stream", "X-File-Name": "clip.mp4"}
    # The second one is a video, but the folder has results of another one.
    for content in (b"<html>", (result.out / "overlay.mp4").read_bytes()):
        assert server.ask("PUT", "upload", content, name).status == 200
        assert server.wait("empty")["message"]
        assert [(path.name, path.read_bytes()) for path in folder.iterdir()] == [("clip.mp4", b"of before")]
