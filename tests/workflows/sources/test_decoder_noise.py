"""Damage is heard whatever else is printed at the same time, and nothing else is kept from standard error."""

import os

import cv2
import numpy as np
import pytest

from workflows.sources.decoder_noise import listen_to


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
