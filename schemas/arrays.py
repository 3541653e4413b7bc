"""Layouts of the arrays that stages hand on: dtype, axes and unit of each."""

import numpy as np

from moseg.schemas.errors import StoreError
from moseg.schemas.frozen import Frozen


class ArrayLayout(Frozen):
    """Numpy dtype, axis names (outermost first) and unit of one array."""

    dtype: str
    dims: tuple[str, ...]
    unit: str = ""


def _layout(dtype: str, dims: str, unit: str = "") -> ArrayLayout:
    return ArrayLayout(dtype=dtype, dims=tuple(dims.split()), unit=unit)


LAYOUTS: dict[str, dict[str, ArrayLayout]] = {
    "frame": {"image": _layout("uint8", "y x rgb")},
    "annotation": {"masks": _layout("uint16", "frame y x")},
    "labelled_points": {
        "points": _layout("float64", "track frame xy", "px of the original frames"),
        "visible": _layout("bool", "track frame"),
        "labels": _layout("uint16", "track", "0 = static, else the label of what moves"),
    },
    "given_masks": {"masks": _layout("uint16", "frame y x")},
    "given_depth": {"inverse_depth": _layout("float32", "y x", "relative")},
    "given_flow": {"flow": _layout("float32", "y x uv", "px/frame")},
    "given_tracks": {
        "points": _layout("float32", "track frame xy", "px"),
        "visible": _layout("bool", "track frame"),
    },
    "trajectories": {
        "points": _layout("float64", "track frame xy", "px"),
        "visible": _layout("bool", "track frame"),
    },
    "trajectory_labels": {"labels": _layout("uint16", "track", "motion")},
    "flow": {"flow": _layout("float32", "y x uv", "px/frame")},
    "depth": {"inverse_depth": _layout("float32", "y x", "relative")},
    "detections": {
        "boxes": _layout("float32", "detection xyxy", "px"),
        "scores": _layout("float64", "detection", "0..1"),
    },
    "instances": {
        "labels": _layout("uint16", "y x", "object of the frame, 0 = background"),
        "scores": _layout("float64", "object"),
    },
    "seeds": {
        "labels": _layout("uint16", "y x", "object of the section, 0 = background"),
        "scores": _layout("float64", "object"),
        "identities": _layout("uint16", "object", "object of the sequence"),
    },
    "background": {},
    "saliency": {
        "saliency": _layout("float16", "y x", "0..1"),
        "strict_saliency": _layout("float16", "y x", "0..1"),
        "flows": _layout("float16", "direction y x uv", "px/frame of the working grid"),
        "residual_flows": _layout("float16", "direction y x uv", "px/frame of the working grid"),
    },
    "consistency": {"consistency": _layout("float16", "frame direction y x", "0..1")},
    "accumulation": {"maps": _layout("float16", "frame y x map", "0..1: strict saliency, saliency, consistency")},
    "own_motion": {"misfit": _layout("float16", "frame y x", "log(1 + squared deviation in spreads)")},
    "coherence": {"misfit": _layout("float16", "frame y x", "log(1 + squared deviation in spreads)")},
    "appearance": {
        "bins": _layout("uint16", "frame y x", "bin of CIELAB"),
        "histograms": _layout("float32", "side bin", "weight of what moves, of the background"),
    },
    "foreground": {"foreground": _layout("float16", "frame y x", "probability")},
    "components": {
        "labels": _layout("uint16", "frame y x", "object of the section, 0 = background"),
        "scores": _layout("float64", "object"),
    },
    "proposals": {
        "masks": _layout("uint16", "frame y x", "object of the section, 0 = background"),
        "scores": _layout("float64", "object"),
        "boxes": _layout("int32", "object frame xyxy", "px, -1 where absent"),
    },
    "linking": {
        "identity": _layout("uint16", "section object", "object of the sequence, 0 = background"),
    },
    "tracks": {
        "points": _layout("float32", "track frame xy", "px"),
        "visible": _layout("bool", "track frame"),
        "object": _layout("uint16", "track", "object of the section"),
    },
    "fundamental": {
        "F": _layout("float64", "section_pair object row column"),
        "valid": _layout("bool", "section_pair object"),
        "counts": _layout("int32", "section_pair object points_inliers_homography", "points"),
        "reason": _layout("uint8", "section_pair object", "why the fit is degenerate"),
        "kind": _layout("uint8", "section_pair object", "0 none, 1 fundamental matrix, 2 homography"),
    },
    "flow_model": {
        "theta": _layout("float64", "section_pair object parameter"),
        "valid": _layout("bool", "section_pair object"),
        "moments": _layout("float64", "section_pair object moment"),
    },
    "fundamental_residual": {"residual": _layout("float64", "section_pair model_object data_object", "px^2")},
    "flow_residual": {
        "residual": _layout("float64", "section_pair model_object data_object", "(px/frame)^2"),
        "energy": _layout("float64", "section_pair object", "(px/frame)^2"),
    },
    "object_hypotheses": {
        "residual": _layout(
            "float32",
            "section_pair model hypothesis node",
            "px^2; objects, then cells of the background",
        )
    },
    "affinity": {"affinity": _layout("float64", "object object"), "static_support": _layout("float64", "object")},
    "clustering": {
        "motion": _layout("uint16", "object", "motion group, 0 = the background's"),
        "embedding": _layout("float64", "object coordinate"),
        "eigenvalues": _layout("float64", "view eigenvalue"),
    },
    "hypotheses": {
        "parameters": _layout("float64", "frame_set hypothesis parameter"),
        "frames": _layout("int32", "frame_set frame"),
    },
    "hypothesis_residual": {"residual": _layout("float16", "frame_set hypothesis track", "px, NaN where not seen")},
    "kernel": {"kernel": _layout("float32", "draw track track")},
    "trajectory_clustering": {
        "motion": _layout("uint16", "track", "motion group"),
        "embedding": _layout("float64", "track coordinate"),
        "eigenvalues": _layout("float64", "view eigenvalue"),
        "costs": _layout("float64", "num_motions", "0..1, from one motion on"),
        "cuts": _layout("float64", "num_motions", "from one motion on"),
    },
    "segmentation": {"labels": _layout("uint16", "frame y x", "0 static, else the moving object's identity")},
}


def check_arrays(task: str, arrays: dict[str, np.ndarray]) -> dict[str, tuple[str, ...]]:
    """Axis names of each of a task's arrays; raises StoreError where name, dtype or rank is not the layout's."""
    layouts = LAYOUTS.get(task, {})
    if set(arrays) != set(layouts):
        raise StoreError("wrong set of arrays", where=task, got=sorted(arrays), expected=sorted(layouts))
    for name, array in arrays.items():
        layout = layouts[name]
        if array.dtype != np.dtype(layout.dtype) or array.ndim != len(layout.dims):
            raise StoreError(
                "wrong array layout",
                where=f"{task}.{name}",
                got=f"{array.dtype} with {array.ndim} axes",
                expected=f"{layout.dtype} {layout.dims}",
            )
    return {name: layouts[name].dims for name in arrays}
