"""The folder of weights: all items, which of their files are here, and how the others are fetched."""

from collections.abc import Collection, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from moseg.schemas.errors import InputError
from moseg.schemas.recipes import Recipe
from moseg.schemas.spelling import unknown_name
from moseg.schemas.weights import WeightsItem
from moseg.workflows.weights.catalogue import CATALOGUE
from moseg.workflows.weights.fetch_command import fetch_command
from moseg.workflows.weights.fetching import fetch_again, fetch_item
from moseg.workflows.weights.hub import TOKEN_VARIABLE
from moseg.workflows.weights.item_folder import ItemFolder, Verdict
from moseg.workflows.weights.own_items import OWN_ITEMS, read_own_items, weights_folder

if TYPE_CHECKING:
    from moseg.tasks.networks import Checkpoint

OFFLINE_VARIABLE, NON_COMMERCIAL_VARIABLE = "MOSEG_OFFLINE", "MOSEG_NON_COMMERCIAL"
LICENCE_VARIABLE = "MOSEG_ACCEPT_LICENCE"
_NO = ("", "0", "false", "no", "off")


def open_weights(
    env: Mapping[str, str],
    offline: bool = False,
    allow_non_commercial: bool = False,
    quiet: bool = False,
    accept_licence: str | None = None,
    check_licences: bool = True,
) -> "Weights":
    """Open the folder that the environment names, with the catalogue's items and the user's own.

    ``MOSEG_OFFLINE`` and ``MOSEG_NON_COMMERCIAL`` set `offline` and `allow_non_commercial` too, and
    ``MOSEG_ACCEPT_LICENCE`` names further licences.

    Parameters
    ----------
    accept_licence : str, optional
        Names of accepted licences that have conditions, separated by commas.
    check_licences : bool
        Whether licences have to be accepted; not where weights are only listed, or were checked before.
    """
    named = ",".join([accept_licence or "", env.get(LICENCE_VARIABLE, "")]).split(",")
    return Weights(
        weights_folder(env),
        offline=offline or env.get(OFFLINE_VARIABLE, "").lower() not in _NO,
        allow_non_commercial=allow_non_commercial or env.get(NON_COMMERCIAL_VARIABLE, "").lower() not in _NO,
        token=env.get(TOKEN_VARIABLE, "").strip() or None,
        quiet=quiet,
        accepted={name.strip().lower() for name in named} if check_licences else None,
    )


