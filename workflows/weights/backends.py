"""Every method of every stage: the option that chooses it, whose code it is, and the weights that it can take."""

from typing import NamedTuple

from moseg.schemas.weights import Architecture, WeightsFile, WeightsItem
from moseg.workflows.weights.fetch_command import fetch_command
from moseg.workflows.weights.folder import Weights
from moseg.workflows.weights.hub import parse_hub_url

OWN = "this project, MIT"
OPENCV = "OpenCV, Apache-2.0"
TRANSFORMERS = "transformers, Apache-2.0"


class Backend(NamedTuple):
    """One way to do one stage.

    Attributes
    ----------
    stage, method : str
        The method is the value of the parameter that chooses it.
    what : str
        In words.
    option : str
        Chooses it on the command line.
    code : str
        Whose code computes it, and its licence.
    architecture : str or None
        Of the weights that it takes; None where it takes none.
    weights : str
        The parameter that names its weights, and the item that it names if nothing else is said.
    """

    stage: str
    method: str
    what: str
    option: str
    code: str = OWN
    architecture: Architecture | None = None
    weights: tuple[str, str] = ("", "")


BACKENDS: tuple[Backend, ...] = (
    Backend("flow", "dis", "DIS, both directions", "--flow dis", OPENCV),
    Backend("flow", "raft", "RAFT", "--flow raft", OWN, "raft", ("raft.weights", "raft-large")),
    Backend("flow", "groundtruth", "exact (synthetic)", "--flow groundtruth"),
    Backend("flow", "folder", "your own flow", "--flow folder:PATH"),
    Backend("proposals", "saliency", "motion saliency", "--proposals saliency"),
    Backend("proposals", "detections", "named, found, outlined and tracked objects", "--proposals detections"),
    Backend("proposals", "groundtruth", "annotated objects (an oracle)", "--proposals groundtruth"),
    Backend("proposals", "folder", "your own masks", "--proposals folder:PATH"),
    Backend("tagger", "ram", "RAM", "--tagger ram", OWN, "ram", ("ram.weights", "ram")),
    Backend("tagger", "ram-plus", "RAM++", "--tagger ram-plus", OWN, "ram_plus", ("ram.weights", "ram-plus")),
    Backend("tagger", "given", "your own tags", "--tags car,person"),
    Backend(
        "detector",
        "grounding-dino",
        "Grounding DINO",
        "--proposals detections",
        TRANSFORMERS,
        "grounding_dino",
        ("grounding_dino.weights", "grounding-dino-tiny"),
    ),
    Backend(
        "masks", "sam-hq", "SAM-HQ", "--masks sam-hq", TRANSFORMERS, "sam_hq", ("sam_hq.weights", "sam-hq-vit-large")
    ),
    Backend("masks", "sam2", "SAM 2.1", "--masks sam2", TRANSFORMERS, "sam2", ("sam2.weights", "sam2.1-hiera-large")),
    Backend("tracker", "deaot", "DeAOT", "--tracker deaot", OWN, "deaot", ("deaot.weights", "deaot-r50-l")),
    Backend(
        "tracker",
        "sam2",
        "SAM 2.1 video",
        "--tracker sam2",
        TRANSFORMERS,
        "sam2",
        ("sam2.weights", "sam2.1-hiera-large"),
    ),
    Backend("tracks", "lucas-kanade", "pyramidal Lucas-Kanade", "--tracks lucas-kanade", OPENCV),
    Backend("tracks", "pips", "PIPs", "--tracks pips", OWN, "pips", ("pips.weights", "pips")),
    Backend("tracks", "groundtruth", "exact (synthetic)", "--tracks groundtruth"),
    Backend("tracks", "folder", "your own tracks", "--tracks folder:PATH"),
    Backend("depth", "none", "none", "--depth none"),
    Backend(
        "depth",
        "dpt-dinov2",
        "DINOv2 with DPT",
        "--depth dpt-dinov2",
        TRANSFORMERS,
        "dpt_dinov2",
        ("dpt_dinov2.weights", "dpt-dinov2-large-nyu"),
    ),
    Backend(
        "depth",
        "depth-anything-v2",
        "Depth Anything V2",
        "--depth depth-anything-v2",
        TRANSFORMERS,
        "depth_anything",
        ("depth_anything_v2.weights", "depth-anything-v2-small"),
    ),
    Backend("depth", "groundtruth", "exact (synthetic)", "--depth groundtruth"),
    Backend("depth", "folder", "your own maps", "--depth folder:PATH"),
)


class WeightsRow(NamedTuple):
    """One weights item, and what of it is here.

    Attributes
    ----------
    item : WeightsItem
    parameters : tuple of str
        Those that can name it, for ``--set``.
    is_present : bool
    size : int or None
        Bytes, on disk where it is here.
    pin : str
        What fixes its bytes; see `describe_pin`.
    command : str
        Gets it; empty where it is here or lies at no address.
    """

    item: WeightsItem
    parameters: tuple[str, ...]
    is_present: bool
    size: int | None
    pin: str
    command: str


def weights_rows(weights: Weights) -> list[WeightsRow]:
    """Every item, the catalogue's and the user's."""
    rows = []
    for item in weights.items.values():
        takers = [backend for backend in BACKENDS if backend.architecture == item.architecture]
        is_present = weights.is_present(item)
        can_be_fetched = any(file.url is not None for file in item.files)
        command = fetch_command(item) if can_be_fetched and not is_present else ""
        parameters = tuple(dict.fromkeys(backend.weights[0] for backend in takers))
        rows.append(WeightsRow(item, parameters, is_present, weights.size(item), describe_pin(item), command))
    return rows


def describe_pin(item: WeightsItem) -> str:
    """What fixes the bytes of an item's files, the weakest of them: their SHA-256, a commit of the hub, or only time.

    ``SHA-256, revision`` are items whose tensors have a known digest while small files beside them have a commit.
    """
    kinds = {_pin_kind(file) for file in item.files}
    for kind in ("your file", "first download"):
        if kind in kinds:
            return kind
    return ", ".join(sorted(kinds, reverse=True))


def _pin_kind(file: WeightsFile) -> str:
    if file.sha256 is not None:
        return "SHA-256"
    if file.url is None:
        return "your file"
    hub = parse_hub_url(file.url)
    return "revision" if hub is not None and hub.is_pinned else "first download"
