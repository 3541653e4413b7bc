"""Files of corrections: what is written reads back the same, one edit a line; what is wrong is one line."""

import json

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.corrections import Corrections, Drop, kind_of
from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.config.corrections_file import read_corrections, spell_corrections

NUMBERS = st.integers(1, 65535)
FRAMES = st.integers(0, 500)
COORDINATES = st.floats(-1e4, 1e4) | st.integers(-100, 4000)
POINTS = st.lists(st.tuples(COORDINATES, COORDINATES), min_size=1, max_size=4)
STROKES = st.lists(st.fixed_dictionaries({"radius": st.floats(0.1, 500), "points": POINTS}), min_size=1, max_size=3)
NAMES = st.text(st.characters(exclude_categories=["Cc", "Cs"]), min_size=1, max_size=40).filter(str.strip)
EDITS = st.one_of(
    *(st.fixed_dictionaries({kind: NUMBERS}) for kind in ("drop", "keep", "static", "moving")),
    st.fixed_dictionaries({"merge": st.lists(NUMBERS, min_size=2, max_size=4, unique=True)}),
    st.fixed_dictionaries(
        {"split": st.fixed_dictionaries({"object": NUMBERS, "frame": st.integers(1, 500)}, optional={"into": NUMBERS})}
    ),
    st.fixed_dictionaries({"rename": st.fixed_dictionaries({"object": NUMBERS, "name": NAMES})}),
    st.fixed_dictionaries({"paint": st.fixed_dictionaries({"object": NUMBERS, "frame": FRAMES, "strokes": STROKES})}),
    st.fixed_dictionaries(
        {"erase": st.fixed_dictionaries({"frame": FRAMES, "strokes": STROKES}, optional={"object": NUMBERS})}
    ),
    st.fixed_dictionaries(
        {
            "add": st.fixed_dictionaries(
                {"object": NUMBERS, "frame": FRAMES, "points": POINTS},
                optional={"not_points": POINTS, "by": st.sampled_from(["region", "sam2"])},
            )
        }
    ),
)
SETTINGS = {
    "clustering.motions": st.sampled_from(["auto", 3]),
    "clustering.threshold": st.floats(0.01, 0.99),
    "detections.tags": st.sampled_from(["no", "null", "car, person", "1e3", "~", None]),
    "affinity.excess": st.booleans(),
    "saliency.focals": st.lists(st.floats(0.1, 9), min_size=1, max_size=4),
}
CORRECTIONS = st.fixed_dictionaries(
    {"settings": st.fixed_dictionaries({}, optional=SETTINGS), "edits": st.lists(EDITS, max_size=6)},
    optional={
        "video": st.sampled_from(["0" * 64, "123", "1e5", "beef"]),
        "part": st.sampled_from(["3 frames, 2 to 4", "2 frames, a: b.png to #c.png", "null", "7"]),
    },
)


@settings(max_examples=60, deadline=None)
@given(values=CORRECTIONS)
def test_written_corrections_are_read_back_the_same(tmp_path_factory, values):
    corrections = read_corrections(values)
    path = tmp_path_factory.mktemp("corrections") / "corrections.yaml"
    text = spell_corrections(corrections)
    path.write_text(text, encoding="utf-8")
    assert read_corrections(path) == corrections
    assert spell_corrections(read_corrections(path)) == text
    # Any other reader of YAML finds the same edits.
    assert read_corrections({**yaml.safe_load(text), "version": 1}) == corrections


@settings(max_examples=30, deadline=None)
@given(values=CORRECTIONS)
def test_json_of_corrections_is_read_back_the_same(values):
    corrections = read_corrections(values)
    assert Corrections.model_validate_json(corrections.model_dump_json(exclude_defaults=True)) == corrections


@settings(max_examples=30, deadline=None)
@given(values=CORRECTIONS, more=EDITS)
def test_one_more_edit_adds_lines_and_changes_none(values, more):
    corrections = read_corrections(values)
    before = spell_corrections(corrections)
    after = spell_corrections(corrections.extended(read_corrections([more]).edits))
    if values["edits"]:
        assert after.startswith(before)
    else:
        assert after.startswith(before + "edits:\n")


def test_a_file_has_one_edit_a_line_and_one_stroke_a_line():
    corrections = read_corrections(
        {
            "video": "ab12",
            "settings": {"clustering.motions": "3", "clustering.threshold": 0.4},
            "edits": [
                {"drop": 2},
                {"merge": [3, 4]},
                {"split": {"object": 2, "frame": 31, "into": 7}},
                {"rename": {"object": 2, "name": "bear"}},
                {"rename": {"object": 3, "name": "<b>no: yes</b>"}},
                {"paint": {"object": 2, "frame": 12, "strokes": [{"radius": 9, "points": [[1, 2.5], [3, 4]]}]}},
                {"add": {"object": 8, "frame": 12, "points": [[5, 6]]}},
            ],
        }
    )
    assert spell_corrections(corrections).splitlines()[1:] == [
        "version: 1",
        "video: 'ab12'",
        "settings:",
        "  clustering.motions: 3",
        "  clustering.threshold: 0.4",
        "edits:",
        "  - drop: 2",
        "  - merge: [3, 4]",
        "  - split: {object: 2, frame: 31, into: 7}",
        "  - rename: {object: 2, name: bear}",
        '  - rename: {object: 3, name: "<b>no: yes</b>"}',
        "  - paint:",
        "      object: 2",
        "      frame: 12",
        "      strokes:",
        "        - {radius: 9, points: [[1, 2.5], [3, 4]]}",
        "  - add: {object: 8, frame: 12, points: [[5, 6]], not_points: [], by: region}",
    ]


