import io
import json

import cv2
import numpy as np
import pytest
import torch
from safetensors.torch import load
from torch.nn import functional
from transformers import DPTImageProcessorPil

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.depth_anything import DepthAnythingParams
from moseg.schemas.parameters.depth_anything_3 import DepthAnything3Params
from moseg.schemas.parameters.dpt_dinov2 import DptDinov2Params
from moseg.tasks.depth import estimate_inverse_depth
from moseg.tasks.depth.depth_anything import network_size
from moseg.tasks.depth.depth_anything_3 import resize_to_patches
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth import DptDinov2, build_depth_anything, build_dpt_dinov2
from moseg.tasks.networks.depth_anything_3 import build_depth_anything_3
from moseg.workflows.weights.tiny.depth_anything import make_depth_anything
from moseg.workflows.weights.tiny.depth_anything_3 import make_depth_anything_3
from moseg.workflows.weights.tiny.dpt_dinov2 import make_dpt_dinov2

CPU = torch.device("cpu")
SMALL = DepthAnythingParams(short_side=56)
ANYTHING_3 = DepthAnything3Params(side=84)


class Brightness(torch.nn.Module):
    """Stands for a DPT network: its depth is the brightness of a frame's red, at 16 px a patch of 14."""

    device = CPU

    def forward(self, pixels):
        red = pixels[:, :1] * 0.229 + 0.485
        self.predicted_depth = functional.interpolate(red, scale_factor=16 / 14, mode="bilinear")[:, 0]
        return self


def of_brightness(model=Brightness, **depths):
    """A network of depth that gives what the model does."""
    return DptDinov2(model(), **depths)


@pytest.fixture(scope="module")
def networks():
    third = make_depth_anything_3(0)
    dpt, anything = make_dpt_dinov2(0).files, make_depth_anything(0).files
    dpt_tensors = torch.load(io.BytesIO(dpt["model.bin"]), weights_only=True)
    documents = [{"config.json": files["config.json"].decode()} for files in (dpt, anything, third.files)]
    third_tensors = load(third.files["model.safetensors"])
    return {
        DptDinov2Params(): build_dpt_dinov2(Checkpoint("tiny", dpt_tensors, documents[0])),
        SMALL: build_depth_anything(Checkpoint("tiny", load(anything["model.safetensors"]), documents[1])),
        ANYTHING_3: build_depth_anything_3(Checkpoint("tiny", third_tensors, documents[2], third.config)),
    }


def noise(*shape):
    return np.random.default_rng(0).integers(0, 256, shape, np.uint8)


PARAMS = pytest.mark.parametrize(
    "params", [DptDinov2Params(), SMALL, ANYTHING_3], ids=["dpt-dinov2", "depth-anything", "depth-anything-3"]
)


@PARAMS
@pytest.mark.parametrize("size", [(96, 128), (45, 61), (14, 14), (5, 40)])
def test_maps_have_the_frames_size(networks, params, size):
    inverse_depth = estimate_inverse_depth(networks[params], noise(2, *size, 3), params)
    assert inverse_depth.shape == (2, *size)
    assert inverse_depth.dtype == np.float32
    assert np.isfinite(inverse_depth).all()
    assert (inverse_depth >= 0).all()


@PARAMS
def test_a_frame_of_a_batch_is_as_alone(networks, params):
    frames = noise(3, 45, 61, 3)
    together = estimate_inverse_depth(networks[params], frames, params)
    alone = [estimate_inverse_depth(networks[params], frame[None], params)[0] for frame in frames]
    np.testing.assert_allclose(together, alone, rtol=1e-4, atol=1e-5)


@PARAMS
def test_a_frame_always_gives_the_same_map(networks, params):
    maps = [estimate_inverse_depth(networks[params], noise(1, 45, 61, 3), params) for _ in range(2)]
    np.testing.assert_array_equal(*maps)
    assert np.ptp(maps[0]) > 0


@PARAMS
def test_no_frames_give_no_maps(networks, params):
    assert estimate_inverse_depth(networks[params], noise(0, 45, 61, 3), params).shape == (0, 45, 61)


@PARAMS
def test_half_precision_is_near_full(networks, params, in_half_precision, relative_error):
    frames = noise(1, 45, 61, 3)
    full = estimate_inverse_depth(networks[params], frames, params)
    half = in_half_precision(lambda: estimate_inverse_depth(networks[params], frames, params))
    assert half.dtype == np.float32
    assert relative_error(half, full) < 0.25


