import struct

import cv2
import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.sources import FlowFiles

SIZE = (4, 6)
FLOW = np.random.default_rng(0).normal(0, 20, (*SIZE, 2)).astype(np.float32)


def read_one(path, size=SIZE, max_side=100):
    return next(FlowFiles((str(path),), size, max_side).read())


@pytest.fixture
def write_kitti(write_image):
    """Return a function that writes u, v and valid as KITTI does, with the flow rounded to steps of 1/64 px."""

    def write(path, flow, valid):
        stored = np.dstack([np.rint(flow * 64 + 2**15), valid]).astype(np.uint16)
        return write_image(path, stored)

    return write


def write_flo(path, flow):
    height, width = flow.shape[:2]
    path.write_bytes(b"PIEH" + struct.pack("<ii", width, height) + flow.astype("<f4").tobytes())
    return path


def test_middlebury_files_are_read_as_opencv_writes_them(tmp_path):
    cv2.writeOpticalFlow(str(tmp_path / "0.flo"), FLOW)
    flow = read_one(tmp_path / "0.flo")
    assert flow.dtype == np.float32
    np.testing.assert_array_equal(flow, FLOW)


@pytest.mark.parametrize("unknown", [1e10, -1e10, np.nan, np.inf])
def test_vectors_beyond_middleburys_limit_are_unknown(tmp_path, unknown):
    written = FLOW.copy()
    written[1, 2, 1] = unknown
    flow = read_one(write_flo(tmp_path / "0.flo", written))
    assert np.isnan(flow[1, 2]).all()
    assert np.count_nonzero(np.isnan(flow)) == 2


def test_kitti_files_hold_64_steps_a_pixel_in_the_order_u_v_valid(tmp_path, write_kitti):
    flow = read_one(write_kitti(tmp_path / "0.png", FLOW, np.ones(SIZE)))
    assert flow.dtype == np.float32
    np.testing.assert_allclose(flow, FLOW, atol=1 / 128)
    constant = read_one(write_kitti(tmp_path / "1.png", np.full((*SIZE, 2), (1.5, -3)), np.ones(SIZE)))
    assert (constant == (1.5, -3)).all()


def test_invalid_pixels_of_kitti_are_unknown_and_not_at_rest(tmp_path, write_kitti):
    valid = np.ones(SIZE)
    valid[:, 0] = 0
    flow = read_one(write_kitti(tmp_path / "0.png", FLOW * valid[..., None], valid))
    np.testing.assert_array_equal(np.isnan(flow), np.repeat(valid[..., None] == 0, 2, axis=-1))


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, ">f8"])
def test_arrays_are_read_as_float32(tmp_path, dtype):
    np.save(tmp_path / "0.npy", FLOW.astype(dtype))
    flow = read_one(tmp_path / "0.npy")
    assert flow.dtype == np.float32
    np.testing.assert_array_equal(flow, FLOW.astype(dtype).astype(np.float32))


def test_vectors_shrink_with_the_frames(tmp_path):
    np.save(tmp_path / "0.npy", np.full((*SIZE, 2), (6.0, -4.0)))
    flow = read_one(tmp_path / "0.npy", max_side=3)
    assert flow.shape == (2, 3, 2)
    np.testing.assert_allclose(flow, np.full((2, 3, 2), (3, -2)), rtol=1e-6)


def test_a_field_of_the_working_size_is_not_changed(tmp_path):
    np.save(tmp_path / "0.npy", FLOW[:2, :3])
    np.testing.assert_array_equal(read_one(tmp_path / "0.npy", max_side=3), FLOW[:2, :3])


def test_unknown_pixels_do_not_enter_the_average(tmp_path):
    written = np.full((*SIZE, 2), (6.0, -4.0), np.float32)
    written[0, 0] = written[:2, 2:4] = 1e10
    flow = read_one(write_flo(tmp_path / "0.flo", written), max_side=3)
    assert np.isnan(flow[0, 1]).all()
    flow[0, 1] = (3, -2)
    np.testing.assert_allclose(flow, np.full((2, 3, 2), (3, -2)), rtol=1e-6)


