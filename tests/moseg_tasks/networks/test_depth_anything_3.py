import hashlib
import json

import pytest
import torch
from safetensors.torch import load

from moseg.schemas.errors import InputError
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth_anything_3 import (
    BASE,
    SMALL,
    DepthAnything3,
    DepthAnything3Views,
    build_depth_anything_3,
    build_depth_anything_3_cameras,
    build_depth_anything_3_rays,
)
from moseg.workflows.weights.tiny.depth_anything_3 import make_depth_anything_3

LAST_BIAS = "head.scratch.output_conv2.2.bias"


@pytest.fixture(scope="module")
def checkpoint():
    tiny = make_depth_anything_3(0)
    documents = {"config.json": tiny.files["config.json"].decode()}
    return Checkpoint("tiny", load(tiny.files["model.safetensors"]), documents, tiny.config)


def ramp(rows=28, columns=42):
    return torch.linspace(-1, 1, 3 * rows * columns).view(1, 3, rows, columns)


@pytest.mark.parametrize(("config", "tensors", "parameters"), [(SMALL, 269, 24_991_714), (BASE, 269, 98_287_458)])
def test_published_network_has_its_size(config, tensors, parameters):
    with torch.device("meta"):
        state = DepthAnything3(config).state_dict()
    assert (len(state), sum(tensor.numel() for tensor in state.values())) == (tensors, parameters)


@pytest.mark.parametrize(
    ("config", "has_rays", "tensors", "parameters"),
    [
        (SMALL, False, 279, 26_179_819),
        (SMALL, True, 321, 25_627_273),
        (BASE, False, 279, 103_022_955),
        (BASE, True, 321, 100_807_529),
    ],
)
def test_published_network_of_several_views_has_its_size(config, has_rays, tensors, parameters):
    with torch.device("meta"):
        state = DepthAnything3Views(config, has_rays).state_dict()
    assert (len(state), sum(tensor.numel() for tensor in state.values())) == (tensors, parameters)


def test_tiny_checkpoint_has_the_configuration_of_the_published_one():
    """The digest is that of ``config.json`` in the catalogue."""
    digest = hashlib.sha256(make_depth_anything_3(0).files["config.json"]).hexdigest()
    assert digest == "a486e29e82b7ab4a7d4cefc1ea4526cfe2ae438a572c8ca98917cfbcde7447d2"


def test_network_is_ready_for_inference(checkpoint):
    network = build_depth_anything_3(checkpoint)
    assert not network.training
    assert {tensor.dtype for tensor in network.parameters()} == {torch.float32}
    assert not any(tensor.requires_grad for tensor in network.parameters())


@pytest.mark.parametrize("size", [(14, 14), (28, 42), (70, 70)])
def test_depth_has_the_size_of_the_image(checkpoint, size):
    with torch.inference_mode():
        assert build_depth_anything_3(checkpoint)(ramp(*size).expand(2, -1, -1, -1)).shape == (2, *size)


def test_output_of_a_seeded_network_does_not_change(checkpoint):
    with torch.inference_mode():
        answer = build_depth_anything_3(checkpoint)(ramp())
    golden = torch.tensor([-0.1076318, -0.0131057, 0.0027452, -0.3199975])
    torch.testing.assert_close(answer[0, ::9, 20], golden, rtol=0, atol=1e-4)


def is_of_views(name):
    """Return whether a tensor is of the parts for cameras and rays."""
    return name.startswith(("model.cam_enc.", "model.cam_dec.")) or "_aux." in name


def views(number, rows=28, columns=42):
    generator = torch.Generator().manual_seed(0)
    return torch.randn(number, 3, rows, columns, generator=generator)


def seen(build, checkpoint, pixels):
    """Return depth, and cameras or rays, of views of one scene."""
    with torch.inference_mode():
        found = build(checkpoint)(pixels)
    (other,) = (each for each in (found.cameras, found.rays) if each is not None)
    return found.depth, other


BUILDS = pytest.mark.parametrize(
    ("build", "shape"), [(build_depth_anything_3_cameras, (9,)), (build_depth_anything_3_rays, (7, 16, 24))]
)


@BUILDS
@pytest.mark.parametrize("number", [1, 2, 3, 5])
def test_every_view_has_depth_and_a_camera_or_rays(checkpoint, build, shape, number):
    depth, other = seen(build, checkpoint, views(number))
    assert depth.shape == (number, 28, 42) and other.shape == (number, *shape)


@BUILDS
def test_a_single_view_has_the_depth_of_a_single_image(checkpoint, build, shape):
    depth, _ = seen(build, checkpoint, views(1))
    with torch.inference_mode():
        torch.testing.assert_close(depth, build_depth_anything_3(checkpoint)(views(1)))