@PARAMS
def test_frames_may_be_read_only(networks, params):
    frames = noise(1, 28, 28, 3)
    frames.flags.writeable = False
    estimate_inverse_depth(networks[params], frames, params)


@pytest.mark.parametrize("frames", [noise(4, 5, 3), noise(1, 4, 5, 4), noise(1, 4, 5, 3) / 255.0])
def test_an_image_that_is_not_an_rgb_frame_is_refused(networks, frames):
    with pytest.raises(InputError, match="not RGB frames"):
        estimate_inverse_depth(networks[SMALL], frames, SMALL)


def test_depth_that_is_not_finite_is_refused(networks):
    class Broken(Brightness):
        def forward(self, pixels):
            return super().forward(pixels * torch.nan)

    # A recipe does not name the weights: these are one of its inputs.
    params = DptDinov2Params.of_recipe(DptDinov2Params().model_dump(mode="json", exclude={"weights"}))
    with pytest.raises(InputError, match="not finite in the output of"):
        estimate_inverse_depth(of_brightness(Broken), noise(1, 28, 28, 3), params)


@pytest.mark.parametrize("max_side", [1022, 100])
def test_dpt_inverse_depth_is_aligned_with_the_frame(max_side):
    ramp = np.linspace(60, 250, 131).astype(np.uint8)
    frames = np.broadcast_to(ramp[None, None, :, None], (1, 71, 131, 3))
    inverse_depth = estimate_inverse_depth(of_brightness(), frames, DptDinov2Params(max_side=max_side))
    # The border beside the frame bleeds in by a pixel; a frame stretched over it would be 6 px off.
    inner = (0, slice(3, -3), slice(3, -3))
    np.testing.assert_allclose(1 / inverse_depth[inner], frames[..., 0][inner] / 255, atol=0.009)


def test_dpt_depth_has_a_floor():
    frames = np.zeros((1, 28, 28, 3), np.uint8)
    inverse_depth = estimate_inverse_depth(of_brightness(), frames, DptDinov2Params(nearest=0.25))
    np.testing.assert_allclose(inverse_depth, 4, rtol=1e-6)


def test_dpt_depth_is_clamped_to_the_range_of_the_training():
    frames = np.full((1, 28, 28, 3), 255, np.uint8)
    far, near = (
        estimate_inverse_depth(of_brightness(min_depth=0.25, max_depth=depth), frames, DptDinov2Params())
        for depth in (10, 0.5)
    )
    # In the middle, where the border does not bleed in; the least depth is added before.
    np.testing.assert_allclose(far[0, 10:18, 10:18], 1 / 1.25, rtol=1e-5)
    np.testing.assert_allclose(near[0, 10:18, 10:18], 2, rtol=1e-6)


@pytest.mark.parametrize(
    ("size", "params", "expected"),
    [
        ((480, 854), DepthAnythingParams(), (518, 924)),
        ((1080, 1920), DepthAnythingParams(), (518, 924)),
        ((128, 96), DepthAnythingParams(), (686, 518)),
        ((200, 2000), DepthAnythingParams(), (154, 1540)),
        ((480, 854), DepthAnythingParams(short_side=20), (14, 42)),
        ((2, 2000), DepthAnythingParams(), (14, 1540)),
    ],
)
def test_depth_anything_input_is_a_multiple_of_a_patch(size, params, expected):
    assert network_size(size, params) == expected


@pytest.mark.parametrize("size", [(96, 170), (30, 40)])
def test_depth_anything_input_is_resized_as_by_its_authors(networks, size):
    y, x = np.mgrid[: size[0], : size[1]]
    frame = np.stack([x + y, 250 - x, 128 + 100 * np.sin(x / 9)], axis=2).astype(np.uint8)
    seen = []
    with networks[SMALL].register_forward_pre_hook(lambda _, inputs: seen.append(inputs[0])):
        estimate_inverse_depth(networks[SMALL], frame[None], SMALL)
    height, width = network_size(size, SMALL)
    resized = cv2.resize(frame / 255.0, (width, height), interpolation=cv2.INTER_CUBIC)
    expected = (resized - [0.485, 0.456, 0.406]) / [0.229, 0.224, 0.225]
    np.testing.assert_allclose(seen[0][0].permute(1, 2, 0), expected, atol=1e-5)


