"""Export of the motion network to ONNX, with its normalisations merged into the convolutions."""

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper
from torch import nn

from moseg.tasks.motion_network.encoding import CHANNELS
from moseg.tasks.motion_network.unet import Block, MotionUNet

_OPSET = 17
_IR_VERSION = 8


def to_onnx(network: MotionUNet) -> bytes:
    """Return the network as an ONNX file: ``channels`` (1, channel, y, x) to ``logit`` (1, 1, y, x), float32.

    Both sides of the input are multiples of `inference.STRIDE`. Built node by node, so that the same parameters give
    the same bytes with any version of torch.
    """
    graph = _Graph()
    x, seen = "channels", []
    for level, blocks in enumerate(network.down):
        if level:
            x = graph.node("MaxPool", [x], kernel_shape=[2, 2], strides=[2, 2])
        for block in blocks:
            x = graph.block(block, x)
        seen.append(x)
    whole = graph.relu(graph.convolution(network.whole, graph.node("GlobalAveragePool", [x])))
    x = graph.node("Add", [x, whole])
    scales = graph.constant(np.array([1, 1, 2, 2], np.float32))
    for merge, block, beside in zip(network.merge, network.up, seen[-2::-1], strict=True):
        doubled = graph.node(
            "Resize",
            [x, "", scales],
            mode="nearest",
            coordinate_transformation_mode="asymmetric",
            nearest_mode="floor",
        )
        joined = graph.node("Concat", [doubled, beside], axis=1)
        x = graph.block(block, graph.relu(graph.convolution(merge, joined)))
    graph.convolution(network.head, x, name="logit")
    return graph.serialise()


class _Graph:
    """Nodes and constants of an ONNX graph in the making; every method returns the name of its result."""

    def __init__(self) -> None:
        self._nodes: list[onnx.NodeProto] = []
        self._constants: list[onnx.TensorProto] = []

    def node(self, kind: str, inputs: list[str], name: str = "", **attributes) -> str:
        result = name or f"n{len(self._nodes)}"
        self._nodes.append(helper.make_node(kind, inputs, [result], **attributes))
        return result

    def constant(self, values: np.ndarray) -> str:
        name = f"c{len(self._constants)}"
        self._constants.append(numpy_helper.from_array(np.ascontiguousarray(values), name))
        return name

    def relu(self, x: str) -> str:
        return self.node("Relu", [x])

    def convolution(self, layer: nn.Conv2d, x: str, norm: nn.BatchNorm2d | None = None, name: str = "") -> str:
        weight, bias = _merged(layer, norm)
        pads = [*layer.padding, *layer.padding]
        inputs = [x, self.constant(weight), self.constant(bias)]
        return self.node("Conv", inputs, name, kernel_shape=list(layer.kernel_size), pads=pads)

    def block(self, block: Block, x: str) -> str:
        inner = self.relu(self.convolution(block.first, x, block.first_norm))
        short = self.convolution(block.short, x) if isinstance(block.short, nn.Conv2d) else x
        return self.relu(self.node("Add", [self.convolution(block.second, inner, block.second_norm), short]))

    def serialise(self) -> bytes:
        sides = (len(CHANNELS), "y", "x")
        channels = helper.make_tensor_value_info("channels", TensorProto.FLOAT, [1, *sides])
        logit = helper.make_tensor_value_info("logit", TensorProto.FLOAT, [1, 1, *sides[1:]])
        graph = helper.make_graph(self._nodes, "motion_unet", [channels], [logit], self._constants)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", _OPSET)], ir_version=_IR_VERSION)
        onnx.checker.check_model(model)
        return model.SerializeToString(deterministic=True)


def _merged(layer: nn.Conv2d, norm: nn.BatchNorm2d | None) -> tuple[np.ndarray, np.ndarray]:
    """Return weight and bias float32 of a convolution and the normalisation after it, as of inference."""
    weight = layer.weight.detach().double()
    bias = torch.zeros(len(weight), dtype=torch.double) if layer.bias is None else layer.bias.detach().double()
    if norm is not None:
        gain = norm.weight.detach().double() / torch.sqrt(norm.running_var.double() + norm.eps)
        weight = weight * gain[:, None, None, None]
        bias = norm.bias.detach().double() + (bias - norm.running_mean.double()) * gain
    return weight.float().contiguous().numpy(), bias.float().numpy()
