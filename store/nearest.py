"""Explaining a miss: which stored recipe comes nearest, and in what it differs."""

from typing import NamedTuple

from pydantic import JsonValue

from schemas.errors import CorruptArtifactError, MissingArtifactError
from schemas.recipes import Recipe
from store.protocol import ArtifactStore

ABSENT = "(absent)"
"""Stands for the value of a field that one of two recipes lacks."""


class FieldDifference(NamedTuple):
    """A field of the recipe (``version``, ``params.threshold``, ``inputs.flow[3]``) and its two values."""

    field: str
    stored: JsonValue
    wanted: JsonValue


class NearestRecipe(NamedTuple):
    """A stored artifact of the same task and the fields in which its recipe differs; none where it is the same."""

    ref: str
    differences: tuple[FieldDifference, ...]


def nearest(store: ArtifactStore, recipe: Recipe, besides: str | None = None) -> NearestRecipe | None:
    """The stored artifact of the recipe's task, `besides` one reference, that differs from it in the fewest fields.

    Returns None where the task has no other artifact. Of equally near ones the youngest is taken, so that the answer
    speaks of the last run. Damaged artifacts are passed over.
    """
    best: tuple[int, str, NearestRecipe] | None = None
    for ref in store.refs(recipe.task):
        if ref == besides:
            continue
        try:
            manifest = store.manifest(ref)
        except (CorruptArtifactError, MissingArtifactError):
            continue
        found = NearestRecipe(ref, differences(manifest.recipe, recipe))
        if (
            best is None
            or len(found.differences) < best[0]
            or (len(found.differences) == best[0] and manifest.created > best[1])
        ):
            best = (len(found.differences), manifest.created, found)
    return None if best is None else best[2]


def differences(stored: Recipe, wanted: Recipe) -> tuple[FieldDifference, ...]:
    """The fields in which two recipes of one task differ, in order of name."""
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
    """Equality as the recipe's digest sees it: 1, 1.0 and true are three values."""
    return type(old) is type(new) and old == new
