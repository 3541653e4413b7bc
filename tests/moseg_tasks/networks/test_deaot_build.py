import hashlib
import io

import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.tasks.networks import Checkpoint, unwrap_state
from moseg.tasks.networks.deaot import Deaot, DeaotConfig, build_deaot
from moseg.workflows.weights.tiny.deaot import make_deaot

# Of the sorted lines "name shape", computed with the official R50-DeAOTL.
DIGEST = "c8fdb8bb7946ce6488bbb92a38c57fd4c15302ea58299d9e0387c565eb3933f2"
TINY = make_deaot(0)


def tiny_tensors() -> dict[str, torch.Tensor]:
    return unwrap_state(torch.load(io.BytesIO(TINY.files["model.pth"]), weights_only=True), "tiny")


def test_names_and_shapes_are_those_of_the_published_state_dict():
    with torch.device("meta"):
        network = Deaot(DeaotConfig())
    state = network.state_dict()
    lines = sorted(f"{name} {tuple(tensor.shape)}" for name, tensor in state.items())
    assert len(state) == 354
    assert sum(parameter.numel() for parameter in network.parameters()) == 19_814_894
    assert hashlib.sha256("\n".join(lines).encode()).hexdigest() == DIGEST


def test_a_tiny_checkpoint_builds_ready_to_run():
    network = build_deaot(Checkpoint("tiny", tiny_tensors(), config=TINY.config))
    assert not network.training
    assert {parameter.dtype for parameter in network.parameters()} == {torch.float32}
    assert not any(parameter.requires_grad for parameter in network.parameters())


def test_the_same_seed_gives_the_same_file():
    assert make_deaot(0) == TINY
    assert make_deaot(1).files != TINY.files


def test_a_missing_tensor_is_named():
    tensors = tiny_tensors()
    del tensors["LSTT.layers.1.id_norm1.weight"]
    with pytest.raises(InputError, match=r"missing.*tiny.*LSTT\.layers\.1\.id_norm1\.weight"):
        build_deaot(Checkpoint("tiny", tensors, config=TINY.config))


def test_a_tensor_too_many_is_named():
    tensors = tiny_tensors() | {"LSTT.mask_token": torch.zeros(1)}
    with pytest.raises(InputError, match=r"not the network's.*LSTT\.mask_token"):
        build_deaot(Checkpoint("tiny", tensors, config=TINY.config))


def test_tensors_of_other_sizes_are_named():
    with pytest.raises(
        InputError, match=r"another shape.*patch_wise_id_bank\.weight \(32, 6, 17, 17\) instead of \(32, 5, 17, 17\)"
    ):
        build_deaot(Checkpoint("tiny", tiny_tensors(), config=TINY.config | {"max_objects": 4}))


@pytest.mark.parametrize("config", [{"d_model": 40}, {"num_heads": 8}, {"stage_depths": [1, 2]}])
def test_a_config_that_describes_no_deaot_is_refused(config):
    with pytest.raises(InputError, match=r"tiny.*" + next(iter(config))):
        build_deaot(Checkpoint("tiny", tiny_tensors(), config=config))
