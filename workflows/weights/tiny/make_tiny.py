"""A folder of tiny random checkpoints: every network runs in a moment, with results of no use."""

from collections.abc import Iterable
from importlib import import_module
from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.schemas.weights import WeightsFile, WeightsItem, WeightsList
from moseg.workflows.process.atomic_write import atomic_path, blame_output
from moseg.workflows.weights.own_items import OWN_ITEMS, read_own_items
from moseg.workflows.weights.reading import require_network_packages
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint

TINY_LICENCE = "none: random numbers"
MODULES = {"ram_plus": "ram"}
"""Modules of architectures whose function does not lie in a module of the same name."""


def make_tiny(folder: Path, items: Iterable[WeightsItem], seed: int) -> tuple[WeightsItem, ...]:
    """Write a tiny checkpoint for each item, and ``weights.json`` that puts them in place of the catalogue's.

    Tiny checkpoints of other items that the folder holds stay.

    Parameters
    ----------
    folder : Path
        Value for ``$MOSEG_WEIGHTS``; created if there is none.
    seed : int
        Seed of the random numbers.

    Returns
    -------
    tuple of WeightsItem
        The items that were written.

    Raises
    ------
    InputError
        The folder cannot be written, or holds weights that are not tiny: the user's, or fetched ones; or the libraries
        that networks run on are not installed.
    """
    require_network_packages()
    items = tuple(items)
    described = {item.name: item for item in _tiny_items(folder)}
    _refuse_weights(folder, [item.name for item in items if item.name not in described])
    made: dict[str, TinyCheckpoint] = {}
    written = []
    for item in items:
        if item.architecture not in made:
            made[item.architecture] = _make(item.architecture, seed)
        tiny = made[item.architecture]
        for name, content in tiny.files.items():
            _write(folder / item.name / name, content)
        described[item.name] = WeightsItem(
            name=item.name,
            architecture=item.architecture,
            licence=TINY_LICENCE,
            files=tuple(WeightsFile(name=name) for name in tiny.files),
            config=tiny.config,
        )
        written.append(described[item.name])
    content = WeightsList(items=tuple(described.values()))
    # Last, so that all files that it names exist.
    _write(folder / OWN_ITEMS, (content.model_dump_json(indent=2, exclude_defaults=True) + "\n").encode("utf-8"))
    return tuple(written)


def _make(architecture: str, seed: int) -> TinyCheckpoint:
    module = import_module(f"moseg.workflows.weights.tiny.{MODULES.get(architecture, architecture)}")
    return getattr(module, f"make_{architecture}")(seed)


def _tiny_items(folder: Path) -> list[WeightsItem]:
    """Return the tiny checkpoints in the folder; raise InputError if it also holds the user's own weights."""
    items = list(read_own_items(folder))
    own = [item.name for item in items if item.licence != TINY_LICENCE]
    if own:
        raise _refusal(folder, f"items of your own: {', '.join(own)}")
    return items


def _refuse_weights(folder: Path, names: Iterable[str]) -> None:
    """Raise InputError if folders of these names are not empty: their weights may not be tiny."""
    with blame_output(folder):
        held = [name for name in names if (folder / name).is_dir() and any((folder / name).iterdir())]
    if held:
        raise _refusal(folder, f"existing weights: {', '.join(held)}")


def _refusal(folder: Path, got: str) -> InputError:
    what = "tiny checkpoints would take the place of weights"
    return InputError(what, where=folder, got=got, expected="another folder")


def _write(path: Path, content: bytes) -> None:
    with atomic_path(path) as temporary, blame_output(path):
        temporary.write_bytes(content)
