"""The motion network in torch again, from its ONNX file."""

from collections.abc import Iterator

import numpy as np
import onnx
import torch
from onnx import numpy_helper
from torch import nn

from moseg.schemas.errors import InputError
from moseg.tasks.motion_network.unet import Block, MotionUNet


def from_onnx(content: bytes) -> MotionUNet:
    """Return the network that `to_onnx` exported, in its state of inference.

    Its normalisations are merged into the convolutions: what is left of them adds the bias.

    Raises
    ------
    InputError
        The bytes are no ONNX file, or that of another network.
    """
    network = MotionUNet().eval()
    try:
        graph = onnx.load_model_from_string(content).graph
        constants = {each.name: numpy_helper.to_array(each) for each in graph.initializer}
        read = [[constants[name] for name in node.input[1:]] for node in graph.node if node.op_type == "Conv"]
        for (layer, norm), (weight, bias) in zip(_convolutions(network), read, strict=True):
            _fill(layer, norm, weight, bias)
    # Protobuf's errors and those of damaged constants have no common class.
    except Exception as error:
        got = (str(error) or type(error).__name__).splitlines()[0]
        raise InputError("not a motion network", got=got, expected="an ONNX file of `moseg train`") from error
    return network


@torch.no_grad()
def _fill(layer: nn.Conv2d, norm: nn.BatchNorm2d | None, weight: np.ndarray, bias: np.ndarray) -> None:
    if weight.shape != tuple(layer.weight.shape) or bias.shape != weight.shape[:1]:
        raise ValueError(f"weights {weight.shape} where {tuple(layer.weight.shape)} are expected")
    layer.weight.copy_(torch.from_numpy(weight.copy()))
    if norm is None:
        layer.bias.copy_(torch.from_numpy(bias.copy()))
        return
    norm.bias.copy_(torch.from_numpy(bias.copy()))
    norm.running_var.fill_(1 - norm.eps)


def _convolutions(network: MotionUNet) -> Iterator[tuple[nn.Conv2d, nn.BatchNorm2d | None]]:
    """Yield the convolutions and the normalisations after them, in the order of the export."""
    for blocks in network.down:
        for block in blocks:
            yield from _of_block(block)
    yield network.whole, None
    for merge, block in zip(network.merge, network.up, strict=True):
        yield merge, None
        yield from _of_block(block)
    yield network.head, None


def _of_block(block: Block) -> Iterator[tuple[nn.Conv2d, nn.BatchNorm2d | None]]:
    yield block.first, block.first_norm
    if isinstance(block.short, nn.Conv2d):
        yield block.short, None
    yield block.second, block.second_norm
