import hashlib

import numpy as np
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.sea_raft import MEDIUM, SMALL, SeaRaft, SeaRaftConfig, build_sea_raft
from moseg.workflows.weights.tiny.sea_raft import to_published_name

CONFIGS = {"M": MEDIUM, "S": SMALL}
SIZES = sorted(CONFIGS)
# Of the sorted lines "name shape" of the authors' module, as their hub's files hold it and as `state_dict` gives it,
# and its parameters.
PUBLISHED = {
    "M": (452, "23136616c9f33463e80ec8d947da489f39429e9e6312ac065c05b2b245790786", 19663876),
    "S": (256, "c52f562cda91ad59f9e89314e2ce77bef056a74228ee94dd0fe73eec7c048c16", 8883460),
}
BOTH_NAMES = {
    "M": (472, "ca19f2147c70b36cb17c75c883e2bf5cbb0404021b1d1a8d5b9b9dceb847216d"),
    "S": (276, "b19fcb7a8eba434a8f465cd12223b31e595c68e8891c3274640ae5edc5b187d7"),
}
WIDTHS = {"stage_channels": (8, 12, 16), "hidden_channels": 16, "correlation_radius": 2}
# Flow after three steps at every 64th pixel of both sides, as the authors' module gives it with the same tensors.
GOLDEN = {
    "M": [
        [[-0.331664963, -0.139227511, 0.434550636], [-0.947425389, -0.691640303, 0.451007348]],
        [[0.884776724, 2.121062792, 1.270061273], [1.503002711, 4.59708163, 2.123589952]],
    ],
    "S": [
        [[-0.002781514, -0.622174435, -0.440688878], [-0.28239004, -1.07576958, -0.859493419]],
        [[0.407822963, 1.478866269, 0.910859383], [1.059058988, 3.141346985, 1.785325283]],
    ],
}


def digest(tensors):
    lines = sorted(f"{key} {tuple(value.shape)}" for key, value in tensors.items())
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def tensors_of(size):
    """Return tensors in the layout of the hub's files, each with a value of its own in its first place."""
    with torch.device("meta"):
        shapes = SeaRaft(CONFIGS[size]).state_dict()
    tensors = {to_published_name(key): torch.zeros(like.shape, dtype=like.dtype) for key, like in shapes.items()}
    for k, value in enumerate(tensors.values()):
        value.view(-1)[0] = k
    return tensors


def with_both_names(tensors):
    """Return the tensors as the authors' ``.pth`` files hold them: the normalisation of a shortcut twice."""
    return tensors | {
        key.replace(".bn3.", ".downsample.1."): value.clone() for key, value in tensors.items() if ".bn3." in key
    }


def random_sea_raft(size):
    network = SeaRaft(SeaRaftConfig.model_validate(CONFIGS[size].model_dump() | WIDTHS))
    network = network.double().eval().requires_grad_(False)
    generator = torch.Generator().manual_seed(0)
    for key, value in network.state_dict().items():
        if value.is_floating_point():
            noise = torch.randn(value.shape, generator=generator, dtype=torch.float64)
            spread = (2 / value[0].numel()) ** 0.5 if value.ndim > 1 else 0.1
            value.copy_(noise * spread * (0.05 if "flow_head.2" in key else 1) + (".running_var" in key))
    return network


def random_images(height=128, width=136):
    rng = np.random.default_rng(0)
    return [torch.from_numpy(rng.uniform(-1, 1, (1, 3, height, width))) for _ in range(2)]


@pytest.mark.parametrize("size", SIZES)
def test_the_state_dict_is_the_authors(size):
    published = tensors_of(size)
    with torch.device("meta"):
        num_parameters = sum(value.numel() for value in SeaRaft(CONFIGS[size]).parameters())
    assert (len(published), digest(published), num_parameters) == PUBLISHED[size]
    twice = with_both_names(published)
    assert (len(twice), digest(twice)) == BOTH_NAMES[size]