def test_the_same_corrections_are_read_in_every_form(tmp_path):
    path = tmp_path / "corrections.yaml"
    path.write_text("version: 1\nsettings:\nedits:\n  - drop: 2\n", encoding="utf-8")
    forms = [
        path,
        str(path),
        {"edits": [{"drop": 2}]},
        [{"drop": "2"}],
        [Drop(drop=2)],
        Corrections(edits=(Drop(drop=2),)),
    ]
    assert {json.dumps(read_corrections(form).model_dump(mode="json")) for form in forms} == {
        Corrections(edits=(Drop(drop=2),)).model_dump_json().replace(",", ", ").replace(":", ": ")
    }


def test_nothing_corrected_is_no_correction():
    assert not read_corrections([])
    assert read_corrections({"settings": {"clustering.motions": 2}})
    assert read_corrections([{"drop": 1}])


def test_the_kind_of_an_edit_is_its_name_in_the_file():
    assert [kind_of(edit) for edit in read_corrections([{"drop": 1}, {"merge": [1, 2]}]).edits] == ["drop", "merge"]
    assert kind_of({"dorp": 1}) is None


WRONG = {
    "edit 1: drop; got True": [{"drop": True}],
    "edit 2; got drop, keep; expected one of drop, keep,": [{"drop": 1}, {"drop": 1, "keep": 1}],
    "edit 1; got 'dorp'; expected drop?": [{"dorp": 1}],
    "edit 1; got 'x'; expected one of drop": ["x"],
    "a missing value in corrections: edit 1: split.frame": [{"split": {"object": 2}}],
    "split.frame; got 0; expected greater than or equal to 1": [{"split": {"object": 2, "frame": 0}}],
    "edit 1: drop; got 0; expected greater than or equal to 1": [{"drop": 0}],
    "edit 1: drop; got 65536; expected less than or equal to 65535": [{"drop": 65536}],
    "edit 1: drop; got 'yes'; expected a valid integer": [{"drop": "yes"}],
    "expected objects that differ": [{"merge": [3, 3]}],
    "edit 1: merge; got [3]; expected at least 2": [{"merge": [3]}],
    "edit 1: rename.name; got ''; expected at least 1": [{"rename": {"object": 1, "name": ""}}],
    "expected at most 100 characters": [{"rename": {"object": 1, "name": "a" * 101}}],
    "expected a text of one line": [{"rename": {"object": 1, "name": "a\nb"}}],
    "edit 1: paint.strokes[1].points[1][2]; got 'b'; expected a valid number": [
        {"paint": {"object": 1, "frame": 1, "strokes": [{"radius": 1, "points": [[1, "b"]]}]}}
    ],
    "edit 1: paint.strokes[1].colour; got 3; expected one of radius, points": [
        {"paint": {"object": 1, "frame": 1, "strokes": [{"radius": 1, "colour": 3, "points": [[1, 2]]}]}}
    ],
    "edit 1: split.x; got 3; expected one of object, frame, into": [{"split": {"object": 2, "frame": 2, "x": 3}}],
    "corrections: x; got 2; expected one of version, video, part, settings, edits": {"x": 2},
    "corrections: version; got 2; expected 1": {"version": 2},
    "corrections: edits; got {'drop': 2}; expected a list": {"edits": {"drop": 2}},
    "unknown parameter 'clustering.motion' in corrections: did you mean 'clustering.motions'?": {
        "settings": {"clustering.motion": 1}
    },
    "a stage, not a parameter in corrections; got clustering; expected clustering.NAME": {
        "settings": {"clustering": {"motions": 3}}
    },
    "corrections: clustering.threshold; got 9; expected less than 1": {"settings": {"clustering.threshold": 9}},
    "corrections: video; got 'Z'; expected hexadecimal digits": {"video": "Z"},
    "not corrections in corrections; got int": 3,
}


@pytest.mark.parametrize("line", WRONG)
def test_what_is_wrong_is_named_in_one_line(line):
    with pytest.raises(InputError) as caught:
        read_corrections(WRONG[line])
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)


FILES = {
    "no version; expected version: 1": "edits:\n  - drop: 2\n",
    "line 3; got 'drop' twice": "version: 1\nedits:\n  - {drop: 2, drop: 3}\n",
    "line 2; got an alias (*), which is not read": "version: 1\nedits: [&a {drop: 2}, *a]\n",
    "edit 1; got 'dorp'; expected drop?": "version: 1\nedits:\n  - dorp: 2\n",
    "got a list; expected version, video, part, settings and edits": "- drop: 2\n",
    "line 3; got expected the node content": "version: 1\nedits: [\n",
    "expected YAML: version, video, part, settings and edits": "version: 1\nedits: !!python/object:os.system []\n",
    "line 3; got could not determine a constructor for the tag": "version: 1\nedits:\n  - drop: !!int x\n",
    "line 2; got a name that is no text": "version: 1\n!!merge <<: {edits: []}\n",
}


@pytest.mark.parametrize("line", FILES)
def test_what_is_wrong_in_a_file_is_named_with_the_file(tmp_path, line):
    path = tmp_path / "corrections.yaml"
    path.write_text(FILES[line], encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_corrections(path)
    assert line in str(caught.value)
    assert str(path) in str(caught.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(MissingInputError, match=r"no such corrections file in .*none\.yaml"):
        read_corrections(tmp_path / "none.yaml")
