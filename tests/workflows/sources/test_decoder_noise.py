"""Damage is heard whatever else is printed at the same time, and nothing else is kept from standard error."""

import os
import subprocess
import sys
import threading

import cv2
import numpy as np
import pytest

from moseg.workflows.sources.quiet_decoding import listen_to


@pytest.fixture
def damaged(picture) -> np.ndarray:
    """A JPEG without its end, uint8 (byte,)."""
    content = cv2.imencode(".jpg", picture)[1]
    return np.append(content[:-30], np.uint8([0xFF, 0xD9]))


def test_a_complaint_on_an_unfinished_line_is_heard(damaged, capfd):
    def decode():
        os.write(2, b"\r40%")
        cv2.imdecode(damaged, cv2.IMREAD_COLOR)
        os.write(2, b"\r41%\ndone\n")

    _, complaints = listen_to(decode)
    assert len(complaints) == 1 and complaints[0].startswith("Corrupt JPEG data: premature end")
    assert capfd.readouterr().err == "\r40%\r41%\ndone\n"


def test_what_others_print_is_no_complaint(picture, capfd):
    content = cv2.imencode(".jpg", picture)[1]

    def decode():
        os.write(2, b"a line\nhalf a line")
        return cv2.imdecode(content, cv2.IMREAD_COLOR)

    image, complaints = listen_to(decode)
    assert image.shape == picture.shape and complaints == []
    assert capfd.readouterr().err == "a line\nhalf a line"


def test_what_others_print_is_not_lost_where_decoding_raises(damaged, capfd):
    def decode():
        cv2.imdecode(damaged, cv2.IMREAD_COLOR)
        os.write(2, b"a line\n")
        raise MemoryError("no room")

    with pytest.raises(MemoryError, match="no room"):
        listen_to(decode)
    assert capfd.readouterr().err == "a line\n"
    assert listen_to(lambda: None) == (None, [])


def test_no_line_of_other_threads_is_lost_or_torn(damaged, capfd):
    lines = {number: [f"thread {number}, line {index}" for index in range(3000)] for number in range(4)}

    def say(number):
        for line in lines[number]:
            os.write(2, f"{line}\n".encode())

    threads = [threading.Thread(target=say, args=(number,)) for number in lines]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        _, complaints = listen_to(lambda: cv2.imdecode(damaged, cv2.IMREAD_COLOR))
        assert len(complaints) == 1
    # A write that ended after standard error was put back is passed on with the next call.
    listen_to(lambda: None)
    heard = capfd.readouterr().err.splitlines()
    assert sorted(heard) == sorted(line for spoken in lines.values() for line in spoken)


def test_what_a_process_prints_later_is_passed_on_with_the_next_call(capfd):
    script = "import sys; sys.stdin.read(); print('from below', file=sys.stderr)"

    def decode():
        return subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE)

    process, _ = listen_to(decode)
    process.communicate()
    assert process.returncode == 0
    listen_to(lambda: None)
    assert capfd.readouterr().err == "from below\n"
