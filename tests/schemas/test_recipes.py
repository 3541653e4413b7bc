"""Golden keys, and what makes two recipes one."""

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from moseg.schemas.digests import digest_json
from moseg.schemas.recipes import Recipe, leaf_recipe, split_ref

FRAMES = [f"frame/{digit * 64}" for digit in "012"]


def recipe(**changes) -> Recipe:
    fields = {
        "task": "flow",
        "version": 3,
        "params": {"preset": "medium", "levels": [1, 2.5], "on": True},
        "inputs": {"frame0": FRAMES[0], "others": FRAMES[1:]},
    }
    return Recipe(**(fields | changes))


def test_golden_keys():
    assert Recipe(task="flow", version=1).key == "9458aab1715ae3eeef4cacd8c2374526451286b3508b5e7bf0a95ab223309c36"
    assert recipe().key == "499b8c87b9d5baa9003ea5648974fb62c03aa2bd48473f042fae6227fa747faf"
    leaf = leaf_recipe("frame", "ab" * 32)
    assert leaf.ref == "frame/e48c71b0d16d4bfee30f8539451d02933c0e3775af6ccad88ed2348fe0457c3f"


def test_key_is_the_digest_of_the_sentence():
    made = recipe()
    assert made.key == digest_json("recipe", ["flow", 3, made.params, made.inputs])


@given(st.dictionaries(st.text(), st.sampled_from(FRAMES) | st.lists(st.sampled_from(FRAMES))))
def test_inputs_of_any_role_are_spelt_as_canonical_json(inputs):
    made = recipe(inputs=inputs)
    assert made.key == digest_json("recipe", ["flow", 3, made.params, inputs])


def test_the_same_sentence_about_other_inputs_has_the_key_of_one_written_anew():
    inputs = {"frame0": FRAMES[1], "others": tuple(FRAMES)}
    made = recipe().about(inputs)
    assert made == recipe(inputs=inputs)
    assert made.key == recipe(inputs=inputs).key
    assert pickle.loads(pickle.dumps(made)).ref == made.ref
    with pytest.raises(ValidationError):
        recipe().about({"frame0": "../frame"})


def test_every_field_changes_the_key():
    changed = [
        recipe(),
        recipe(task="depth"),
        recipe(version=4),
        recipe(params={"preset": "medium", "levels": [1, 2.5], "on": 1}),
        recipe(params={"preset": "medium", "levels": [2.5, 1], "on": True}),
        recipe(inputs={"frame0": FRAMES[0], "others": FRAMES[:0:-1]}),
        recipe(inputs={"frame1": FRAMES[0], "others": FRAMES[1:]}),
        recipe(inputs={"frame0": FRAMES[0]}),
    ]
    assert len({each.key for each in changed}) == len(changed)


def test_order_of_fields_does_not_change_the_key():
    other = recipe(params={"on": True, "levels": [1, 2.5], "preset": "medium"})
    assert other.key == recipe().key
    assert recipe(inputs={"others": FRAMES[1:], "frame0": FRAMES[0]}).key == recipe().key


def test_key_survives_json():
    assert Recipe.model_validate_json(recipe().model_dump_json()).key == recipe().key


def test_input_refs_are_flat_in_order_of_roles():
    assert recipe().input_refs() == tuple(FRAMES)
    assert Recipe(task="flow", version=1).input_refs() == ()


def test_ref_splits_into_task_and_key():
    assert split_ref(recipe().ref) == ("flow", recipe().key)


@pytest.mark.parametrize("task", ["", "Flow", "flow/x", "../flow", "1flow", "flow-x", "flow\n", "f" * 65])
def test_task_names_are_lower_case_words(task):
    with pytest.raises(ValidationError):
        recipe(task=task)


@pytest.mark.parametrize("ref", ["frame", "frame/0", "frame/" + "A" * 64, "frame/" + "0" * 65, "/" + "0" * 64])
def test_inputs_must_be_references(ref):
    with pytest.raises(ValidationError):
        recipe(inputs={"frame0": ref})


@pytest.mark.parametrize("params", [{"a": float("nan")}, {"a": {"b": [float("inf")]}}, {"a": {1, 2}}, {"a": b"x"}])
def test_parameters_that_cannot_be_hashed_have_no_key(params):
    with pytest.raises((TypeError, ValueError)):
        _ = recipe(params=params).key
