"""Overview of the weights items: what each is, whether it is here, and how to get it."""

from collections.abc import Callable
from typing import NamedTuple

from moseg.schemas.weights import WeightsFile, WeightsItem
from moseg.workflows.weights.fetch_command import fetch_command
from moseg.workflows.weights.folder import Weights
from moseg.workflows.weights.hub import parse_hub_url


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


def weights_rows(weights: Weights, parameters_of: Callable[[str], tuple[str, ...]]) -> list[WeightsRow]:
    """Return a row for every item, the catalogue's and the user's.

    Parameters
    ----------
    parameters_of : function
        Returns the parameters that can name an item of an architecture.
    """
    rows = []
    for item in weights.items.values():
        is_present = weights.is_present(item)
        can_be_fetched = any(file.url is not None for file in item.files)
        command = fetch_command(item) if can_be_fetched and not is_present else ""
        rows.append(
            WeightsRow(
                item, parameters_of(item.architecture), is_present, weights.size(item), describe_pin(item), command
            )
        )
    return rows


def describe_pin(item: WeightsItem) -> str:
    """Return what fixes the bytes of an item's files, the weakest of them: their SHA-256, a commit of the hub, or time.

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
