"""The folder of weights: every item that there is, what of it is here, and how the rest gets there."""

from collections.abc import Mapping
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
_NO = ("", "0", "false", "no", "off")


def open_weights(
    env: Mapping[str, str], offline: bool = False, allow_non_commercial: bool = False, quiet: bool = False
) -> "Weights":
    """The folder that the environment names, with the catalogue's items and the user's own.

    `offline` and `allow_non_commercial` hold too where ``MOSEG_OFFLINE`` or ``MOSEG_NON_COMMERCIAL`` is set.
    """
    return Weights(
        weights_folder(env),
        offline=offline or env.get(OFFLINE_VARIABLE, "").lower() not in _NO,
        allow_non_commercial=allow_non_commercial or env.get(NON_COMMERCIAL_VARIABLE, "").lower() not in _NO,
        token=env.get(TOKEN_VARIABLE, "").strip() or None,
        quiet=quiet,
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
    ):
        self.folder = folder
        self._items = items
        self._offline = offline
        self._allow_non_commercial = allow_non_commercial
        self._token = token
        self._quiet = quiet

    @cached_property
    def items(self) -> Mapping[str, WeightsItem]:
        """Items by name: those that were given, else the catalogue's and the user's.

        Read when first asked for: what runs no network is not stopped by a ``weights.json`` that cannot be read.

        Raises
        ------
        InputError
            The user's ``weights.json`` cannot be read.
        """
        if self._items is not None:
            return self._items
        return {item.name: item for item in (*CATALOGUE, *read_own_items(self.folder))}

    def item(self, name: str) -> WeightsItem:
        """The item of a name; raises InputError where there is none."""
        if name not in self.items:
            expected = f"one that `moseg backends` lists, or that {OWN_ITEMS} describes"
            raise unknown_name("weights item", name, self.items, where=self.folder, expected=expected)
        return self.items[name]

    def is_present(self, item: WeightsItem) -> bool:
        """Whether all files of an item are here; their bytes are not looked at."""
        return not self._open(item).missing()

    def size(self, item: WeightsItem) -> int | None:
        """Bytes of an item's files: those on disk where all are here, else as far as they are known beforehand."""
        return self._open(item).num_bytes() if self.is_present(item) else item.size

    def ensure(self, item: WeightsItem) -> None:
        """Have all files of an item here: what is missing is fetched.

        Raises
        ------
        MissingInputError
            A file is missing, and there is no address or no network is to be used; names the command that gets it.
        InputError
            The licence was not agreed to, a file has a wrong size, or the download failed.
        """
        self._check_licence(item)
        files = self._open(item)
        files.check_sizes()
        for file in (missing := files.missing()):
            if file.url is None or self._offline:
                raise files.absence(file)
        if missing:
            fetch_item(files, self._token, self._quiet)

    def digests(self, item: WeightsItem) -> dict[str, str]:
        """SHA-256 of every file by its name; from the bytes where nothing says beforehand what it must be.

        Those files are fetched where they are missing. Raises as `ensure` does.
        """
        self._check_licence(item)
        files = self._open(item)
        if any(files.digest(file) is None for file in item.files):
            self.ensure(item)
        return {file.name: files.digest(file) for file in item.files}

    def read(self, item: WeightsItem, digests: Mapping[str, str]) -> "Checkpoint":
        """What a network is built from; every file is compared with `digests` before it is used.

        Raises
        ------
        MissingInputError
            A file is missing; names the command that gets it.
        InputError
            A file is another one than `digests` say, is unreadable, or is written to meanwhile. One that is not what
            it must be and can be fetched anew is moved aside.
        """
        return self._open(item).read(digests)

    def verify(self, item: WeightsItem) -> list[Verdict]:
        """Every file of an item, hashed now, beside what it must be."""
        return self._open(item).verify()

    def repair(self, item: WeightsItem, again: bool = False) -> None:
        """Have all files of an item here and right: what is wrong is moved aside and fetched anew.

        Parameters
        ----------
        again : bool
            Whether files that only their first download vouches for are fetched anew too, and what they are then is
            recorded in place of what they were: the first download may have been a bad one.

        Raises as `ensure` does.
        """
        self._check_licence(item)
        if again and self._offline:
            expected = f"`{fetch_command(item, again=True)}`, with a network"
            raise InputError("no network is to be used", where=f"weights {item.name}", expected=expected)
        if again:
            fetch_again(self._open(item), self._token, self._quiet)
        self._open(item).refuse_wrong()
        self.ensure(item)

    def _open(self, item: WeightsItem) -> ItemFolder:
        return ItemFolder(item, self.folder / item.name)

    def _check_licence(self, item: WeightsItem) -> None:
        if item.is_non_commercial and not self._allow_non_commercial:
            got = f"licence {item.licence}"
            expected = f"--non-commercial, or {NON_COMMERCIAL_VARIABLE}=1, where your use is none"
            raise InputError("weights for non-commercial use only", where=item.name, got=got, expected=expected)


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
