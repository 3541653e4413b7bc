import json
import logging

import pytest
import torch
from transformers import SamHQConfig, SamHQModel

from moseg.schemas.errors import InputError
from moseg.tasks.networks.transformers_model import build_transformers, quiet_transformers

QKV = "vision_encoder.layers.0.attn.qkv.weight"
SHARED = "prompt_encoder.shared_embedding.positional_embedding"


def build(checkpoint, tensors=None, documents=None):
    changed = {name: value for name, value in {**checkpoint.tensors, **(tensors or {})}.items() if value is not None}
    changed = checkpoint._replace(tensors=changed, documents={**checkpoint.documents, **(documents or {})})
    return build_transformers(SamHQModel, SamHQConfig, changed)


def test_every_tensor_is_the_checkpoints(sam_hq_checkpoint):
    state = build(sam_hq_checkpoint).state_dict()
    assert sam_hq_checkpoint.tensors.keys() <= state.keys()
    assert all(torch.equal(state[name], value) for name, value in sam_hq_checkpoint.tensors.items())


def test_a_built_model_is_ready_to_run(sam_hq_checkpoint):
    model = build(sam_hq_checkpoint)
    assert not model.training
    assert not any(value.requires_grad for value in model.parameters())
    assert {value.device.type for value in model.state_dict().values()} == {"cpu"}


def test_half_precision_is_read_as_single(sam_hq_checkpoint):
    halved = {name: value.half() for name, value in sam_hq_checkpoint.tensors.items()}
    state = build(sam_hq_checkpoint, tensors=halved).state_dict()
    assert {value.dtype for value in state.values()} == {torch.float32}


def test_building_draws_no_random_numbers(sam_hq_checkpoint):
    before = torch.random.get_rng_state()
    build(sam_hq_checkpoint)
    assert torch.equal(torch.random.get_rng_state(), before)


@pytest.mark.parametrize(
    ("tensors", "message"),
    [
        ({QKV: None}, f"tensors are missing in weights tiny; got {QKV}"),
        ({"head.weight": torch.zeros(2)}, "tensors are not the network's in weights tiny; got head.weight"),
        ({QKV: torch.zeros(3, 3)}, rf"of another shape.*{QKV} \(3, 3\) instead of \(48, 16\)"),
        ({SHARED: torch.zeros(2, 3)}, rf"of another shape.*{SHARED} \(2, 3\) instead of \(2, 16\)"),
    ],
)
def test_tensors_that_do_not_fit_are_named(sam_hq_checkpoint, tensors, message):
    with pytest.raises(InputError, match=message):
        build(sam_hq_checkpoint, tensors=tensors)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not JSON in config.json of weights tiny"),
        ("[]", "no JSON object in config.json"),
        ('{"vision_config": {"hidden_size": "wide"}}', "no configuration of SamHQConfig"),
    ],
)
def test_an_invalid_config_is_refused(sam_hq_checkpoint, text, message):
    with pytest.raises(InputError, match=message):
        build(sam_hq_checkpoint, documents={"config.json": text})


def test_a_checkpoint_without_config_is_refused(sam_hq_checkpoint):
    with pytest.raises(InputError, match=r"no config\.json in weights tiny"):
        build_transformers(SamHQModel, SamHQConfig, sam_hq_checkpoint._replace(documents={}))


def test_a_config_may_have_unknown_fields(sam_hq_checkpoint):
    config = json.loads(sam_hq_checkpoint.documents["config.json"]) | {"transformers_version": "4.1", "novelty": 1}
    build(sam_hq_checkpoint, documents={"config.json": json.dumps(config)})


def test_building_and_failing_print_nothing(sam_hq_checkpoint, capfd, caplog):
    build(sam_hq_checkpoint)
    with pytest.raises(InputError):
        build(sam_hq_checkpoint, tensors={QKV: None})
    assert capfd.readouterr() == ("", "")
    assert not caplog.records


def test_transformers_logging_is_restored_afterwards():
    logger = logging.getLogger("transformers")
    before = logger.level
    with quiet_transformers():
        assert not logger.isEnabledFor(logging.ERROR)
    assert logger.level == before
