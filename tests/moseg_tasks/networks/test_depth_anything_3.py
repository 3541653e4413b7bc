import hashlib
import json

import pytest
import torch
from safetensors.torch import load

from moseg.schemas.errors import InputError
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth_anything_3 import BASE, SMALL, DepthAnything3, build_depth_anything_3
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


def test_parts_for_cameras_and_rays_are_not_read(checkpoint):
    others = ("model.cam_enc.", "model.cam_dec.", "model.head.scratch.refinenet4_aux.")
    left = {name: tensor for name, tensor in checkpoint.tensors.items() if not name.startswith(others)}
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
