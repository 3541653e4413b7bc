"""Which weights a configuration's networks read."""

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.presets import PRESETS

ARCHITECTURES = {
    "raft": "raft",
    "pips": "pips",
    "deaot": "deaot",
    "sam2": "sam2",
    "sam-hq": "sam_hq",
    "grounding-dino": "grounding_dino",
    "dpt-dinov2": "dpt_dinov2",
    "depth-anything-v2": "depth_anything",
    "ram": "ram",
    "ram-plus": "ram_plus",
}
"""The architecture whose weights each method reads."""


def needed_items(config: PipelineConfig) -> dict[str, str]:
    """Weights items by name, each with the architecture it must have, in the order in which a run uses them.

    Raises
    ------
    InputError
        One item is named for two networks.
    """
    items: dict[str, str] = {}
    for method in networks(config):
        item = tagger_item(config) if method.startswith("ram") else getattr(config, method.replace("-", "_")).weights
        architecture = items.setdefault(item, ARCHITECTURES[method])
        if architecture != ARCHITECTURES[method]:
            got, expected = f"{architecture} and {ARCHITECTURES[method]}", "an item for each"
            raise InputError("weights named for two networks", where=item, got=got, expected=expected)
    return items


def networks(config: PipelineConfig) -> list[str]:
    """Methods of a configuration that run a network."""
    chosen = [config.flow.method, config.depth.method, config.tracks.method]
    if config.proposal_source == "detections":
        detections = config.detections
        tagger = [detections.tagger] if detections.tags is None else []
        chosen = [*tagger, "grounding-dino", detections.masks, detections.tracker, *chosen]
    return [method for method in dict.fromkeys(chosen) if method in ARCHITECTURES]


def tagger_item(config: PipelineConfig) -> str:
    """The tagger's weights: the item of its own name unless another one is named."""
    return config.ram.weights or config.detections.tagger


def items_of_preset(name: str) -> tuple[str, ...]:
    """Names of the weights items that a preset reads."""
    return tuple(needed_items(PipelineConfig.model_validate(PRESETS[name])))