@BUILDS
def test_views_see_each_other_and_their_order_does_not_matter_but_for_the_reference(checkpoint, build, shape):
    """The reference of five views is the third."""
    first = seen(build, checkpoint, views(5))
    order = [4, 0, 2, 1, 3]
    for found, expected in zip(seen(build, checkpoint, views(5)[order]), first, strict=True):
        torch.testing.assert_close(found, expected[order], rtol=1e-4, atol=1e-4)
    changed = views(5)
    changed[4] = 0
    for found, expected in zip(seen(build, checkpoint, changed), first, strict=True):
        assert (found[0] - expected[0]).abs().max() > 1e-3
    turned = seen(build, checkpoint, views(5).roll(1, dims=0))
    assert (turned[1][1] - first[1][0]).abs().max() > 1e-3


def test_output_of_a_seeded_network_of_several_views_does_not_change(checkpoint):
    _, cameras = seen(build_depth_anything_3_cameras, checkpoint, views(3))
    _, rays = seen(build_depth_anything_3_rays, checkpoint, views(3))
    golden = torch.tensor([[0.2033, 0.1180, 0.1894, 5.1665, 0.9730], [0.7357, -0.1739, -0.0376, 5.7630, 1.3554]])
    torch.testing.assert_close(cameras[::2, ::2], golden, rtol=0, atol=1e-3)
    golden = torch.tensor([[0.2926, 1.1144, -0.0097], [0.1833, 0.8460, 0.4444], [0.3301, 1.0815, 0.0825]])
    torch.testing.assert_close(rays[:, ::3, 8, 12], golden, rtol=0, atol=1e-3)


@pytest.mark.parametrize(
    ("build", "missing"),
    [
        (build_depth_anything_3_cameras, "cam_dec.fc_t.bias"),
        (build_depth_anything_3_rays, "head.scratch.output_conv2_aux.3.5.bias"),
    ],
)
def test_tensors_of_cameras_and_rays_must_be_there(checkpoint, build, missing):
    tensors = {name: tensor for name, tensor in checkpoint.tensors.items() if name != f"model.{missing}"}
    with pytest.raises(InputError, match=f"tensors are missing in weights tiny; got {missing}"):
        build(checkpoint._replace(tensors=tensors))
    with pytest.raises(InputError, match=r"not the network's in weights tiny; got gs_head.norm.bias"):
        build(checkpoint._replace(tensors=dict(checkpoint.tensors) | {"gs_head.norm.bias": torch.zeros(1)}))


def test_parts_for_cameras_and_rays_are_not_read(checkpoint):
    left = {name: tensor for name, tensor in checkpoint.tensors.items() if not is_of_views(name)}
    assert len(left) < len(checkpoint.tensors)
    found, expected = (
        build_depth_anything_3(each).state_dict() for each in (checkpoint._replace(tensors=left), checkpoint)
    )
    assert found.keys() == expected.keys()
    assert all(torch.equal(found[name], expected[name]) for name in found)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({LAST_BIAS: None}, f"tensors are missing in weights tiny; got {LAST_BIAS}"),
        ({"gs_head.norm.bias": torch.zeros(1)}, "not the network's in weights tiny; got gs_head.norm.bias"),
        ({LAST_BIAS: torch.zeros(3)}, rf"of another shape in weights tiny; got {LAST_BIAS} \(3,\) instead of \(2,\)"),
    ],
)
def test_tensors_of_another_network_are_named(checkpoint, changed, message):
    tensors = dict(checkpoint.tensors) | {f"model.{name}": tensor for name, tensor in changed.items()}
    with pytest.raises(InputError, match=message):
        build_depth_anything_3(
            checkpoint._replace(tensors={name: tensor for name, tensor in tensors.items() if tensor is not None})
        )


@pytest.mark.parametrize(
    ("document", "got"),
    [
        ({"model_name": "da3mono-large"}, "got da3mono-large; "),
        ({"model_type": "depth_anything"}, "got no model_name; "),
    ],
)
def test_another_network_of_the_family_is_refused(checkpoint, document, got):
    expected = f"another network in config.json of weights tiny; {got}expected da3-small or da3-base"
    with pytest.raises(InputError, match=expected):
        build_depth_anything_3(checkpoint._replace(documents={"config.json": json.dumps(document)}))


def test_neither_head_nor_rotation_depends_on_the_precision_of_the_rest(checkpoint):
    network = build_depth_anything_3(checkpoint)
    with torch.inference_mode():
        full = network(ramp())
        with torch.autocast("cpu", dtype=torch.bfloat16):
            half = network(ramp())
    assert half.dtype == torch.float32
    assert 0 < (half - full).abs().max() < 0.1


@BUILDS
def test_neither_cameras_nor_rays_depend_on_the_precision_of_the_rest(checkpoint, build, shape):
    _, full = seen(build, checkpoint, views(3))
    with torch.autocast("cpu", dtype=torch.bfloat16):
        _, half = seen(build, checkpoint, views(3))
    assert half.dtype == torch.float32
    assert 0 < (half - full).abs().max() < 0.1
