"""Sequences in which nothing moves: rendered ones without a root; recordings, pictures and DAVIS below one."""

from itertools import pairwise

import numpy as np
import pytest

from moseg.schemas.errors import InputError, MissingInputError
from moseg.tasks.synthetic import STILL_SCENES
from moseg.workflows.datasets import describe_dataset, find_ground_truth, open_dataset
from moseg.workflows.sources import WarpedPicture

RENDERED = tuple(STILL_SCENES)
BELOW = {"a recording": "parked/frames", "a picture": "stills", "DAVIS": "JPEGImages/480p/dog"}


@pytest.fixture(autouse=True)
def no_data(monkeypatch):
    monkeypatch.delenv("MOSEG_DATA", raising=False)


@pytest.fixture
def write_picture(write_image):
    """Return a function that writes a picture of noise, 90x60 px."""

    def write(path, seed=0):
        write_image(path, np.random.default_rng(seed).integers(0, 256, (60, 90, 3), np.uint8))

    return write


@pytest.fixture
def root(tmp_path, write_sequence, write_picture):
    """Return a root with a recording, two pictures and two DAVIS sequences."""
    root = tmp_path / "data" / "still"
    write_sequence(root / "parked" / "frames", root / "parked" / "masks", {0: 255})
    write_picture(root / "stills" / "yard.png")
    write_picture(root / "stills" / "lake.png", seed=1)
    for name in ("dog", "cows"):
        for number in range(2):
            write_picture(root / "JPEGImages" / "480p" / name / f"{number:05d}.png", seed=number)
    return root


def open_still(root=None, *names):
    return open_dataset("still", None if root is None else str(root), names or None, max_side=100)


def test_the_rendered_scenes_need_no_root_and_what_is_absent_is_named():
    dataset = open_still()
    assert (dataset.names, dataset.root) == (RENDERED, None)
    assert [name.split(" (")[0] for name in dataset.absent] == list(BELOW)
    source = dataset.sequence("rendered-street")
    assert (source.nothing_moves, source.annotations, source.num_motions) == (True, None, None)
    assert None not in (source.objects, source.depth, source.flow_forward, source.flow_backward, source.tracks)
    assert find_ground_truth([source]) == "still"


def test_a_root_adds_recordings_pictures_and_davis(root):
    dataset = open_still(root)
    assert dataset.names == (*RENDERED, "parked", "picture-lake", "picture-yard", "davis-cows", "davis-dog")
    assert dataset.absent == ()
    opened = [dataset.sequence(name) for name in dataset.names]
    assert find_ground_truth(opened) == "still"
    recording = dataset.sequence("parked")
    assert recording.frames.num_frames() == 3 and recording.annotations is None


@pytest.mark.parametrize("kind", BELOW)
def test_each_kind_may_stand_alone(tmp_path, write_picture, kind):
    write_picture(tmp_path / "root" / BELOW[kind] / "00000.png")
    dataset = open_still(tmp_path / "root")
    assert len(dataset.names) == len(RENDERED) + 1
    assert [name.split(" (")[0] for name in dataset.absent] == [other for other in BELOW if other != kind]


def test_a_picture_becomes_a_sequence(root):
    source = open_still(root, "picture-yard").sequence("picture-yard")
    frames = np.stack(list(source.frames.read()))
    assert frames.shape[:1] == (source.frames.num_frames(),) == (24,)
    assert frames.shape[1:3] == source.frames.describe().size < (60, 90)
    assert all((first != second).any() for first, second in pairwise(frames))


def test_only_the_first_frame_of_a_davis_sequence_is_used(root):
    davis = root / "JPEGImages" / "480p" / "dog"
    assert open_still(root, "davis-dog").sequence("davis-dog").frames == WarpedPicture(str(davis / "00000.png"), 100)


def test_frames_depend_on_the_picture_and_the_working_size_alone(root):
    def fingerprint(name, max_side=100):
        dataset = open_dataset("still", str(root), (name,), max_side=max_side)
        return dataset.sequence(name).frames.fingerprint()

    # One picture under two names.
    assert fingerprint("picture-yard") == fingerprint("davis-dog") == fingerprint("davis-cows")
    assert len({fingerprint("picture-yard"), fingerprint("picture-lake"), fingerprint("picture-yard", 80)}) == 3


@pytest.mark.parametrize("beside", ["davis16", "davis-moving", "davis"])
def test_davis_beside_the_root_is_used_even_without_the_root(tmp_path, monkeypatch, write_picture, beside):
    write_picture(tmp_path / beside / "JPEGImages" / "480p" / "dog" / "00000.jpg")
    monkeypatch.setenv("MOSEG_DATA", str(tmp_path))
    assert open_still().names == (*RENDERED, "davis-dog")
    assert "a recording" in open_still().absent[0]


def test_a_root_that_is_not_there_or_holds_nothing_is_refused(tmp_path):
    with pytest.raises(MissingInputError, match="gone"):
        open_still(tmp_path / "gone")
    (tmp_path / "empty").mkdir()
    with pytest.raises(MissingInputError, match=r"no sequence in .*empty; expected <sequence>/frames"):
        open_still(tmp_path / "empty")


def test_two_sequences_of_one_name_are_refused(root, write_picture):
    write_picture(root / "davis-dog" / "frames" / "0.png")
    with pytest.raises(InputError, match=r"two sequences of one name in .*davis-dog"):
        open_still(root)


def test_the_overview_says_what_a_root_would_add(root):
    row = describe_dataset("still", None, {})
    assert row.is_present and row.names == RENDERED and len(row.absent) == 3
    row = describe_dataset("still", None, {"MOSEG_DATA": str(root.parent)})
    assert row.root == str(root) and len(row.names) == len(RENDERED) + 5 and row.absent == ()
