"""Devices that do not exist are rejected, and torch is not loaded before it is needed."""

import subprocess
import sys

import cv2
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.workflows.process import devices
from moseg.workflows.process.devices import current_device, list_accelerators, network_context, parse_device, set_device
from moseg.workflows.process.resources import pin_threads


@pytest.fixture
def machine(monkeypatch):
    """Return a function that simulates CUDA devices and Apple's GPU; restore the chosen device afterwards."""
    monkeypatch.setattr(devices, "_chosen", "auto")

    def pretend(num_cuda=0, has_mps=False):
        monkeypatch.setattr(torch.cuda, "is_available", lambda: num_cuda > 0)
        monkeypatch.setattr(torch.cuda, "device_count", lambda: num_cuda)
        monkeypatch.setattr(torch.backends.mps, "is_available", lambda: has_mps)

    return pretend


def _run_python(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


@pytest.mark.parametrize("text", ["", "gpu", "CPU", "cuda:", "cuda:x", "cuda:-1", "cpu:0", "auto "])
def test_an_unknown_device_is_rejected(text):
    with pytest.raises(InputError, match=r"unknown device in --device; .* expected auto, cpu, cuda"):
        parse_device(text)


@pytest.mark.parametrize(("text", "num_cuda"), [("cuda", 0), ("cuda:0", 0), ("cuda:2", 2), ("mps", 2)])
def test_a_missing_device_is_rejected(machine, text, num_cuda):
    machine(num_cuda)
    with pytest.raises(InputError, match=f"no such device in --device; got {text}"):
        set_device(text)
    assert current_device().type == ("cuda" if num_cuda else "cpu")


@pytest.mark.parametrize(
    ("text", "num_cuda", "has_mps", "expected"),
    [
        ("auto", 0, False, []),
        ("auto", 2, True, ["cuda:0", "cuda:1"]),
        ("auto", 0, True, ["mps"]),
        ("cuda", 2, False, ["cuda:0", "cuda:1"]),
        ("cuda:1", 2, False, ["cuda:1"]),
        ("mps", 0, True, ["mps"]),
        ("cpu", 2, True, []),
    ],
)
def test_a_process_uses_the_first_of_the_accelerators_it_may_use(machine, text, num_cuda, has_mps, expected):
    machine(num_cuda, has_mps)
    assert list(list_accelerators(text)) == expected
    set_device(text)
    assert str(current_device()) == (expected or ["cpu"])[0]


def test_networks_run_without_gradients_and_on_the_cpu_in_full_precision():
    layer = torch.nn.Linear(2, 2)
    with network_context(torch.device("cpu")):
        output = layer(torch.ones(1, 2))
        assert torch.is_inference_mode_enabled()
    assert (output.dtype, output.requires_grad) == (torch.float32, False)
    assert not torch.is_inference_mode_enabled()


def test_runs_without_networks_and_workers_load_neither_torch_nor_distributed():
    code = """
import sys
import moseg.workflows.api
from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.runners import open_runner
for device in ("auto", "cpu"):
    with open_runner(device=device) as runner:
        runner.run([Call("one", abs, (-1,))], lambda name, result: None)
print({"torch", "distributed"} & sys.modules.keys())
"""
    assert _run_python(code) == "set()"


def test_threads_bind_a_torch_loaded_before_or_after():
    code = """
from moseg.workflows.process.resources import pin_threads
pin_threads(2)
import torch
before = torch.get_num_threads()
pin_threads(1)
print(before, torch.get_num_threads())
"""
    assert _run_python(code) == "2 1"


def test_threads_bind_opencv():
    try:
        pin_threads(2)
        assert cv2.getNumThreads() == 2
    finally:
        pin_threads(1)
    assert cv2.getNumThreads() == 1


@pytest.mark.parametrize("count", [0, -1])
def test_fewer_than_one_thread_is_rejected(count):
    with pytest.raises(InputError, match="--threads"):
        pin_threads(count)
