"""Leaves of weights items, found when they are read."""

import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.recipes import split_ref
from moseg.workflows.engine.session import open_session
from moseg.workflows.weights.leaves_by_name import LeavesByName


def _leaves(items, suffix=""):
    asked = []

    def find(name, architecture):
        asked.append((name, architecture))
        return f"weights/{name}{suffix}"

    return LeavesByName(items, find), asked


def test_a_leaf_is_found_once_and_only_if_it_is_read():
    leaves, asked = _leaves({"raft-large": "raft", "pips": "pips"})
    assert list(leaves) == ["raft-large", "pips"] and len(leaves) == 2 and "pips" in {*leaves} and not asked
    assert leaves["pips"] == leaves["pips"] == "weights/pips"
    assert asked == [("pips", "pips")] and leaves.read == ("pips",)


def test_an_unnamed_item_is_a_key_error():
    with pytest.raises(KeyError):
        _leaves({})[0]["pips"]


def test_both_have_the_items_of_each_and_what_was_found():
    (first, asked), (second, _) = _leaves({"raft-large": "raft"}), _leaves({"sam": "sam2"})
    assert first["raft-large"]
    both = first | second
    assert set(both) == {"raft-large", "sam"} and both["raft-large"] and len(asked) == 1
    assert both["sam"] == "weights/sam"


def test_leaves_are_equal_if_items_and_leaves_that_were_read_are():
    (first, asked), (same, _), (other, _) = (_leaves({"pips": "pips"}, suffix) for suffix in ("", "", "*"))
    assert first == same and first == other and not asked
    assert first["pips"]
    assert first == same and first != other and first != _leaves({})[0]


@pytest.mark.parametrize(
    ("items", "message"),
    [
        ({"raft-lrge": "raft"}, "raft-large"),
        ({"pips": "raft"}, "weights of another network"),
        ({"sam3": "sam3"}, "--accept-licence SAM-License"),
    ],
)
def test_wrong_items_and_licences_are_refused_before_a_leaf_is_read(items, message, tmp_path, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path / "nothing"))
    with open_session(str(tmp_path / "store"), quiet=True, offline=True) as session:
        with pytest.raises(InputError, match=message):
            session.name_weights(items)
        assert session.name_weights({"pips": "pips"}).read == ()


def test_what_was_not_found_is_recorded_as_a_reference_that_no_artifact_has():
    leaves, asked = _leaves({"raft-large": "raft", "pips": "pips"})
    assert leaves["pips"]
    recorded = leaves.recorded()
    assert len(asked) == 1 and recorded["pips"] == "weights/pips"
    assert split_ref(recorded["raft-large"])[0] == "weights" and recorded["raft-large"] != "weights/raft-large"
