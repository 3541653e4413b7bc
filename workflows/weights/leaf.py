"""Weights as leaves of the graph: named by the digests of their files, so that other weights are other results."""

from typing import Any, NamedTuple

from moseg.schemas.errors import InputError
from moseg.schemas.recipes import Recipe
from moseg.workflows.weights.folder import Weights


class WeightsLeaf(NamedTuple):
    """The leaf of a weights item: its recipe, and attributes that name the item and the SHA-256 of each file."""

    recipe: Recipe
    attributes: dict[str, Any]


def weights_leaf(weights: Weights, name: str, architecture: str) -> WeightsLeaf:
    """The leaf of a weights item.

    Raises
    ------
    InputError
        There is no such item, it is of another architecture, or its digests are not known and cannot be had.
    """
    item = weights.item(name)
    if item.architecture != architecture:
        raise InputError("weights of another network", where=name, got=item.architecture, expected=architecture)
    params = {
        "item": item.name,
        "architecture": item.architecture,
        "config": dict(item.config),
        "files": weights.digests(item),
    }
    # Not one digest of it all: `moseg store why` then names the file that differs.
    return WeightsLeaf(Recipe(task="weights", version=1, params=params), {**params, "licence": item.licence})
