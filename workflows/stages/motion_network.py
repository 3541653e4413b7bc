"""Motion network: what a network trained on rendered scenes says of the motion of a frame."""

import threading

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import SALIENCY_SOURCES, PipelineConfig
from moseg.schemas.parameters import SaliencyParams
from moseg.workflows.stages.reduced_frame import reduced_levels
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

_FIT_PARAMS = frozenset(
    {name for name in SaliencyParams.model_fields if name.startswith(("ransac_", "affine_"))}
    | {"tukey_constant", "border_band", "centre_thinning"}
)
"""Parameters of saliency that the fit of the background's first layer reads."""


def uses_motion_network(config: PipelineConfig) -> bool:
    """Return whether a configuration looks for moving objects with the network."""
    return config.motion_network.use == "always" and config.proposal_source in SALIENCY_SOURCES


def _run(params, inputs, rng):
    from moseg.tasks.half_floats import to_float16
    from moseg.tasks.motion_network import encode_motion, motion_network_logit

    saliency = SaliencyParams.of_recipe(params["saliency"])
    middle = _Looked(inputs, "frame", "saliency")
    neighbours = []
    for direction, side in enumerate(("previous", "next")):
        if side in inputs:
            neighbours.append(middle.neighbour(_Looked(inputs, side, f"saliency_{side}"), direction))
        else:
            neighbours.append(None)
    channels = encode_motion(middle.image, *neighbours, saliency)
    with _IN_USE:
        logit = motion_network_logit(_network(inputs["network"]), channels)
    return Output({"logit": to_float16(logit)})


class _Looked:
    """A frame on the working grid with its flows."""

    def __init__(self, inputs, frame: str, saliency: str):
        self._saliency = inputs[saliency]
        shape = self._saliency.shape("saliency")
        self.image = reduced_levels(inputs[frame], shape).astype(np.float32)

    def neighbour(self, other: "_Looked", direction: int):
        """Return another frame as the neighbour in a direction: 0 the previous frame, 1 the next one."""
        from moseg.tasks.half_floats import to_float32
        from moseg.tasks.motion_network import Neighbour
        from moseg.tasks.saliency import AffineMotion

        flow, residual = (to_float32(self._saliency.array(name)[direction]) for name in ("flows", "residual_flows"))
        back = to_float32(other._saliency.array("flows")[1 - direction])
        first_layer = self._saliency.attributes["first_layers"][direction]
        return Neighbour(other.image, flow, back, residual, first_layer and AffineMotion.of_json(first_layer))


_READ = {}
_IN_USE = threading.Lock()
"""Lock for workers with several threads: OpenCV's networks hold the maps of one image at a time."""


def _network(leaf):
    """Return the network of a leaf; the last one is kept in this process."""
    from moseg.tasks.motion_network import read_network

    if leaf.ref not in _READ:
        _READ.clear()
        _READ[leaf.ref] = read_network(leaf.array("onnx").tobytes())
    return _READ[leaf.ref]


def _params(config: PipelineConfig) -> dict:
    return {"saliency": config.saliency.model_dump(mode="json", include=_FIT_PARAMS)}


RENDERED_SCENES = Task("motion_network", "rendered-scenes", version=2, run=_run, params=_params, is_cheap=True)

STAGE = Stage(
    name="motion_network",
    about="logit of the motion network for a frame",
    inputs={
        "frame": "the frame",
        "saliency": "its flows and their residuals",
        "previous": "frame before, of the picture that it is compared with",
        "saliency_previous": "its flows",
        "next": "frame after, of the picture that it is compared with",
        "saliency_next": "its flows",
        "network": "the network",
    },
    arrays={"logit": layout("float16", "y x", "logit, on the network's grid")},
    tasks=(RENDERED_SCENES,),
)
