"""Masks saved by any method are read as the labels that were written."""

import zipfile

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.predictions import FORMATS, FrameList, open_predictions

SHAPE = (6, 9)


@pytest.fixture
def labels():
    volume = np.zeros((4, *SHAPE), dtype=np.uint16)
    volume[:, 1:4, 1:4] = 1
    volume[1:, 2:6, 5:8] = 2
    return volume


def read(folder, name="dog", num_frames=4, shape=SHAPE, format=None):
    sequence = open_predictions(folder, format).sequence(name, FrameList(num_frames), shape)
    return np.stack([sequence.frame(index) for index in range(num_frames)])


def save_images(folder, volume, names="{:05d}.png", dtype=np.uint8):
    folder.mkdir(parents=True)
    for index, frame in enumerate(volume):
        Image.fromarray(frame.astype(dtype)).save(folder / names.format(index))


def save_palette(folder, volume):
    folder.mkdir(parents=True)
    for index, frame in enumerate(volume):
        image = Image.fromarray(frame.astype(np.uint8))
        image.putpalette([255 - value for value in range(256) for _ in range(3)])
        image.save(folder / f"{index:05d}.png")


def save_pfm(path, values, order="<"):
    scale = -1.0 if order == "<" else 1.0
    rows = np.ascontiguousarray(values[::-1], dtype=f"{order}f4")
    path.write_bytes(f"Pf\n{values.shape[1]} {values.shape[0]}\n{scale}\n".encode() + rows.tobytes())


@pytest.mark.parametrize("layout", ["dog", "dog/masks", "single_mask/dog"])
def test_grey_images_are_read_from_each_layout(tmp_path, labels, layout):
    save_images(tmp_path / layout, labels)
    np.testing.assert_array_equal(read(tmp_path), labels)


def test_palette_images_give_indices_and_not_colours(tmp_path, labels):
    save_palette(tmp_path / "dog", labels)
    with Image.open(tmp_path / "dog" / "00000.png") as image:
        assert image.mode == "P"
    np.testing.assert_array_equal(read(tmp_path), labels)


def test_16_bit_images_keep_labels_beyond_255(tmp_path, labels):
    save_images(tmp_path / "dog", labels * 3000, dtype=np.uint16)
    np.testing.assert_array_equal(read(tmp_path), labels * 3000)


def test_one_bit_images_are_one_object(tmp_path, labels):
    save_images(tmp_path / "dog", labels > 0, dtype=bool)
    np.testing.assert_array_equal(read(tmp_path), labels > 0)


def test_a_file_for_each_frame_may_be_numbered_from_1(tmp_path, labels):
    save_images(tmp_path / "dog", labels, names="frame_{:d}0.png")
    np.testing.assert_array_equal(read(tmp_path), labels)


def test_files_of_some_frames_are_found_by_number(tmp_path, labels):
    save_images(tmp_path / "dog", labels)
    (tmp_path / "dog" / "00001.png").unlink()
    sequence = open_predictions(tmp_path).sequence("dog", FrameList(4), SHAPE)
    np.testing.assert_array_equal(sequence.frame(2), labels[2])
    with pytest.raises(MissingInputError, match=r"no prediction of frame 1 in .*dog; got 3 files for 4 frames"):
        sequence.frame(1)


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_archives_with_moseg_s_key_are_read_in_any_order(tmp_path, labels, save):
    save(tmp_path / "dog.npz", segmentation=labels.astype(np.int64), other=np.zeros(3))
    sequence = open_predictions(tmp_path).sequence("dog", FrameList(4), SHAPE)
    for index in (2, 3, 0, 0, 1):
        np.testing.assert_array_equal(sequence.frame(index), labels[index])


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.int32, np.float64])
def test_npy_volumes_of_any_number_type_are_read(tmp_path, labels, dtype):
    np.save(tmp_path / "dog.npy", labels.astype(dtype))
    np.testing.assert_array_equal(read(tmp_path), labels.astype(dtype))


def test_an_archive_of_one_array_of_any_name_is_read(tmp_path, labels):
    np.savez(tmp_path / "dog.npz", masks=labels)
    np.testing.assert_array_equal(read(tmp_path), labels)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("folder", ["dog", "seq-dog"])
def test_rigidmask_rows_run_from_the_bottom_up_and_labels_become_one_object(tmp_path, labels, order, folder):
    (tmp_path / folder).mkdir()
    for index, frame in enumerate(labels):
        save_pfm(tmp_path / folder / f"pm-{index:05d}.pfm", frame, order)
    np.testing.assert_array_equal(read(tmp_path), labels > 0)


def test_a_method_of_pairs_repeats_its_last_frame(tmp_path, labels):
    (tmp_path / "dog").mkdir()
    for index, frame in enumerate(labels[:3]):
        save_pfm(tmp_path / "dog" / f"pm-{index:05d}.pfm", frame)
    expected = labels > 0
    expected[3] = expected[2]
    np.testing.assert_array_equal(read(tmp_path), expected)


def test_em_s_largest_layer_is_background_and_layers_keep_their_number(tmp_path):
    (tmp_path / "dog").mkdir()
    layers = np.full((2, 8, 12), 1)
    layers[:, 2:4, 3:6] = 0
    layers[:, 5:7, 7:11] = 2
    for index, frame in enumerate(layers):
        probability = np.stack([np.where(frame == layer, 0.8, 0.1) for layer in range(3)]).astype(np.float32)
        np.save(tmp_path / "dog" / f"{index:05d}_proba.npy", probability)
    result = read(tmp_path, num_frames=2, shape=(24, 36))
    assert result[0, 12, 22:32].tolist() == [0] * 10
    np.testing.assert_array_equal(result[:, 1::3, 1::3], np.choose(layers, [1, 0, 3]))