@pytest.mark.parametrize("size", SIZES)
def test_files_with_either_or_both_names_of_a_shortcuts_norm_give_the_same_network(size):
    published = tensors_of(size)
    other = {key.replace(".bn3.", ".downsample.1."): value for key, value in published.items()}
    built = [build_sea_raft(Checkpoint("random", each)) for each in (published, other, with_both_names(published))]
    assert all(network.config == CONFIGS[size] and not network.training for network in built)
    first, *others = (network.state_dict() for network in built)
    assert all(torch.equal(value, state[key]) for state in others for key, value in first.items())
    assert all(torch.equal(value, published[to_published_name(key)]) for key, value in first.items())


def test_two_copies_of_a_shortcuts_norm_that_differ_are_an_input_error():
    tensors = with_both_names(tensors_of("S"))
    tensors["cnet.layer2.0.bn3.weight"] = torch.full((128,), 7.0)
    with pytest.raises(InputError, match=r"differ in weights random; got cnet\.layer2\.0\.bn3\.weight"):
        build_sea_raft(Checkpoint("random", tensors))


@pytest.mark.parametrize("size", SIZES)
def test_a_missing_an_unknown_and_a_misshapen_tensor_are_input_errors(size):
    whole = tensors_of(size)
    for key in (next(iter(whole)), "cnet.layer3.0.bn3.bias", list(whole)[-1]):
        with pytest.raises(InputError, match="missing in weights random"):
            build_sea_raft(Checkpoint("random", {name: value for name, value in whole.items() if name != key}))
        with pytest.raises(InputError, match="another shape"):
            build_sea_raft(Checkpoint("random", whole | {key: torch.zeros(1, 2, 3)}))
    with pytest.raises(InputError, match=r"not the network's.*layer9"):
        build_sea_raft(Checkpoint("random", whole | {"layer9.weight": torch.zeros(1)}))


@pytest.mark.parametrize("config", [{"widths": 3}, {"hidden_channels": 6}])
def test_sizes_that_sea_raft_does_not_have_are_an_input_error(config):
    with pytest.raises(InputError, match="invalid sizes in config of weights random"):
        build_sea_raft(Checkpoint("random", tensors_of("S"), config=config))


@pytest.mark.parametrize("size", SIZES)
def test_flow_is_the_official_modules(size):
    flow = random_sea_raft(size)(*random_images(), 3)
    assert flow.dtype == torch.float64 and flow.shape == (1, 2, 128, 136)
    np.testing.assert_allclose(flow[0, :, ::64, ::64].numpy(), GOLDEN[size], atol=1e-6)


@pytest.mark.parametrize("size", SIZES)
def test_correlations_on_demand_give_the_flow_of_those_held(size, monkeypatch):
    monkeypatch.setattr("moseg.tasks.networks.raft.correlation._MAX_BLOCK", 5000)
    network, images = random_sea_raft(size), random_images()
    held, on_demand = (network(*images, 3, is_on_demand) for is_on_demand in (False, True))
    assert held.abs().max() > 0.1
    np.testing.assert_allclose(on_demand.numpy(), held.numpy(), atol=1e-9)


@pytest.mark.parametrize("size", SIZES)
def test_under_autocast_flow_stays_in_float32_and_near(size, in_half_precision, relative_error):
    network, images = random_sea_raft(size).float(), [image.float() for image in random_images()]
    exact = network(*images, 4)
    half = in_half_precision(lambda: network(*images, 4))
    assert exact.dtype == half.dtype == torch.float32
    assert relative_error(half, exact) < 0.25


@pytest.mark.parametrize(("config", "side"), [(MEDIUM, 128), (SeaRaftConfig(correlation_levels=2), 32)])
def test_the_minimal_side_leaves_the_coarsest_level_two_cells(config, side):
    with torch.device("meta"):
        assert SeaRaft(config).min_side == side
