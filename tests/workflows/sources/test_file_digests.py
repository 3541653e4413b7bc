"""Digests of whole files, also of those that another program writes to."""

import os
import sys
import threading
from collections import deque

import pytest

from moseg.schemas.digests import digest_bytes
from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.sources import files
from moseg.workflows.sources.files import BLOCK_BYTES, digest_file


@pytest.mark.parametrize("num_bytes", [0, 1, BLOCK_BYTES, BLOCK_BYTES + 1, 3 * BLOCK_BYTES])
def test_the_digest_of_a_file_is_that_of_its_bytes(tmp_path, num_bytes):
    path, content = tmp_path / "file", (b"0123456789abcdef" * (num_bytes // 16 + 1))[:num_bytes]
    path.write_bytes(content)
    assert digest_file(str(path)) == digest_bytes("file", content)


@pytest.mark.parametrize("num_bytes", [0, BLOCK_BYTES, 3 * BLOCK_BYTES])
def test_a_file_that_becomes_longer_or_shorter_meanwhile_is_refused_with_one_line(tmp_path, monkeypatch, num_bytes):
    path = tmp_path / "clip.mp4"
    path.write_bytes(bytes(2 * BLOCK_BYTES))
    digest_blocks = files.digest_blocks

    def after_a_change(*arguments):
        # Another program writes after the size was read.
        os.truncate(path, num_bytes)
        return digest_blocks(*arguments)

    monkeypatch.setattr(files, "digest_blocks", after_a_change)
    with pytest.raises(InputError, match=f"file changes while it is read.*{num_bytes} instead of {2 * BLOCK_BYTES}"):
        digest_file(str(path))


def test_a_thread_that_looks_at_the_stack_meanwhile_does_no_harm(tmp_path):
    """Profilers keep a frame, and with it all that its function refers to, for longer than the call."""
    path, is_over, seen = tmp_path / "file", threading.Event(), deque(maxlen=100)
    path.write_bytes(bytes(4 * BLOCK_BYTES))

    def look():
        while not is_over.is_set():
            seen.append(sys._current_frames())

    watcher = threading.Thread(target=look)
    watcher.start()
    try:
        digests = {digest_file(str(path)) for _ in range(20)}
    finally:
        is_over.set()
        watcher.join()
    assert len(digests) == 1


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(MissingInputError, match="file does not exist"):
        digest_file(str(tmp_path / "none"))
