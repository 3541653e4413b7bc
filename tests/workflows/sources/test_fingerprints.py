"""A fingerprint changes when, and only when, what is decoded could change."""

import os
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from moseg.workflows.sources import DepthFiles, ImageFiles, MaskFiles, SceneFrames, SceneMasks, VideoFile


@pytest.fixture(params=["images", "video", "masks", "depth"])
def source_of(request, write_image, write_video, picture):
    """Return a function that makes the source of one kind from files written below a folder."""

    def images(folder):
        paths = [write_image(folder / f"{i}.png", np.roll(picture, i, 1)) for i in range(2)]
        return ImageFiles(tuple(paths), 1000)

    def video(folder):
        return VideoFile(write_video(folder / "a.mp4", [picture] * 3), 1000)

    def masks(folder):
        paths = [write_image(folder / f"{i}.png", np.full((4, 5), i, np.uint8)) for i in range(2)]
        return MaskFiles(tuple(enumerate(paths)), "instance")

    def depth(folder):
        np.save(folder / "0.npy", np.ones((4, 5)))
        return DepthFiles((str(folder / "0.npy"),), (4, 5), 1000)

    return locals()[request.param]


def files_of(source):
    if isinstance(source, VideoFile):
        return [source.path]
    return [path for _, path in source.items] if isinstance(source, MaskFiles) else list(source.paths)


def test_times_and_places_do_not_matter(tmp_path, source_of):
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    here, there = source_of(tmp_path / "here"), source_of(tmp_path / "there")
    for original, copy in zip(files_of(here), files_of(there), strict=True):
        # A video encoded twice need not be the same bytes.
        Path(copy).write_bytes(Path(original).read_bytes())
        os.utime(copy, (1, 1))
    assert here.fingerprint() == there.fingerprint()
    assert pickle.loads(pickle.dumps(here)).fingerprint() == here.fingerprint()


def test_each_byte_matters(tmp_path, source_of):
    source = source_of(tmp_path)
    before = source.fingerprint()
    path = Path(files_of(source)[-1])
    content, times = bytearray(path.read_bytes()), path.stat()
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
    assert source.fingerprint() != before


def test_decode_parameters_matter(tmp_path, source_of):
    source = source_of(tmp_path)
    if isinstance(source, MaskFiles):
        others = [replace(source, kind="binary"), replace(source, items=tuple((i + 1, p) for i, p in source.items))]
    else:
        others = [replace(source, max_side=3)]
    if not isinstance(source, VideoFile):
        others.append(replace(source, size=(7, 7)))
    assert len({source.fingerprint(), *(other.fingerprint() for other in others)}) == len(others) + 1


def test_the_order_of_frames_matters(tmp_path, write_image, picture):
    paths = (write_image(tmp_path / "0.png", picture), write_image(tmp_path / "1.png", picture[::-1]))
    assert ImageFiles(paths, 9).fingerprint() != ImageFiles(paths[::-1], 9).fingerprint()


def test_an_empty_file_has_a_fingerprint(tmp_path):
    (tmp_path / "a.mp4").touch()
    assert len(VideoFile(str(tmp_path / "a.mp4"), 9).fingerprint()) == 64


def test_fingerprints_of_scenes_differ_by_declaration_and_content():
    sources = [SceneFrames("pan"), SceneFrames("zoom"), SceneMasks("pan"), SceneMasks("pan", "objects")]
    assert len({source.fingerprint() for source in sources}) == 4
