import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.sources import DepthFiles

SIZE = (4, 6)
DEPTH = np.linspace(0.1, 2, 24).reshape(SIZE)


def read_one(path, size=SIZE, max_side=100):
    return next(DepthFiles((str(path),), size, max_side).read())


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64])
def test_floats_are_read_as_float32(tmp_path, dtype):
    np.save(tmp_path / "0.npy", DEPTH.astype(dtype))
    depth = read_one(tmp_path / "0.npy")
    assert depth.dtype == np.float32
    np.testing.assert_array_equal(depth, DEPTH.astype(dtype).astype(np.float32))


def test_sixteen_bit_images_span_0_to_1(tmp_path, write_image):
    depth = read_one(write_image(tmp_path / "0.png", np.full(SIZE, 65535, np.uint16)))
    assert depth.dtype == np.float32
    assert (depth == 1).all()


def test_depth_is_reduced_to_the_frames_working_size(tmp_path):
    np.save(tmp_path / "0.npy", np.repeat([[1.0, 3.0]], 4, axis=0).repeat(3, axis=1))
    np.testing.assert_allclose(read_one(tmp_path / "0.npy", max_side=3), [[1, 2, 3]] * 2)
    np.save(tmp_path / "1.npy", np.ones((2, 3)))
    assert read_one(tmp_path / "1.npy", max_side=3).shape == (2, 3)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_values_beyond_float32_are_refused(tmp_path, bad):
    depth = DEPTH.copy()
    depth[1, 2] = bad
    np.save(tmp_path / "0.npy", depth)
    with pytest.raises(InputError, match=r"not finite in .*0\.npy; got 1 "):
        read_one(tmp_path / "0.npy")


def test_a_map_of_the_wrong_size_is_named(tmp_path):
    np.save(tmp_path / "0.npy", DEPTH.T)
    with pytest.raises(InputError, match=r"0\.npy; got 4x6 px; expected 6x4 px"):
        read_one(tmp_path / "0.npy")


@pytest.mark.parametrize(
    "array", [np.zeros(SIZE, int), np.zeros((*SIZE, 3)), np.array([{"a": 1}], object)], ids=["int", "3d", "pickle"]
)
def test_other_arrays_are_refused_as_depth(tmp_path, array):
    np.save(tmp_path / "0.npy", array)
    with pytest.raises(InputError, match=r"0\.npy"):
        read_one(tmp_path / "0.npy")


def test_archives_and_other_bytes_are_refused_as_depth(tmp_path):
    np.savez(tmp_path / "a.npz", DEPTH)
    (tmp_path / "a.npz").rename(tmp_path / "a.npy")
    for name, content in (("b.npy", b""), ("c.npy", b"text"), ("d.png", b""), ("e.png", b"text")):
        (tmp_path / name).write_bytes(content)
    for name in ("a.npy", "b.npy", "c.npy", "d.png", "e.png"):
        with pytest.raises(InputError, match=name):
            read_one(tmp_path / name)


@pytest.mark.parametrize("image", [np.zeros(SIZE, np.uint8), np.zeros((*SIZE, 3), np.uint16)], ids=["8-bit", "colour"])
def test_other_images_are_refused_as_depth(tmp_path, write_image, image):
    path = write_image(tmp_path / "0.png", image)
    with pytest.raises(InputError, match="expected 16-bit grey PNG"):
        read_one(path)