def test_em_s_binary_masks_are_resized_by_the_nearest_pixel(tmp_path, labels):
    save_images(tmp_path / "dog", (labels > 0) * 255, names="{:05d}_binary.png")
    expected = np.repeat(np.repeat(labels > 0, 4, axis=1), 4, axis=2)
    np.testing.assert_array_equal(read(tmp_path, shape=(24, 36)), expected)


def test_a_named_format_overrides_what_the_files_look_like(tmp_path, labels):
    save_images(tmp_path / "dog", labels, names="{:05d}_binary.png")
    np.testing.assert_array_equal(read(tmp_path, format="png"), labels)
    np.testing.assert_array_equal(read(tmp_path), labels > 0)


def test_unknown_format_and_folder_are_named(tmp_path):
    with pytest.raises(InputError, match=f"got 'tiff'; expected one of {', '.join(sorted(FORMATS))}"):
        open_predictions(tmp_path, "tiff")
    with pytest.raises(MissingInputError, match=r"no such folder of predictions in .*absent"):
        open_predictions(tmp_path / "absent")
    with pytest.raises(InputError, match=r"no predictions in .*expected files .*\*/\*\.png"):
        open_predictions(tmp_path)


@pytest.mark.parametrize("format", FORMATS)
def test_a_missing_sequence_is_named(tmp_path, format):
    with pytest.raises(MissingInputError, match=r"no predictions of the sequence; expected .*camel"):
        open_predictions(tmp_path, format).sequence("camel", FrameList(3), SHAPE)


def test_another_size_is_refused(tmp_path, labels):
    save_images(tmp_path / "png" / "dog", labels)
    np.save(tmp_path / "dog.npy", labels)
    with pytest.raises(InputError, match=r"wrong size of masks in .*00000.png; got \(6, 9\); expected \(6, 8\)"):
        read(tmp_path / "png", shape=(6, 8))
    with pytest.raises(InputError, match=r"got \(4, 6, 9\); expected \(5, 6, 9\)"):
        read(tmp_path, num_frames=5, format="volume")


def test_pickles_are_refused(tmp_path, labels):
    pickled = np.array([labels[0], None], dtype=object)
    np.savez(tmp_path / "dog.npz", segmentation=pickled)
    np.save(tmp_path / "cat.npy", pickled)
    (tmp_path / "em" / "dog").mkdir(parents=True)
    np.save(tmp_path / "em" / "dog" / "00000_proba.npy", pickled)
    with pytest.raises(InputError, match=r"cannot be decoded in .*dog\.npz; got pickled Python objects"):
        read(tmp_path)
    with pytest.raises(InputError, match=r"cannot be decoded in .*cat\.npy; got pickled Python objects"):
        read(tmp_path, "cat")
    with pytest.raises(InputError, match=r"cannot be decoded in .*proba\.npy; got pickled Python objects"):
        read(tmp_path / "em")


def test_values_that_are_not_labels_are_refused(tmp_path):
    for name, value in (("half", 0.5), ("negative", -1.0), ("large", 65536.0), ("nan", np.nan)):
        np.save(tmp_path / f"{name}.npy", np.full((1, *SHAPE), value))
        with pytest.raises(InputError, match=rf"no labels in .*{name}.npy; got {value}; expected integers 0..65535"):
            read(tmp_path, name, num_frames=1)


def test_colour_images_are_refused(tmp_path):
    (tmp_path / "dog").mkdir()
    Image.new("RGB", SHAPE[::-1]).save(tmp_path / "dog" / "0.png")
    with pytest.raises(InputError, match=r"colours in place of labels in .*0.png; got RGB"):
        read(tmp_path, num_frames=1)


def test_damaged_files_are_named(tmp_path, labels):
    save_images(tmp_path / "png" / "dog", labels)
    path = tmp_path / "png" / "dog" / "00000.png"
    path.write_bytes(path.read_bytes()[:40])
    with pytest.raises(InputError, match=r"label image cannot be decoded in .*00000\.png"):
        read(tmp_path / "png")

    np.savez_compressed(tmp_path / "dog.npz", segmentation=labels)
    (tmp_path / "dog.npz").write_bytes((tmp_path / "dog.npz").read_bytes()[:-30])
    with pytest.raises(InputError, match=r"volume of labels cannot be decoded in .*dog\.npz"):
        read(tmp_path)

    (tmp_path / "rigid" / "dog").mkdir(parents=True)
    save_pfm(tmp_path / "rigid" / "dog" / "pm-0.pfm", labels[0])
    whole = (tmp_path / "rigid" / "dog" / "pm-0.pfm").read_bytes()
    (tmp_path / "rigid" / "dog" / "pm-0.pfm").write_bytes(whole[:-1])
    with pytest.raises(InputError, match=r"cut-off float map in .*pm-0.pfm; got 215 bytes; expected 216"):
        read(tmp_path / "rigid", num_frames=1)


def test_an_archive_whose_volume_is_cut_off_is_refused(tmp_path, labels):
    np.save(tmp_path / "whole.npy", labels)
    with zipfile.ZipFile(tmp_path / "dog.npz", "w") as archive:
        archive.writestr("segmentation.npy", (tmp_path / "whole.npy").read_bytes()[:-10])
    with pytest.raises(InputError, match=r"cut-off archive in .*dog.npz; got 3 frames; expected 4"):
        read(tmp_path)
