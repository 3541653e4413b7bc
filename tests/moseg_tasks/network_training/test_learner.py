"""Steps of the training."""

import copy

import pytest
import torch

from moseg.schemas.parameters import NetworkTrainingParams
from moseg.tasks.motion_network import CHANNELS
from moseg.tasks.motion_network.unet import MotionUNet
from moseg.tasks.network_training.learner import Learner, apply_network, learning_rate
from moseg.tasks.network_training.losses import label_loss
from moseg.tasks.network_training.validation import validate

PARAMS = NetworkTrainingParams(steps=12, warm_up=3, average=0.5)


@pytest.fixture
def learner():
    torch.manual_seed(0)
    return Learner(MotionUNet(), PARAMS, torch.device("cpu"))


def test_a_few_steps_lower_the_loss_and_find_what_moves(learner, batch):
    losses = [learner.learn(lambda: learner.label_loss(batch)) for _ in range(PARAMS.steps)]
    assert losses[-1] < 0.6 * losses[0]
    assert validate(learner.average, [batch]).J > 70


def test_a_state_goes_on_to_the_same_weights(learner, batch):
    learner.learn(lambda: learner.label_loss(batch))
    other = Learner(MotionUNet(), PARAMS, torch.device("cpu"))
    other.load(copy.deepcopy(learner.state()))
    for each in (learner, other):
        each.learn(lambda each=each: each.label_loss(batch))
    for first, second in zip(learner.average.parameters(), other.average.parameters(), strict=True):
        torch.testing.assert_close(first, second, rtol=0, atol=0)


def test_the_rate_rises_and_falls():
    rates = [learning_rate(step, PARAMS) for step in range(PARAMS.steps)]
    assert rates[0] < rates[1] < rates[2] and rates[3:] == sorted(rates[3:], reverse=True)
    assert max(rates) <= PARAMS.rate * (1 + PARAMS.last_rate)


def test_what_has_no_weight_has_no_loss():
    logit, label, weight = torch.randn(1, 8, 8), torch.ones(1, 8, 8), torch.zeros(1, 8, 8)
    assert float(label_loss(logit, label, weight, 0.02, 0.5)) == 0


@pytest.mark.parametrize(("capability", "kind"), [("AVX512", torch.bfloat16), ("AVX2", torch.float32)])
def test_processors_without_fast_bfloat16_compute_in_single_precision(capability, kind, monkeypatch):
    monkeypatch.setattr(torch.backends.cpu, "get_cpu_capability", lambda: capability)
    network, kinds = MotionUNet().eval(), []
    network.head.register_forward_hook(lambda _, inputs, output: kinds.append(output.dtype))
    assert apply_network(network, torch.zeros(1, len(CHANNELS), 32, 32)).dtype == torch.float32
    assert kinds == [kind]
