"""Weights as leaves of the graph: named by the digests of their files, so that other weights are other results."""

from typing import Any, NamedTuple

from schemas.digests import digest_json
from schemas.errors import InputError
from schemas.recipes import Recipe, leaf_recipe
from workflows.weights.folder import Weights


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
    attributes = {
        "item": item.name,
        "architecture": item.architecture,
        "config": dict(item.config),
        "files": weights.digests(item),
    }
    recipe = leaf_recipe("weights", digest_json("weights", attributes))
    return WeightsLeaf(recipe, {**attributes, "licence": item.licence})