@pytest.mark.parametrize(
    ("size", "side", "expected"),
    [
        ((480, 854), 504, (280, 504)),
        ((1920, 1080), 504, (504, 280)),
        ((100, 133), 252, (196, 252)),
        # 35 rows are as far from two patches as from three.
        ((35, 70), 70, (42, 70)),
        ((3, 500), 504, (14, 504)),
        ((40, 30), 20, (14, 14)),
    ],
)
def test_depth_anything_3_sees_whole_patches(size, side, expected):
    assert resize_to_patches(noise(*size, 3), side).shape == (*expected, 3)


@pytest.mark.parametrize(
    ("size", "side", "steps"),
    [
        ((96, 170), 84, [((47, 84), cv2.INTER_AREA), ((42, 84), cv2.INTER_AREA)]),
        ((30, 40), 84, [((63, 84), cv2.INTER_CUBIC), ((70, 84), cv2.INTER_CUBIC)]),
        ((56, 84), 84, []),
    ],
)
def test_depth_anything_3_input_is_resized_as_by_its_authors(networks, size, side, steps):
    frame = noise(*size, 3)
    network, seen = networks[ANYTHING_3], []
    with network.register_forward_pre_hook(lambda _, inputs: seen.append(inputs[0])):
        estimate_inverse_depth(network, frame[None], DepthAnything3Params(side=side))
    for (height, width), interpolation in steps:
        frame = cv2.resize(frame, (width, height), interpolation=interpolation)
    expected = (frame / 255 - [0.485, 0.456, 0.406]) / [0.229, 0.224, 0.225]
    np.testing.assert_allclose(seen[0][0].permute(1, 2, 0), expected, atol=1e-5)


def test_depth_anything_3_stores_the_inverse_of_its_depth_where_the_frame_has_it():
    class LogBrightness(Brightness):
        def forward(self, pixels):
            return (pixels[:, 0] * 0.229 + 0.485).log()

    ramp = np.linspace(60, 250, 140).astype(np.uint8)
    frames = np.broadcast_to(ramp[None, None, :, None], (1, 70, 140, 3))
    exact, smaller = (
        estimate_inverse_depth(LogBrightness(), frames, DepthAnything3Params(side=side)) for side in (140, 70)
    )
    np.testing.assert_allclose(exact * frames[..., 0] / 255, 1, rtol=1e-5)
    # Beyond the centres of the outer pixels nothing is interpolated.
    np.testing.assert_allclose(smaller[..., 1:-1], exact[..., 1:-1], rtol=0.02)


def test_a_border_is_added_as_by_the_official_preprocessing():
    frame = noise(45, 61, 3)
    official = DPTImageProcessorPil(
        do_resize=False,
        do_rescale=False,
        do_pad=True,
        size_divisor=14,
        image_mean=[123.675, 116.28, 103.53],
        image_std=[58.395, 57.12, 57.375],
    )
    expected = official(frame.transpose(2, 0, 1), input_data_format="channels_first", return_tensors="pt").pixel_values
    seen = []

    class Watched(Brightness):
        def forward(self, pixels):
            seen.append(pixels)
            return super().forward(pixels)

    estimate_inverse_depth(of_brightness(Watched), frame[None], DptDinov2Params())
    torch.testing.assert_close(seen[0], expected, rtol=0, atol=1e-5)


def test_an_overflow_is_not_taken_for_infinite_depth():
    class Overflow(Brightness):
        def forward(self, pixels):
            super().forward(pixels).predicted_depth[:, 2, 2] = torch.inf
            return self

    with pytest.raises(InputError, match="not finite"):
        estimate_inverse_depth(of_brightness(Overflow, max_depth=10), noise(1, 28, 28, 3), DptDinov2Params())


def test_dpt_on_another_backbone_is_refused_as_it_gives_inverse_depth():
    files = make_dpt_dinov2(0).files
    config = json.loads(files["config.json"])
    config["backbone_config"]["model_type"] = "dinov2_with_registers"
    tensors = torch.load(io.BytesIO(files["model.bin"]), weights_only=True)
    with pytest.raises(InputError, match="dinov2_with_registers; expected dinov2"):
        build_dpt_dinov2(Checkpoint("tiny", tensors, {"config.json": json.dumps(config)}))