class Weights:
    """Weights items, each in a folder of its name.

    Attributes
    ----------
    folder : Path
        The folder of all items' folders.
    """

    def __init__(
        self,
        folder: Path,
        items: Mapping[str, WeightsItem] | None = None,
        offline: bool = False,
        allow_non_commercial: bool = False,
        token: str | None = None,
        quiet: bool = False,
        accepted: Collection[str] | None = (),
    ):
        self.folder = folder
        self._items = items
        self._offline = offline
        self._allow_non_commercial = allow_non_commercial
        self._token = token
        self._quiet = quiet
        self._accepted = accepted

    @cached_property
    def items(self) -> Mapping[str, WeightsItem]:
        """Return items by name: those that were given, else the catalogue's and the user's.

        They are read on first use: a run without networks does not fail on an unreadable ``weights.json``.

        Raises
        ------
        InputError
            The user's ``weights.json`` cannot be read.
        """
        if self._items is not None:
            return self._items
        return {item.name: item for item in (*CATALOGUE, *read_own_items(self.folder))}

    def item(self, name: str) -> WeightsItem:
        """Return the item of a name; raise InputError if there is none."""
        if name not in self.items:
            expected = f"one that `moseg backends` lists, or that {OWN_ITEMS} describes"
            raise unknown_name("weights item", name, self.items, where=self.folder, expected=expected)
        return self.items[name]

    def is_present(self, item: WeightsItem) -> bool:
        """Return whether all files of an item are here, without reading them."""
        return not self._open(item).missing()

    def size(self, item: WeightsItem) -> int | None:
        """Return the bytes of an item's files: on disk if all are here, else as far as known beforehand."""
        return self._open(item).num_bytes() if self.is_present(item) else item.size

    def ensure(self, item: WeightsItem) -> None:
        """Fetch the missing files of an item.

        Raises
        ------
        MissingInputError
            A file is missing, and it has no address or no network may be used; the message names the command that
            fetches it.
        InputError
            The licence was not accepted, a file has a wrong size, or the download failed.
        """
        self.check_licence(item)
        files = self._open(item)
        files.check_sizes()
        for file in (missing := files.missing()):
            if file.url is None or self._offline:
                raise files.absence(file)
        if missing:
            fetch_item(files, self._token, self._quiet)

    def digests(self, item: WeightsItem) -> dict[str, str]:
        """Return the SHA-256 of every file by its name; of its bytes if it is not known beforehand.

        Such files are fetched if they are missing. Raises as `ensure` does.
        """
        self.check_licence(item)
        files = self._open(item)
        if any(files.digest(file) is None for file in item.files):
            self.ensure(item)
        return {file.name: files.digest(file) for file in item.files}

    def read(self, item: WeightsItem, digests: Mapping[str, str]) -> "Checkpoint":
        """Return what a network is built from; compare every file with `digests` before it is used.

        Raises
        ------
        MissingInputError
            A file is missing; the message names the command that fetches it.
        InputError
            A file differs from `digests`, is unreadable, or is written to meanwhile. A wrong file that can be fetched
            anew is renamed.
        """
        return self._open(item).read(digests)

    def verify(self, item: WeightsItem) -> list[Verdict]:
        """Hash every file of an item and compare it with what it must be."""
        return self._open(item).verify()

    def repair(self, item: WeightsItem, again: bool = False) -> None:
        """Fetch the missing files of an item, and replace wrong ones.

        Parameters
        ----------
        again : bool
            Whether files that only their first download fixes are fetched anew too, and recorded anew: the first
            download may have been damaged.

        Raises as `ensure` does.
        """
        self.check_licence(item)
        if again and self._offline:
            expected = f"`{fetch_command(item, again=True)}`, with a network"
            raise InputError("no network is to be used", where=f"weights {item.name}", expected=expected)
        if again:
            fetch_again(self._open(item), self._token, self._quiet)
        self._open(item).refuse_wrong()
        self.ensure(item)

    def check_licence(self, item: WeightsItem) -> None:
        """Raise InputError if the licence of an item has to be accepted and was not."""
        if self._accepted is None:
            return
        got = f"licence {item.licence}"
        if item.has_conditions and item.licence.lower() not in self._accepted:
            expected = f"{item.consent}, or {LICENCE_VARIABLE}={item.licence}, once you agree to it"
            expected += f": see {item.homepage}" if item.homepage else ""
            raise InputError("weights whose licence has conditions", where=item.name, got=got, expected=expected)
        if item.is_non_commercial and not self._allow_non_commercial:
            expected = f"--non-commercial, or {NON_COMMERCIAL_VARIABLE}=1, if your use is non-commercial"
            raise InputError("weights for non-commercial use only", where=item.name, got=got, expected=expected)

    def _open(self, item: WeightsItem) -> ItemFolder:
        return ItemFolder(item, self.folder / item.name)


class WeightsLeaf(NamedTuple):
    """The leaf of a weights item: its recipe, and attributes that name the item and the SHA-256 of each file."""

    recipe: Recipe
    attributes: dict[str, Any]


def find_item(weights: Weights, name: str, architecture: str) -> WeightsItem:
    """Return the item of a name; raise InputError if there is none, or if it is of another architecture."""
    item = weights.item(name)
    if item.architecture != architecture:
        raise InputError("weights of another network", where=name, got=item.architecture, expected=architecture)
    return item


def weights_leaf(weights: Weights, name: str, architecture: str) -> WeightsLeaf:
    """Return the leaf of a weights item: its files' digests name it, so that other weights give other results.

    Raises
    ------
    InputError
        There is no such item, it is of another architecture, or its digests are unknown and it cannot be fetched.
    """
    item = find_item(weights, name, architecture)
    params = {
        "item": item.name,
        "architecture": item.architecture,
        "config": dict(item.config),
        "files": weights.digests(item),
    }
    # Not one digest for all files: `moseg store why` then names the file that differs.
    return WeightsLeaf(Recipe(task="weights", version=1, params=params), {**params, "licence": item.licence})
