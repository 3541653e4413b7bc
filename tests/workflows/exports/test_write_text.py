"""Text files are not written over files of another kind."""

import os

import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.exports import TextKind, check_replaceable
from moseg.workflows.process.atomic_write import atomic_path

PAGE, JSON, YAML = b"<!DOCTYPE html>\n<title>", b' {"name": 1}', "# größer\nmax_side: 200\n".encode()
VIDEO, IMAGE = b"\0\0\0 ftypisom", b"\x89PNG\r\n\x1a\n\0\0"


@pytest.mark.parametrize(
    ("kind", "own", "others"),
    [
        (TextKind.PAGE, PAGE, (JSON, YAML, VIDEO, IMAGE)),
        (TextKind.JSON, JSON, (PAGE, YAML, VIDEO, IMAGE)),
        (TextKind.YAML, YAML, (PAGE, JSON, VIDEO, IMAGE, b"import this\n", b"x, y\n1, 2\n", b"2020-99-99")),
        (TextKind.YAML, b"{max_side: 200}", ()),
        (TextKind.PAGE, b"<!-- mine -->\n<html>", (b"<svg>", b"a <html>")),
    ],
)
def test_only_a_file_of_its_kind_is_replaced(tmp_path, kind, own, others):
    path = tmp_path / "file"
    check_replaceable(path, kind)
    for content in (own, b""):
        path.write_bytes(content)
        check_replaceable(path, kind)
    for content in others:
        path.write_bytes(content)
        with pytest.raises(InputError, match=f"a file would be replaced in .*file; got .*expected {kind.value}"):
            check_replaceable(path, kind)
        assert path.read_bytes() == content


def test_text_is_written_to_a_pipe_and_no_file_takes_its_place(tmp_path, moseg):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        assert moseg("config", "dump", "--changed", "--out", pipe).code == 0
        assert os.read(reader, 2**16).startswith(b"# Parameters of moseg")
    finally:
        os.close(reader)
    with pytest.raises(InputError, match=r"cannot write a file in .*pipe; got a pipe or a device"), atomic_path(pipe):
        pass
    assert pipe.is_fifo()


def test_a_report_does_not_replace_the_video_or_a_result(squares, tmp_path, moseg):
    frames, out = squares / "squares" / "frames", tmp_path / "out"
    arguments = ("segment", frames, "--store", tmp_path / "store", "--out", out, "--quiet")
    page = tmp_path / "page.html"
    assert moseg(*arguments, "--report", page).code == 0
    assert moseg(*arguments, "--report", page).code == 0
    image = sorted(frames.iterdir())[0]
    for path in (image, out / "motion.json", out / "overlay.mp4"):
        before = path.read_bytes()
        ran = moseg(*arguments, "--report", path)
        assert (ran.code, path.read_bytes() == before) == (2, True)
        assert ("a file would be replaced" if path == image else "a page that may replace a result") in ran.err
    for command in (("report", "latest", "--store", tmp_path / "store", "-o"), ("config", "dump", "--out")):
        assert moseg(*command, image).code == 2
