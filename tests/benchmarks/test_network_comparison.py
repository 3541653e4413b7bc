"""The comparison of a network's outputs in two precisions (``benchmarks/networks/comparison.py``)."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import torch

FILE = Path(__file__).parents[2] / "benchmarks" / "networks" / "comparison.py"


@pytest.fixture(scope="module")
def comparison():
    spec = importlib.util.spec_from_file_location("comparison", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_outputs_tell_which_module_is_not_finite_and_how_far_two_runs_are_apart(comparison):
    network = torch.nn.Sequential(torch.nn.Identity(), torch.nn.Identity())
    with comparison.Outputs(network) as single:
        network(torch.tensor([3.0, -4.0]))
    with comparison.Outputs(network) as half:
        network(torch.tensor([3.0, -4.5]).half())
    assert half.largest(torch.float16) == ("0", 4.5) and half.largest(torch.float32) is None
    assert half.differences(single) == {"network": pytest.approx(0.1)}
    with comparison.Outputs(network) as other:
        network(torch.tensor([1e6]).half())
    assert other.non_finite() == ["0", "1", ""] and single.non_finite() == []


def test_results_are_compared_by_their_kind(comparison):
    flow = np.zeros((1, 2, 2, 2), np.float32)
    assert comparison.compare_results(flow + 3, flow)["px"] == pytest.approx(np.hypot(3, 3))
    labels = np.array([[[0, 1], [1, 1]]], np.uint16)
    assert comparison.compare_results(labels, labels // 2) == {"other pixels": 0.75, "shown": 0.0}
    assert comparison.is_finite((labels, flow)) and not comparison.is_finite((labels, flow + np.inf))
