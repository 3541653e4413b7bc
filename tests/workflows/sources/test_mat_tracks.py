"""Labelled trajectories are read from MATLAB's files, and what is none is refused in one line."""

import io

import numpy as np
import pytest
from scipy.io import savemat

from moseg.schemas.errors import InputError
from moseg.workflows.sources.mat_tracks import decode_mat_tracks

NUM_TRACKS, NUM_FRAMES = 7, 5
POINTS = np.random.default_rng(0).uniform(0, 40, (NUM_TRACKS, NUM_FRAMES, 2))
VISIBLE = np.random.default_rng(1).random((NUM_TRACKS, NUM_FRAMES)) < 0.7
LABELS = np.array([1, 1, 3, 1, 2, 2, 1])
SPARSE = np.where(VISIBLE[..., None], np.concatenate([POINTS, np.ones((NUM_TRACKS, NUM_FRAMES, 1))], -1), 0)
DATA = {
    "ySparse": SPARSE.transpose(2, 0, 1),
    "visibleSparse": VISIBLE.astype(np.uint8),
    "GtLabel": LABELS.astype(np.uint8)[:, None],
    "nFrames": NUM_FRAMES,
}


def content(data=None, variable="Data", compress=False, **changes):
    file = io.BytesIO()
    savemat(file, {variable: {**DATA, **changes} if data is None else data}, do_compression=compress)
    return file.getvalue()


def changed(name, index, value):
    array = DATA[name].astype(float)
    array[index] = value
    return {name: array}


@pytest.mark.parametrize("compress", [False, True])
@pytest.mark.parametrize("row", [False, True])
def test_points_visibility_and_labels_are_read(compress, row):
    labels = DATA["GtLabel"].T if row else DATA["GtLabel"]
    points, visible, found = decode_mat_tracks(content(compress=compress, GtLabel=labels), "a.mat")
    np.testing.assert_array_equal(points, np.where(VISIBLE[..., None], POINTS, 0))
    np.testing.assert_array_equal(visible, VISIBLE)
    np.testing.assert_array_equal(found, LABELS)
    assert (points.dtype, visible.dtype, found.dtype) == (np.float64, bool, np.int64)


def test_homogeneous_coordinates_have_no_scale_and_the_hidden_no_value():
    scaled = DATA["ySparse"] * np.random.default_rng(2).uniform(0.5, 2, (NUM_TRACKS, NUM_FRAMES))
    scaled[:, ~VISIBLE] = np.nan
    found = decode_mat_tracks(content(ySparse=scaled), "a.mat").points
    np.testing.assert_allclose(found, np.where(VISIBLE[..., None], POINTS, 0))


def test_without_a_visibility_everything_is_visible():
    file = io.BytesIO()
    shown = {"ySparse": DATA["ySparse"] + (DATA["ySparse"][2:] == 0), "GtLabel": DATA["GtLabel"]}
    savemat(file, {"Data": shown})
    points, visible, _ = decode_mat_tracks(file.getvalue(), "a.mat")
    assert visible.all()
    np.testing.assert_array_equal(points, shown["ySparse"][:2].transpose(1, 2, 0))


def test_a_trajectory_may_have_no_label():
    found = decode_mat_tracks(content(**changed("GtLabel", 1, 0)), "a.mat")
    np.testing.assert_array_equal(found.labels, [1, 0, 3, 1, 2, 2, 1])
    np.testing.assert_array_equal(found.visible, VISIBLE)


def hopkins(compress=False, **changes):
    """Return the bytes of a file as Hopkins155 has them: y in px, x before the calibration matrix K."""
    y = np.concatenate([POINTS, np.ones((NUM_TRACKS, NUM_FRAMES, 1))], -1).transpose(2, 0, 1)
    calibration = np.array([[32.0, 0, 16], [0, 32, 12], [0, 0, 1]])
    variables = {"K": calibration, "x": np.linalg.solve(calibration, y.reshape(3, -1)).reshape(y.shape), "y": y}
    variables |= {"s": LABELS.astype(np.uint8)[:, None], "width": 32, "points": NUM_TRACKS, **changes}
    file = io.BytesIO()
    savemat(file, {name: value for name, value in variables.items() if value is not None}, do_compression=compress)
    return file.getvalue()


@pytest.mark.parametrize("compress", [False, True])
def test_hopkins_has_variables_in_px_and_everything_visible(compress):
    points, visible, labels = decode_mat_tracks(hopkins(compress), "a.mat")
    np.testing.assert_allclose(points, POINTS)
    np.testing.assert_array_equal(labels, LABELS)
    assert visible.all() and visible.shape == (NUM_TRACKS, NUM_FRAMES)


