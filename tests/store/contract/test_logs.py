"""Logs of runs on every kind of store."""

import time

import pytest

from moseg.schemas.errors import InputError


def test_a_log_keeps_its_lines_in_order(store):
    before = time.time()
    store.append_log("run-1", b"one\ntwo\n")
    store.append_log("run-1", b"three\n")
    store.append_log("run-2", b"other\n")
    assert store.read_log("run-1") == [b"one", b"two", b"three"]
    assert store.logs().keys() == {"run-1", "run-2"}
    assert before - 60 < store.logs()["run-1"] < before + 600
    assert store.remove_log("run-1") and not store.remove_log("run-1")
    assert store.logs().keys() == {"run-2"} and store.read_log("run-1") == []


@pytest.mark.parametrize("bad", ["", "../run", "a/b", ".", "x" * 101])
def test_only_a_run_name_names_a_log(store, bad):
    for call in (store.read_log, store.remove_log, lambda name: store.append_log(name, b"line\n")):
        with pytest.raises(InputError, match="run"):
            call(bad)
