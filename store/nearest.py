"""Explanation of a miss: the nearest stored recipe, and the fields in which it differs."""

from collections.abc import Iterable
from typing import NamedTuple

from pydantic import JsonValue

from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError
from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import Recipe
from moseg.store.ahead import map_reads
from moseg.store.protocol import ArtifactStore

ABSENT = "(absent)"
"""Stands for the value of a field that one of two recipes lacks."""
CONTENT = "params.content"
"""The field in which leaves differ: frames, masks and maps from outside."""


class FieldDifference(NamedTuple):
    """A field of the recipe (``version``, ``params.threshold``, ``inputs.flow[3]``) and its two values."""

    field: str
    stored: JsonValue
    wanted: JsonValue


class NearestRecipe(NamedTuple):
    """A stored artifact of the same task and the fields in which its recipe differs; none if it is equal."""

    ref: str
    differences: tuple[FieldDifference, ...]


def nearest(store: ArtifactStore, recipe: Recipe, besides: str | None = None) -> NearestRecipe | None:
    """Return the stored artifact of the recipe's task, other than `besides`, whose origins differ least.

    Differences are counted where they originate: in parameters, versions and leaves, of the recipes themselves and of
    all their ancestors. So the same section of an earlier run is nearer than another section of the same run. Ties are
    resolved by the fewest differences in content, then by the fewest differences of the recipe itself, then by the
    latest time, so that the answer is about the last run.

    Returns None if the task has no other artifact. Damaged artifacts are skipped.
    """
    best: tuple[tuple[int, int, int], str, NearestRecipe] | None = None
    recipes: dict[str, Recipe | None] = {}
    refs = (ref for ref in store.refs(recipe.task) if ref != besides)
    for ref, manifest in map_reads(store, lambda ref: (ref, _manifest(store, ref)), refs):
        if manifest is None:
            continue
        found = NearestRecipe(ref, differences(manifest.recipe, recipe))
        origins = _find_origins(store, recipes, found.differences, None if best is None else best[0][0])
        num_contents = sum(difference.field == CONTENT for difference in origins)
        distance = (len(origins), num_contents, len(found.differences))
        if best is None or distance < best[0] or (distance == best[0] and manifest.created > best[1]):
            best = (distance, manifest.created, found)
    return None if best is None else best[2]


def _find_origins(
    store: ArtifactStore, recipes: dict[str, Recipe | None], found: Iterable[FieldDifference], limit: int | None
) -> set[FieldDifference]:
    """Return the differences from which others follow; the search stops beyond `limit`."""
    origins: set[FieldDifference] = set()
    followed: set[tuple[str, str]] = set()
    waiting = list(found)
    while waiting and (limit is None or len(origins) <= limit):
        difference = waiting.pop()
        pair = (difference.stored, difference.wanted)
        if pair in followed:
            continue
        if difference.field.startswith("inputs") and ABSENT not in pair:
            followed.add(pair)
            stored, wanted = (_recipe(store, recipes, ref) for ref in pair)
            if stored is not None and wanted is not None:
                waiting.extend(differences(stored, wanted))
                continue
        origins.add(difference)
    return origins


def _recipe(store: ArtifactStore, recipes: dict[str, Recipe | None], ref: str) -> Recipe | None:
    """Return the recipe of an artifact, looked up once; None if it is missing or damaged."""
    if ref not in recipes:
        manifest = _manifest(store, ref)
        recipes[ref] = None if manifest is None else manifest.recipe
    return recipes[ref]


def _manifest(store: ArtifactStore, ref: str) -> Manifest | None:
    try:
        return store.manifest(ref)
    except (CorruptArtifactError, MissingArtifactError):
        return None


def differences(stored: Recipe, wanted: Recipe) -> tuple[FieldDifference, ...]:
    """Return the fields in which two recipes of one task differ, in order of name."""
    old, new = _fields(stored), _fields(wanted)
    return tuple(
        FieldDifference(field, old.get(field, ABSENT), new.get(field, ABSENT))
        for field in sorted(old.keys() | new.keys())
        if field not in old or field not in new or not _is_same(old[field], new[field])
    )


def _fields(recipe: Recipe) -> dict[str, JsonValue]:
    fields: dict[str, JsonValue] = {"version": recipe.version}
    _flatten(fields, "params", recipe.params)
    _flatten(fields, "inputs", recipe.inputs)
    return fields


def _flatten(fields: dict[str, JsonValue], name: str, value: JsonValue) -> None:
    if isinstance(value, dict):
        for key, item in value.items():
            _flatten(fields, f"{name}.{key}", item)
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            _flatten(fields, f"{name}[{index}]", item)
    else:
        fields[name] = value


def _is_same(old: JsonValue, new: JsonValue) -> bool:
    """Return whether two values have the same digest in a recipe: 1, 1.0 and true are three values."""
    return type(old) is type(new) and old == new
