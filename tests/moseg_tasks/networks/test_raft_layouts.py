import hashlib

import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.raft import LARGE, SMALL, Raft, build_raft

# Of the sorted lines "name shape", computed with torchvision's and princeton's own modules.
TORCHVISION = {
    "large": (169, 5257536, "23b50731fc53e26ae87cbca92e0532e4098a7c157a2269509c8f819e7860f434"),
    "small": (106, 990162, "b52844207e5a43c48b531e21242a63b775b5e556d38eb5545e847e2acf44dd88"),
}
PRINCETON = {
    "large": (179, "d23655e307bf410219d8a58379c482ad43b5adc1dfdb404a9600781c2cc216af"),
    "small": (106, "37c09a4f15a3cdf0d74265f76a5422426312785831e521e0d3ee767b23a73851"),
}
CONFIGS = {"large": LARGE, "small": SMALL}
SIZES = sorted(CONFIGS)
TO_PRINCETON = (
    ("feature_encoder.", "fnet."),
    ("context_encoder.", "cnet."),
    ("mask_predictor.convrelu.0", "update_block.mask.0"),
    ("mask_predictor.conv.", "update_block.mask.2."),
    ("motion_encoder.convcorr1.0", "encoder.convc1"),
    ("motion_encoder.convcorr2.0", "encoder.convc2"),
    ("motion_encoder.convflow1.0", "encoder.convf1"),
    ("motion_encoder.convflow2.0", "encoder.convf2"),
    ("motion_encoder.conv.0", "encoder.conv"),
    *((f"convnormrelu{k}.0", f"conv{k}") for k in (1, 2, 3)),
    *((f"convnormrelu{k}.1", f"norm{k}") for k in (1, 2, 3)),
    ("net.conv.", "net.conv2."),
    ("convnormrelu.0", "conv1"),
    ("convnormrelu.1", "norm1"),
)


def digest(tensors):
    lines = sorted(f"{key} {tuple(value.shape)}" for key, value in tensors.items())
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def tensors_of(size):
    """Tensors in torchvision's layout, each with a value of its own in its first place."""
    with torch.device("meta"):
        shapes = Raft(CONFIGS[size]).state_dict()
    tensors = {key: torch.zeros(value.shape, dtype=value.dtype) for key, value in shapes.items()}
    for k, value in enumerate(tensors.values()):
        value.view(-1)[0] = k
    return tensors


def princeton_tensors_of(size):
    renamed = {}
    for key, value in tensors_of(size).items():
        for ours, theirs in TO_PRINCETON:
            key = key.replace(ours, theirs)
        gru = "update_block.recurrent_block.convgru"
        if key.startswith(gru):
            number, gate, kind = key.removeprefix(gru).split(".")
            key = f"update_block.gru.{gate}{number if size == 'large' else ''}.{kind}"
        renamed[key] = value
        if ".downsample.1." in key:
            renamed[key.replace(".downsample.1.", ".norm3.")] = value.clone()
    return renamed


@pytest.mark.parametrize("size", SIZES)
def test_the_state_dict_is_torchvisions(size):
    with torch.device("meta"):
        network = Raft(CONFIGS[size])
    state = network.state_dict()
    num_parameters = sum(value.numel() for value in network.parameters())
    assert (len(state), num_parameters, digest(state)) == TORCHVISION[size]


@pytest.mark.parametrize("size", SIZES)
def test_both_layouts_give_the_same_network(size):
    princeton = princeton_tensors_of(size)
    assert (len(princeton), digest(princeton)) == PRINCETON[size]
    built = [build_raft(Checkpoint("random", tensors)) for tensors in (tensors_of(size), princeton)]
    assert all(network.config == CONFIGS[size] and not network.training for network in built)
    states = [network.state_dict() for network in built]
    assert all(torch.equal(value, states[1][key]) for key, value in states[0].items())


@pytest.mark.parametrize("make", [tensors_of, princeton_tensors_of])
@pytest.mark.parametrize("size", SIZES)
def test_a_missing_an_unknown_and_a_misshapen_tensor_are_input_errors(make, size):
    whole = make(size)
    for key in (next(iter(whole)), list(whole)[-1]):
        with pytest.raises(InputError, match="missing in weights random"):
            build_raft(Checkpoint("random", {name: value for name, value in whole.items() if name != key}))
        with pytest.raises(InputError, match="another shape"):
            build_raft(Checkpoint("random", whole | {key: torch.zeros(1, 2, 3)}))
    with pytest.raises(InputError, match=r"not the network's.*layer9"):
        build_raft(Checkpoint("random", whole | {"layer9.weight": torch.zeros(1)}))


def test_tensors_of_another_network_are_an_input_error():
    with pytest.raises(InputError, match="missing in weights other"):
        build_raft(Checkpoint("other", {"weight": torch.zeros(1)}))


@pytest.mark.parametrize("change", [{"cnet.layer2.0.norm3.weight": torch.ones(96)}, {}])
def test_the_two_copies_of_a_shortcuts_norm_must_be_there_and_equal(change):
    tensors = princeton_tensors_of("large")
    del tensors["cnet.layer2.0.norm3.weight"]
    with pytest.raises(InputError, match=r"norm3 in weights random; got cnet\.layer2\.0\.downsample\.1\.weight"):
        build_raft(Checkpoint("random", tensors | change))


@pytest.mark.parametrize("config", [{"widths": 3}, {"feature_channels": 0}, {"block": "dense"}])
def test_sizes_that_raft_does_not_have_are_an_input_error(config):
    with pytest.raises(InputError, match="invalid sizes in config of weights random"):
        build_raft(Checkpoint("random", tensors_of("small"), config=config))
