"""The page about Python names what there is, and nothing else."""

import inspect
import re
from dataclasses import fields
from pathlib import Path
from typing import get_args

import pytest

import moseg

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "python.md").read_text(encoding="utf-8")


CALLS = ("segment_video", "evaluate", "score")


def _public(kind: type) -> set[str]:
    names = {*vars(kind), *(field.name for field in fields(kind))}
    return {name for name in names if not name.startswith("_")}


@pytest.mark.parametrize("name", CALLS)
def test_a_call_is_shown_with_all_its_arguments_and_defaults(name):
    shown = re.search(rf"moseg\.{name}\(\n(.*?)\n    \)", PAGE, re.DOTALL).group(1)
    arguments = dict(re.findall(r'(\w+)(?:=("?[\w./-]+"?))?,', shown))
    parameters = inspect.signature(getattr(moseg, name)).parameters
    assert list(arguments) == list(parameters)
    for name, parameter in parameters.items():
        default = "" if parameter.default is parameter.empty else str(parameter.default)
        assert arguments[name].strip('"') == default


def test_every_argument_and_attribute_is_explained():
    explained = set(re.findall(r"`(\w+)", PAGE))
    for name in CALLS:
        assert set(inspect.signature(getattr(moseg, name)).parameters) <= explained
    assert _public(moseg.MotionSegmentation) <= explained
    assert _public(moseg.MovingObject) <= explained


def test_an_ablation_takes_what_an_evaluation_takes_but_variants():
    ablation, evaluation = (dict(inspect.signature(call).parameters) for call in (moseg.ablate, moseg.evaluate))
    del evaluation["variants"]
    assert list(ablation.items()) == list(evaluation.items())


def test_everything_that_a_report_has_is_explained():
    for kind in (moseg.EvaluationReport, moseg.StillReport, moseg.TrajectoryReport):
        row = get_args(kind.model_fields["rows"].annotation)[0]
        scores = (row.model_fields["mean"].annotation, get_args(row.model_fields["sequences"].annotation)[1])
        named = {name for model in (kind, row, *scores) for name in model.model_fields}
        assert named - {"seeds", "spread"} <= set(re.findall(r"`(\w+)", PAGE))


def test_what_is_named_is_there():
    for name in re.findall(r"moseg\.(\w+)", PAGE):
        assert name in moseg.__all__