def test_equal_fields_have_equal_bytes_whatever_file_they_come_from(tmp_path, write_kitti):
    valid = np.ones(SIZE)
    valid[2, 3] = 0
    kitti = np.rint(FLOW * 64) / 64
    kitti[2, 3] = -512
    png = read_one(write_kitti(tmp_path / "0.png", kitti, valid))
    kitti[2, 3] = np.nan
    assert png.tobytes() == read_one(write_flo(tmp_path / "0.flo", kitti)).tobytes()


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_arrays_must_be_finite(tmp_path, bad):
    flow = FLOW.astype(float)
    flow[1, 2, 0] = bad
    np.save(tmp_path / "0.npy", flow)
    with pytest.raises(InputError, match=r"not finite in .*0\.npy; got 1 "):
        read_one(tmp_path / "0.npy")


def test_a_field_without_known_pixels_is_refused(tmp_path, write_kitti):
    path = write_kitti(tmp_path / "0.png", FLOW, np.zeros(SIZE))
    with pytest.raises(InputError, match=r"without a known pixel in .*0\.png"):
        read_one(path)


def test_a_field_of_the_wrong_size_is_named(tmp_path):
    write_flo(tmp_path / "0.flo", FLOW.swapaxes(0, 1))
    with pytest.raises(InputError, match=r"0\.flo; got 4x6 px; expected 6x4 px"):
        read_one(tmp_path / "0.flo")


@pytest.mark.parametrize(
    "array",
    [np.zeros((*SIZE, 2), int), np.zeros(SIZE), np.zeros((2, *SIZE)), np.array([{"a": 1}], object)],
    ids=["int", "2d", "channels-first", "pickle"],
)
def test_other_arrays_are_refused_as_flow(tmp_path, array):
    np.save(tmp_path / "0.npy", array)
    with pytest.raises(InputError, match=r"0\.npy"):
        read_one(tmp_path / "0.npy")


@pytest.mark.parametrize(
    "image",
    [np.zeros((*SIZE, 3), np.uint8), np.zeros(SIZE, np.uint16), np.zeros((*SIZE, 4), np.uint16)],
    ids=["8-bit", "grey", "alpha"],
)
def test_other_images_are_refused_as_flow(tmp_path, write_image, image):
    path = write_image(tmp_path / "0.png", image)
    with pytest.raises(InputError, match=r"0\.png; .* expected KITTI's 16-bit PNG"):
        read_one(path)


def test_files_cut_short_and_other_bytes_are_refused_as_flow(tmp_path, write_kitti):
    flo = write_flo(tmp_path / "whole.flo", FLOW).read_bytes()
    np.save(tmp_path / "whole.npy", FLOW)
    npy = (tmp_path / "whole.npy").read_bytes()
    np.savez(tmp_path / "archive.npz", FLOW)
    for name, content in (
        ("a.flo", flo[:-1]),
        ("b.flo", flo + b"\0"),
        ("c.flo", flo[:8]),
        ("d.flo", b"HEIP" + flo[4:]),
        ("e.flo", b"PIEH" + struct.pack("<ii", -6, -4) + flo[12:]),
        ("f.flo", b""),
        ("g.npy", npy[:-1]),
        ("h.npy", b""),
        ("i.npy", (tmp_path / "archive.npz").read_bytes()),
        ("j.png", b""),
        ("k.png", b"text"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(InputError, match=name.replace(".", r"\.")):
            read_one(tmp_path / name)


def test_the_fingerprint_follows_bytes_size_and_reduction_and_not_names(tmp_path):
    paths = [write_flo(tmp_path / f"{name}.flo", FLOW + add) for name, add in (("a", 0), ("b", 0), ("c", 1))]
    same, other = FlowFiles((str(paths[0]),), SIZE, 100), FlowFiles((str(paths[2]),), SIZE, 100)
    assert same.fingerprint() == FlowFiles((str(paths[1]),), SIZE, 100).fingerprint()
    fingerprints = [same, other, FlowFiles(same.paths, (8, 12), 100), FlowFiles(same.paths, SIZE, 3)]
    assert len({source.fingerprint() for source in fingerprints}) == 4
