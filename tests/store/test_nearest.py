"""Explanation of a miss."""

import pytest

from moseg.schemas.recipes import Recipe
from moseg.store import FieldDifference, nearest

FRAMES = [f"frame/{digit * 64}" for digit in "0123"]


def recipe(version=1, inputs=(0, 1), **params) -> Recipe:
    return Recipe(
        task="flow",
        version=version,
        params={"preset": "medium", "levels": [1, 2]} | params,
        inputs={"frames": [FRAMES[index] for index in inputs]},
    )


@pytest.fixture
def stored(store):
    for each in (recipe(), recipe(inputs=(2, 3)), recipe(version=2, preset="fast"), recipe(levels=[1, 3])):
        store.put(each, {}, dims={})
    store.put(Recipe(task="depth", version=1), {}, dims={})
    return store


def test_the_recipe_that_differs_in_fewest_fields_is_nearest(stored):
    found = nearest(stored, recipe(preset="ultrafast"))
    assert found.ref == recipe().ref
    assert found.differences == (FieldDifference("params.preset", "medium", "ultrafast"),)


def test_version_parameters_and_inputs_are_named(stored):
    assert [each.field for each in nearest(stored, recipe(version=3)).differences] == ["version"]
    (difference,) = nearest(stored, recipe(inputs=(0, 2))).differences
    assert difference == FieldDifference("inputs.frames[1]", FRAMES[1], FRAMES[2])
    assert nearest(stored, recipe(levels=[1, 2, 9])).differences == (
        FieldDifference("params.levels[2]", "(absent)", 9),
    )


def test_a_stored_recipe_has_no_differences(stored):
    assert nearest(stored, recipe()).differences == ()


def test_numbers_differ_if_their_digests_do(stored):
    (difference,) = nearest(stored, recipe(levels=[1, 3.0])).differences
    assert difference == FieldDifference("params.levels[1]", 3, 3.0)


def test_of_equally_near_recipes_the_youngest_is_taken(store):
    for preset in ("a", "b", "c"):
        store.put(recipe(preset=preset), {}, dims={})
    assert nearest(store, recipe()).differences[0].stored == "c"


def test_a_task_never_stored_has_none(stored):
    assert nearest(stored, Recipe(task="tracks", version=1)) is None


def test_damaged_artifacts_are_skipped(stored):
    key = recipe().key
    (stored.root / "objects/flow" / key[:2] / key / "manifest.json").unlink()
    assert nearest(stored, recipe()).ref != recipe().ref
