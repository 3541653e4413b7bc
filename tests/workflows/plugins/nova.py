"""A package that adds one of each kind."""

import cv2
import numpy as np

from moseg import Method
from moseg.tasks.motion_models.flow_model import FlowModel, terms_matrix
from moseg.tasks.point_models.affine import AffineModel
from moseg.workflows.datasets.two_trees import TwoTrees
from moseg.workflows.exports.formats import ExportFormat
from moseg.workflows.exports.owned_folder import OwnedFolder
from moseg.workflows.exports.write_text import write_text
from moseg.workflows.stages.task import Output, Task


def run_flow(params, inputs, rng):
    grey0, grey1 = (cv2.cvtColor(inputs[role].cached("image"), cv2.COLOR_RGB2GRAY) for role in ("frame0", "frame1"))
    return Output({"flow": cv2.calcOpticalFlowFarneback(grey0, grey1, None, 0.5, 5, 15, 3, 5, 1.2, 0)})


def run_affinity(params, inputs, rng):
    residuals = np.concatenate([section.array("residual") for section in inputs.all("residuals")])
    affinity = np.exp(-np.nan_to_num(residuals).mean(axis=0))
    return Output({"affinity": (affinity + affinity.T) / 2, "static_support": affinity[0]})


def view_params(config, view):
    return {}


def write_count(saved, folder, dilation=None):
    with count_folder(folder, saved.summary.name, saved.names) as target:
        write_text(target.folder / "count.txt", f"{len(saved.names)}\n")
    return target.folder


def count_folder(folder, sequence, names):
    return OwnedFolder(folder / "count", ("count.txt",))


_SHIFT = tuple("ab")
PLUGIN = [
    Method(Task("flow", "farneback", version=1, run=run_flow), "Farneback", "OpenCV, Apache-2.0"),
    Method(Task("affinity", "nova-mean", version=1, run=run_affinity, params=view_params), "mean of residuals"),
    FlowModel(
        name="shift",
        parameters=_SHIFT,
        u_terms=terms_matrix(_SHIFT, {"a": (1, "1")}),
        v_terms=terms_matrix(_SHIFT, {"b": (1, "1")}),
        uses_depth=False,
        has_free_shift=True,
    ),
    AffineModel(name="nova-affine"),
    TwoTrees("nova-set", "frames", "masks", "instance", None, None, None, "masks", "https://example.org"),
    ExportFormat("count", "number of frames", write_count, count_folder),
]
