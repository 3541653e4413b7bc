"""The page about Python names what there is, and nothing else."""

import inspect
import re
from dataclasses import fields
from pathlib import Path

import moseg

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "python.md").read_text(encoding="utf-8")


def _public(kind: type) -> set[str]:
    names = {*vars(kind), *(field.name for field in fields(kind))}
    return {name for name in names if not name.startswith("_")}


def test_the_call_is_shown_with_all_its_arguments_and_defaults():
    shown = re.search(r"moseg\.segment_video\(\n(.*?)\n    \)", PAGE, re.DOTALL).group(1)
    arguments = dict(re.findall(r'(\w+)(?:=("?[\w./-]+"?))?,', shown))
    parameters = inspect.signature(moseg.segment_video).parameters
    assert list(arguments) == list(parameters)
    for name, parameter in parameters.items():
        default = "" if parameter.default is parameter.empty else str(parameter.default)
        assert arguments[name].strip('"') == default


def test_every_argument_and_attribute_is_explained():
    explained = set(re.findall(r"`(\w+)", PAGE))
    assert set(inspect.signature(moseg.segment_video).parameters) <= explained
    assert _public(moseg.MotionSegmentation) <= explained
    assert _public(moseg.MovingObject) <= explained


def test_what_is_named_is_there():
    for name in re.findall(r"moseg\.(\w+)", PAGE):
        assert name in moseg.__all__
