import hashlib
import io
import json

import pytest
import torch
from safetensors.torch import load
from transformers import DepthAnythingConfig, DepthAnythingForDepthEstimation, DPTConfig, DPTForDepthEstimation

from moseg.schemas.errors import InputError
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.depth import build_depth_anything, build_dpt_dinov2
from moseg.workflows.weights.tiny.depth_anything import make_depth_anything
from moseg.workflows.weights.tiny.dpt_dinov2 import make_dpt_dinov2

NETWORKS = {
    "dpt_dinov2": (make_dpt_dinov2, build_dpt_dinov2),
    "depth_anything": (make_depth_anything, build_depth_anything),
}
LAST_BIAS = {"dpt_dinov2": "head.head.4.bias", "depth_anything": "head.conv3.bias"}


def read(maker, **config):
    files = maker(0).files
    document = json.loads(files["config.json"]) | config
    if "model.bin" in files:
        tensors = torch.load(io.BytesIO(files["model.bin"]), weights_only=True)
    else:
        tensors = load(files["model.safetensors"])
    return Checkpoint("tiny", tensors, {"config.json": json.dumps(document)})


def model_of(network):
    return getattr(network, "model", network)


def digest(tensors):
    lines = sorted(f"{name} {tuple(tensor.shape)}" for name, tensor in tensors.items())
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]


def backbone(width, heads, layers, last_layers, **more):
    return {
        "model_type": "dinov2",
        "hidden_size": width,
        "num_attention_heads": heads,
        "num_hidden_layers": layers,
        "image_size": 518,
        "patch_size": 14,
        "out_indices": last_layers,
        "reshape_hidden_states": False,
    } | more


@pytest.mark.parametrize(
    ("width", "heads", "layers", "last_layers", "tensors", "parameters"),
    [(384, 6, 12, [3, 6, 9, 12], 281, 37_197_601), (1024, 16, 24, [5, 12, 18, 24], 497, 339_738_305)],
)
def test_published_dpt_dinov2_has_its_size(width, heads, layers, last_layers, tensors, parameters):
    config = DPTConfig.from_dict(
        {
            "backbone_config": backbone(width, heads, layers, last_layers, apply_layernorm=False),
            "add_projection": True,
            "fusion_hidden_size": 256,
            "neck_hidden_sizes": [width // 8, width // 4, width // 2, width],
            "use_bias_in_fusion_residual": False,
        }
    )
    with torch.device("meta"):
        state = DPTForDepthEstimation(config).state_dict()
    assert (len(state), sum(tensor.numel() for tensor in state.values())) == (tensors, parameters)


def test_published_depth_anything_has_its_size():
    config = DepthAnythingConfig.from_dict(
        {
            "backbone_config": backbone(384, 6, 12, [3, 6, 9, 12]),
            "fusion_hidden_size": 64,
            "neck_hidden_sizes": [48, 96, 192, 384],
            "reassemble_hidden_size": 384,
        }
    )
    with torch.device("meta"):
        state = DepthAnythingForDepthEstimation(config).state_dict()
    assert (len(state), sum(tensor.numel() for tensor in state.values())) == (287, 24_785_089)


@pytest.mark.parametrize(
    ("network", "expected"), [("dpt_dinov2", "bd17934f379e2cb3"), ("depth_anything", "4f5307eb86782b17")]
)
def test_tiny_checkpoint_has_the_published_names(network, expected):
    assert digest(read(NETWORKS[network][0]).tensors) == expected


@pytest.mark.parametrize("network", NETWORKS)
def test_network_is_ready_for_inference(network):
    maker, build = NETWORKS[network]
    model = model_of(build(read(maker)))
    assert not model.training
    assert {tensor.dtype for tensor in model.parameters()} == {torch.float32}
    assert not any(tensor.requires_grad for tensor in model.parameters())


@pytest.mark.parametrize(
    ("network", "size", "golden"),
    [
        # Three patches have four times 16 columns, for the neck halves an odd number of patches upwards.
        ("dpt_dinov2", (1, 32, 64), [2.7743293, 2.822449, 2.6433792, 2.5655298]),
        ("depth_anything", (1, 28, 42), [2.9809755, 2.9923744, 2.995944, 3.0]),
    ],
)
def test_output_of_a_seeded_network_does_not_change(network, size, golden):
    maker, build = NETWORKS[network]
    ramp = torch.linspace(-1, 1, 3 * 28 * 42, dtype=torch.float64).view(1, 3, 28, 42)
    with torch.inference_mode():
        answer = model_of(build(read(maker))).double()(ramp).predicted_depth
    assert answer.shape == size
    # Positions are resampled in float32.
    torch.testing.assert_close(answer[0, ::9, 20], torch.tensor(golden, dtype=torch.float64), rtol=0, atol=1e-4)


@pytest.mark.parametrize("network", NETWORKS)
def test_missing_tensor_is_named(network):
    maker, build = NETWORKS[network]
    checkpoint = read(maker)
    left = {name: tensor for name, tensor in checkpoint.tensors.items() if name != LAST_BIAS[network]}
    with pytest.raises(InputError, match=f"missing in weights tiny; got {LAST_BIAS[network]}"):
        build(checkpoint._replace(tensors=left))


@pytest.mark.parametrize("network", NETWORKS)
def test_left_over_tensor_is_named(network):
    maker, build = NETWORKS[network]
    checkpoint = read(maker)
    with pytest.raises(InputError, match=r"not the network's in weights tiny; got head\.conv9\.bias"):
        build(checkpoint._replace(tensors=dict(checkpoint.tensors) | {"head.conv9.bias": torch.zeros(1)}))


@pytest.mark.parametrize(
    ("config", "depths"),
    [({}, (0, float("inf"))), ({"min_depth": 0.001, "max_depth": 80}, (0.001, 80)), ({"max_depth": 5.5}, (0, 5.5))],
)
def test_the_range_of_depths_is_that_of_the_weights(config, depths):
    network = build_dpt_dinov2(read(make_dpt_dinov2)._replace(config=config))
    assert (network.min_depth, network.max_depth) == depths


@pytest.mark.parametrize("config", [{"max_depth": "far"}, {"min_depth": 3, "max_depth": 2}, {"maximum": 10}])
def test_an_invalid_range_of_depths_is_refused(config):
    with pytest.raises(InputError, match="no range of depths in config of weights tiny"):
        build_dpt_dinov2(read(make_dpt_dinov2)._replace(config=config))


def test_metric_depth_anything_is_refused():
    with pytest.raises(InputError, match="another kind in weights tiny; got metric; expected relative"):
        build_depth_anything(read(make_depth_anything, depth_estimation_type="metric", max_depth=20))
