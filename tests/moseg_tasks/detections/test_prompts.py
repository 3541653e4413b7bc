import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.tasks.networks.grounding_dino import compose_prompts

TAGS = ["a dog", "Tennis Ball", "person"]


def words_of(tokenizer, prompt):
    """The text without its ends and the marks between its names."""
    return " ".join(tokenizer.decode(prompt.token_ids[1:-1]).translate(str.maketrans(",.", "  ")).split())


@pytest.mark.parametrize(
    ("separator", "text"), [("comma", "a dog, tennis ball, person."), ("stop", "a dog. tennis ball. person.")]
)
def test_a_prompt_is_the_caption_of_the_authors(detector, separator, text):
    (prompt,) = compose_prompts(detector.tokenizer, TAGS, 40, 256, separator)
    assert prompt.token_ids == detector.tokenizer(text)["input_ids"]


def test_the_words_of_a_prompt_are_those_of_its_names(detector):
    (prompt,) = compose_prompts(detector.tokenizer, TAGS, 40, 256)
    assert prompt.tags == ["a dog", "tennis ball", "person"]
    assert words_of(detector.tokenizer, prompt) == "a dog tennis ball person"


def test_a_name_is_looked_for_once_whatever_its_case_and_spaces(detector):
    (prompt,) = compose_prompts(detector.tokenizer, ["Dog", " dog", "a  dog", "dog"], 40, 256)
    assert prompt.tags == ["dog", "a dog"]


@given(st.lists(st.sampled_from("abcdefghij"), unique=True), st.integers(1, 12), st.integers(6, 20))
def test_no_prompt_exceeds_a_limit_and_no_name_is_lost(detector, letters, tags_per_prompt, max_tokens):
    names = [letter * 3 for letter in letters]
    prompts = compose_prompts(detector.tokenizer, names, tags_per_prompt, max_tokens)
    assert [name for prompt in prompts for name in prompt.tags] == names
    assert all(len(prompt.tags) <= tags_per_prompt and len(prompt.token_ids) <= max_tokens for prompt in prompts)
    assert [words_of(detector.tokenizer, prompt) for prompt in prompts] == [" ".join(prompt.tags) for prompt in prompts]


def test_names_are_spread_evenly(detector):
    prompts = compose_prompts(detector.tokenizer, list("abcdefghij"), 4, 256)
    assert [len(prompt.tags) for prompt in prompts] == [4, 4, 2]
    prompts = compose_prompts(detector.tokenizer, list("abcdefghij"), 9, 256)
    assert [len(prompt.tags) for prompt in prompts] == [5, 5]


def test_a_full_stop_does_not_end_a_name(detector):
    (prompt,) = compose_prompts(detector.tokenizer, ["st. bernard?", "dog"], 40, 256)
    assert words_of(detector.tokenizer, prompt) == "st bernard dog"


@pytest.mark.parametrize("tag", ["", " ", "?", "...", "x " * 300, "犬", "dog \N{DOG FACE}"])
def test_a_name_without_known_words_or_with_too_many_is_refused(detector, tag):
    with pytest.raises(InputError, match="no known words, or too many in tags"):
        compose_prompts(detector.tokenizer, ["dog", tag], 40, 256)


def test_the_tiny_vocabulary_covers_every_english_name(detector):
    compose_prompts(detector.tokenizer, ["t-shirt", "Café", "rubik's cube", "b&b", "7 up", "a/c (unit)"], 40, 256)


def test_without_names_there_are_no_prompts(detector):
    assert compose_prompts(detector.tokenizer, [], 40, 256) == []