def test_hopkins_with_missing_data_has_a_mask():
    points, visible, _ = decode_mat_tracks(hopkins(m=VISIBLE.astype(np.uint8)), "a.mat")
    np.testing.assert_array_equal(visible, VISIBLE)
    np.testing.assert_allclose(points, np.where(VISIBLE[..., None], POINTS, 0))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"s": None}, "got no s;"),
        ({"y": None}, "got no y;"),
        ({"s": LABELS[1:]}, r"got y \(3, 7, 5\), s \(6,\);"),
        ({"s": "cars"}, "not real numbers in s of a.mat"),
        ({"y": {"a": 1}}, "not real numbers in y of a.mat"),
        ({"s": np.zeros(NUM_TRACKS)}, "no labelled trajectories in s of a.mat"),
        ({"y": np.zeros((2, NUM_TRACKS, NUM_FRAMES))}, r"y \(2, 7, 5\)"),
        ({"m": VISIBLE.T}, r"m \(5, 7\)"),
        ({"m": 2 * VISIBLE}, "visibility that is neither 0 nor 1 in m of a.mat"),
    ],
)
def test_other_variables_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        decode_mat_tracks(hopkins(**changes), "a.mat")


SEEN = tuple(np.argwhere(VISIBLE)[0])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ySparse": DATA["ySparse"][:2]}, r"not labelled .*ySparse \(2, 7, 5\).*expected a struct Data"),
        ({"ySparse": DATA["ySparse"][:, :, 0]}, "not labelled"),
        ({"visibleSparse": DATA["visibleSparse"].T}, r"visibleSparse \(5, 7\)"),
        ({"GtLabel": DATA["GtLabel"][1:]}, r"GtLabel \(6,\)"),
        ({"ySparse": np.zeros((3, 0, 5)), "visibleSparse": np.zeros((0, 5)), "GtLabel": np.zeros(0)}, "labelled traj"),
        (changed("ySparse", (0, *SEEN), np.nan), "not finite in a.mat; got 1 visible"),
        (changed("ySparse", (1, *SEEN), np.inf), "not finite in a.mat; got 1 visible"),
        (changed("ySparse", (2, *SEEN), 0), "third coordinate of 0"),
        (changed("visibleSparse", (0, 0), 2), "visibility .* visibleSparse of a.mat"),
        (changed("visibleSparse", (0, 0), np.nan), "visibility .* visibleSparse of a.mat"),
        (changed("GtLabel", 0, -1), "labels in GtLabel of a.mat; .*expected whole numbers of 0 .* to 65535"),
        (changed("GtLabel", slice(None), 0), "no labelled trajectories in GtLabel of a.mat; got 0 for all"),
        (changed("GtLabel", 0, 1.5), "unusable labels"),
        (changed("GtLabel", 0, 65536), "unusable labels"),
        (changed("GtLabel", 0, np.nan), "unusable labels"),
        ({"ySparse": DATA["ySparse"] * 1j}, "not real numbers in ySparse of a.mat"),
        ({"GtLabel": "cars"}, "not real numbers in GtLabel"),
        ({"GtLabel": {"a": 1}}, "not real numbers in GtLabel"),
    ],
)
def test_other_values_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        decode_mat_tracks(content(**changes), "a.mat")


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (content(variable="Tracks"), "not labelled trajectories in a.mat; got no struct Data"),
        (content(data=np.ones(3)), "got no struct Data"),
        (content(data={"ySparse": np.ones(3)}), "got no GtLabel"),
        (content(data=np.zeros((1, 2), [(name, object) for name in DATA])), "got no struct Data"),
        (b"", "not MATLAB's in a.mat; got 0 bytes"),
        (b"text" * 100, "not MATLAB's"),
        (b"\x89HDF\r\n\x1a\n" + bytes(600), "not MATLAB's"),
        (b"MATLAB 7.3".ljust(124) + b"\x00\x02IM" + bytes(400), "not MATLAB's"),
    ],
    ids=["other-variable", "no-struct", "fields-missing", "two-structs", "empty", "text", "hdf5", "matlab-7.3"],
)
def test_other_files_are_refused(bad, message):
    with pytest.raises(InputError, match=message):
        decode_mat_tracks(bad, "a.mat")


@pytest.mark.parametrize("compress", [False, True])
@pytest.mark.parametrize("make", [content, hopkins])
def test_damaged_bytes_are_read_or_refused(make, compress):
    sound = make(compress=compress)
    rng = np.random.default_rng(3)
    refused = 0
    for _ in range(2000):
        bad = bytearray(sound[: rng.integers(1, len(sound))] if rng.random() < 0.3 else sound)
        for position in rng.integers(0, len(bad), 3):
            bad[position] = rng.integers(0, 256)
        try:
            decode_mat_tracks(bytes(bad), "a.mat")
        except InputError:
            refused += 1
    assert refused > 500
