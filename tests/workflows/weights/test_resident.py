"""One network in a process, shared by all tasks."""

import threading
import weakref
from typing import NamedTuple

import pytest

from moseg.schemas.errors import InputError
from moseg.tasks.networks.pips import build_pips
from moseg.tasks.networks.raft import build_raft
from moseg.workflows.process.devices import set_device
from moseg.workflows.stages.resident import open_network
from moseg.workflows.weights.folder import open_weights, weights_leaf
from moseg.workflows.weights.tiny.make_tiny import make_tiny


class Leaf(NamedTuple):
    """The part of a stored leaf that a task reads."""

    ref: str
    attributes: dict


@pytest.fixture
def leaves(tmp_path, monkeypatch):
    """Return leaves of a tiny RAFT and a tiny PIPs."""
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path))
    set_device("cpu")
    environment = {"MOSEG_WEIGHTS": str(tmp_path)}
    items = open_weights(environment).items
    make_tiny(tmp_path, [items["raft-large"], items["pips"]], seed=0)
    weights = open_weights(environment)
    made = (weights_leaf(weights, name, kind) for name, kind in (("raft-large", "raft"), ("pips", "pips")))
    return [Leaf(leaf.recipe.ref, leaf.attributes) for leaf in made]


def test_a_network_is_loaded_once_and_replaced_by_another(leaves):
    raft, pips = leaves
    with open_network(build_raft, raft) as first, open_network(build_raft, raft) as again:
        assert first is again
    with open_network(build_pips, pips):
        pass
    with open_network(build_raft, raft) as later:
        assert later is not first


@pytest.mark.parametrize("has_cycle", [False, True])
def test_a_network_is_freed_before_another_is_loaded(has_cycle, leaves):
    raft, pips = leaves
    loaded, freed = [], []

    def build_first(checkpoint):
        network = build_raft(checkpoint)
        network.parts = [network] if has_cycle else []
        loaded.append(weakref.ref(network))
        return network

    def build_second(checkpoint):
        freed.append(loaded[0]() is None)
        return build_pips(checkpoint)

    with open_network(build_first, raft):
        pass
    with open_network(build_second, pips):
        pass
    assert freed == [True]


def test_a_thread_waits_while_another_uses_its_network(leaves):
    raft, pips = leaves
    entered = threading.Event()

    def use():
        with open_network(build_pips, pips):
            entered.set()

    with open_network(build_raft, raft):
        thread = threading.Thread(target=use)
        thread.start()
        assert not entered.wait(0.5)
    thread.join()
    assert entered.is_set()


def test_other_bytes_than_the_leaf_names_are_refused(leaves, tmp_path):
    raft, _ = leaves
    path = tmp_path / "raft-large" / "model.pth"
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    with pytest.raises(InputError, match="another weights file"), open_network(build_raft, raft):
        pass
