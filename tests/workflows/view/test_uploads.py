"""Videos that a page sends: their names, their size, and the file that they become."""

import asyncio

import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.view.uploads import plain_name, receive_video


def _receive(parts, name, out, **options):
    async def stream():
        for part in parts:
            yield part

    return asyncio.run(receive_video(stream(), name, out, **options))


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ("holiday.mp4", "holiday.mp4"),
        ("My Holiday (1).MOV", "My_Holiday_1.mov"),
        ("../../etc/passwd.mp4", "passwd.mp4"),
        ("C:\\videos\\a.mp4", "a.mp4"),
        ("/abs/olute.webm", "olute.webm"),
        ("..mp4", "video.mp4"),
        (".hidden.mp4", "hidden.mp4"),
        ("<img src=x onerror=alert(1)>.mp4", "img_src_x_onerror_alert_1.mp4"),
        ("a\0b\nc.mp4", "a_b_c.mp4"),
        ("x" * 300 + ".mp4", "x" * 80 + ".mp4"),
        ("d\u00e9j\u00e0.mp4", "d\u00e9j\u00e0.mp4"),
    ],
)
def test_names_are_plain(given, name):
    assert plain_name(given) == name


@pytest.mark.parametrize("given", ["", "mp4", "movie", "script.py", "a.mp4/", "x.mp4.exe"])
def test_what_is_no_video_by_its_name_is_refused(given):
    with pytest.raises(InputError, match="not a video by its name"):
        plain_name(given)


def test_no_file_is_replaced(tmp_path):
    first = _receive([b"ab", b"c"], "a.mp4", tmp_path)
    second = _receive([b"d"], "a.mp4", tmp_path)
    assert (first.name, first.read_bytes()) == ("a.mp4", b"abc")
    assert (second.name, second.read_bytes()) == ("a-2.mp4", b"d")
    assert first.parent == second.parent == tmp_path / "input"


def test_uploads_of_one_name_at_the_same_time_are_two_files(tmp_path):
    async def slowly(*parts):
        for part in parts:
            await asyncio.sleep(0)
            yield part

    async def both():
        streams = (slowly(b"ab", b"c"), slowly(b"d"))
        return await asyncio.gather(*(receive_video(stream, "a.mp4", tmp_path) for stream in streams))

    first, second = asyncio.run(both())
    assert (first.name, first.read_bytes()) == ("a.mp4", b"abc")
    assert (second.name, second.read_bytes()) == ("a-2.mp4", b"d")


@pytest.mark.parametrize(("parts", "what"), [([b"12345", b"6"], "too large"), ([], "an empty file")])
def test_what_is_refused_leaves_nothing(tmp_path, parts, what):
    with pytest.raises(InputError, match=what):
        _receive(parts, "a.mp4", tmp_path, max_bytes=5)
    assert list((tmp_path / "input").iterdir()) == []
