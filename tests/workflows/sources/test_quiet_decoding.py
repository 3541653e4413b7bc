"""Complaints of decoders are captured whatever else is printed, and everything else reaches standard error."""

import mmap
import os
import subprocess
import sys
import threading

import cv2
import numpy as np
import pytest

from moseg.workflows.sources import quiet_decoding
from moseg.workflows.sources.quiet_decoding import capture_stderr


@pytest.fixture
def damaged(picture) -> np.ndarray:
    """Return a JPEG without its end, uint8 (byte,)."""
    content = cv2.imencode(".jpg", picture)[1]
    return np.append(content[:-30], np.uint8([0xFF, 0xD9]))


def test_a_complaint_on_an_unfinished_line_is_captured(damaged, capfd):
    def decode():
        os.write(2, b"\r40%")
        cv2.imdecode(damaged, cv2.IMREAD_COLOR)
        os.write(2, b"\r41%\ndone\n")

    _, complaints = capture_stderr(decode)
    assert len(complaints) == 1 and complaints[0].startswith("Corrupt JPEG data: premature end")
    assert capfd.readouterr().err == "\r40%\r41%\ndone\n"


def test_other_output_is_not_a_complaint(picture, capfd):
    content = cv2.imencode(".jpg", picture)[1]

    def decode():
        os.write(2, b"a line\nhalf a line")
        return cv2.imdecode(content, cv2.IMREAD_COLOR)

    image, complaints = capture_stderr(decode)
    assert image.shape == picture.shape and complaints == []
    assert capfd.readouterr().err == "a line\nhalf a line"


def test_other_output_is_not_lost_if_decoding_raises(damaged, capfd):
    def decode():
        cv2.imdecode(damaged, cv2.IMREAD_COLOR)
        os.write(2, b"a line\n")
        raise MemoryError("no room")

    with pytest.raises(MemoryError, match="no room"):
        capture_stderr(decode)
    assert capfd.readouterr().err == "a line\n"
    assert capture_stderr(lambda: None) == (None, [])


def test_no_line_of_other_threads_is_lost_or_torn(damaged, capfd):
    lines = {number: [f"thread {number}, line {index}" for index in range(3000)] for number in range(4)}

    def print_lines(number):
        for line in lines[number]:
            os.write(2, f"{line}\n".encode())

    threads = [threading.Thread(target=print_lines, args=(number,)) for number in lines]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        _, complaints = capture_stderr(lambda: cv2.imdecode(damaged, cv2.IMREAD_COLOR))
        assert len(complaints) == 1
    # A write that ended after standard error was put back is passed on with the next call.
    capture_stderr(lambda: None)
    printed = capfd.readouterr().err.splitlines()
    assert sorted(printed) == sorted(line for each in lines.values() for line in each)


def test_later_output_of_a_process_is_passed_on_with_the_next_call(capfd):
    script = "import sys; sys.stdin.read(); print('from below', file=sys.stderr)"

    def decode():
        return subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE)

    process, _ = capture_stderr(decode)
    process.communicate()
    assert process.returncode == 0
    capture_stderr(lambda: None)
    assert capfd.readouterr().err == "from below\n"


def test_a_write_of_which_only_whole_pages_have_arrived_is_awaited(monkeypatch):
    capture = quiet_decoding._Capture()
    file = capture.open()
    monkeypatch.setattr(quiet_decoding.time, "sleep", lambda seconds: os.write(file, b"rest\n"))
    os.write(file, b"x" * mmap.PAGESIZE)
    assert capture.read() == b"x" * mmap.PAGESIZE + b"rest\n"
    os.close(file)
