"""Every parameter says what it means, in which unit and within which bounds."""

import re
from pathlib import Path

import pytest
from pydantic import BaseModel

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.schemas.units import Unit
from moseg.workflows.config.parameters import list_parameters, list_stages, value_of
from moseg.workflows.config.pipeline_choices import PARAMETER_OF, Choice, PipelineChoices

NUMBER = re.compile(r"\b(int|float)\b|Positive(Int|Float)")


def _leaves(model, path=()):
    for name, field in model.model_fields.items():
        kind = field.annotation
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            yield from _leaves(kind, (*path, name))
        else:
            yield ".".join((*path, name)), field


LEAVES = dict(_leaves(PipelineConfig))


def test_the_list_has_every_parameter_with_its_default():
    parameters = list_parameters()
    assert list(parameters) == list(LEAVES)
    assert len(parameters) > 200
    config = PipelineConfig()
    for name, parameter in parameters.items():
        assert value_of(config, parameter) == parameter.default
        if not name.startswith("track_groups.clustering."):
            # That stage has its own defaults for the clustering within it.
            assert parameter.default == LEAVES[name].default


@pytest.mark.parametrize("name", LEAVES)
def test_a_parameter_is_described_and_a_number_has_its_unit_and_bounds(name):
    field, parameter = LEAVES[name], list_parameters()[name]
    assert len(parameter.description) >= 6
    assert parameter.values
    kind = str(field.annotation)
    is_number = "Literal" not in kind.partition("Union")[0] and NUMBER.search(kind) is not None
    if not is_number:
        assert parameter.unit is None or name == "clustering.motions"
        return
    assert isinstance(parameter.unit, Unit)
    bounded = [each for each in field.metadata for sign in ("ge", "gt", "le", "lt") if hasattr(each, sign)]
    assert bounded or re.search(r"[<>]=? ?\d", parameter.values), f"{name} takes any number"


def test_every_stage_says_what_it_is_about():
    assert all(text.endswith(".") for text in list_stages().values())
    assert {name.partition(".")[0] for name in list_parameters() if "." in name} <= set(list_stages())


def test_ranges_are_written_for_people():
    values = {name: parameter.values for name, parameter in list_parameters().items()}
    assert values["fundamental.gap"] == ">= 1"
    assert values["clustering.threshold"] == "> 0 and < 1"
    assert values["kernel.window"] == "> 0 and <= 1"
    assert values["affinity.quantile"] == "0 to 1"
    assert values["affinity.excess"] == "true or false"
    assert values["flow.method"] == "dis, raft, sea-raft, groundtruth, folder"
    assert values["clustering.motions"] == "gt, auto or >= 1"
    assert values["saliency.focals"] == "list of > 0"
    assert values["detections.tags"] == "list of text or null"


def test_the_document_is_what_the_command_writes(moseg):
    written = (Path(__file__).resolve().parents[3] / "docs" / "parameters.md").read_text(encoding="utf-8")
    assert moseg("config", "show", "--markdown").out == written, "moseg config show --markdown > docs/parameters.md"


def test_show_names_all_of_a_stage(moseg):
    ran = moseg("config", "show", "clustering.count")
    assert (ran.code, ran.err) == (0, "")
    for word in ("most_motions", "1 to 19", "px", "Sampson distance of an inlier", "clustering.count.affinity", "fade"):
        assert word in ran.out
    assert "co_regularisation" not in ran.out
    assert "1280" in moseg("config", "show", "max_side").out
    assert moseg("config", "show").out.count("\n") > len(LEAVES)


@pytest.mark.parametrize(
    ("name", "meant"), [("flwo", "flow"), ("fundamental.gab", "fundamental.gap"), ("ork_threshold", "affinity.ork")]
)
def test_show_knows_what_was_meant(moseg, name, meant):
    ran = moseg("config", "show", name)
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert "did you mean" in line
    assert meant in line


@pytest.mark.parametrize("text", ["[dog,cat", "dog,cat]", "[a],[b]", "['a, b', c]", "'dog,cat"])
def test_a_list_with_a_bracket_or_a_quote_too_few_is_refused(text):
    with pytest.raises(InputError, match=r"detections.tags; got .*; expected values separated by commas"):
        PipelineChoices(settings=(("detections.tags", text),)).make_config()


@pytest.mark.parametrize(
    ("option", "value", "text", "is_refused"),
    [
        ("--sensitivity", 1.0, "1", False),
        ("--sensitivity", 1.0, "1.5", True),
        ("--tags", "dog, cat", "[dog,cat]", False),
        ("--tags", "dog", "cat", True),
        ("--section-length", 20, "20.0", False),
    ],
)
def test_an_option_and_a_setting_may_give_the_same_value(option, value, text, is_refused):
    name = PARAMETER_OF[option]
    choices = PipelineChoices(chosen=(Choice(option, name, value),), settings=((name, text),))
    if is_refused:
        with pytest.raises(InputError, match=f"two choices in {option}; got --set {name}={text} too"):
            choices.make_config()
    else:
        alone = PipelineChoices(settings=((name, text),))
        assert choices.make_config() == alone.make_config()


LISTS = {name: each.default for name, each in list_parameters().items() if isinstance(each.default, tuple)}


@pytest.mark.parametrize("form", ["{}", "[{}]", "[ {},]"])
@pytest.mark.parametrize("name", LISTS)
def test_a_list_is_set_with_brackets_or_without(name, form):
    values = LISTS[name] or ("one name", "two")
    text = form.format(", ".join(map(str, values)))
    config = PipelineChoices(settings=((name, text),)).make_config()
    assert value_of(config, list_parameters()[name]) == values
