"""The motion network in torch again, from its ONNX file."""

from collections.abc import Iterator

import numpy as np
import onnx
import torch
from google.protobuf.message import DecodeError
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
    layers, read = list(_convolutions(network)), _read_convolutions(content)
    shapes = [tuple(layer.weight.shape) for layer, _ in layers]
    if [weight.shape for weight, _ in read] != shapes or any(len(bias) != len(weight) for weight, bias in read):
        raise _not_a_network(f"{len(read)} convolutions of other shapes or another number")
    for (layer, norm), (weight, bias) in zip(layers, read, strict=True):
        _fill(layer, norm, weight, bias)
    return network


def _read_convolutions(content: bytes) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return weight and bias of each convolution of an ONNX file; raises InputError."""
    try:
        graph = onnx.load_model_from_string(content).graph
        constants = {each.name: numpy_helper.to_array(each) for each in graph.initializer}
        names = [tuple(node.input) for node in graph.node if node.op_type == "Conv"]
        return [(constants[weight], constants[bias]) for _, weight, bias in names]
    except (DecodeError, KeyError, TypeError, ValueError) as error:
        raise _not_a_network((str(error) or type(error).__name__).splitlines()[0]) from error


def _not_a_network(got: str) -> InputError:
    return InputError("not a motion network", got=got, expected="an ONNX file of `moseg train`")


@torch.no_grad()
def _fill(layer: nn.Conv2d, norm: nn.BatchNorm2d | None, weight: np.ndarray, bias: np.ndarray) -> None:
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
