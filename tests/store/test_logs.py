"""Logs on a temporarily full disk, and during a collection."""

import resource
from pathlib import Path

import pytest

from moseg.schemas.errors import StoreError
from moseg.store import LocalStore
from moseg.store.local import logs

LINE = b"x" * 99 + b"\n"


@pytest.fixture
def full_disk():
    """Return a function that runs a call which can write files of so many bytes only, as on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)

    def call(max_bytes, work):
        resource.setrlimit(resource.RLIMIT_FSIZE, (max_bytes, hard))
        try:
            work()
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))

    return call


def _append_cut(store, full_disk):
    store.append_log("run", LINE)
    with pytest.raises(StoreError, match="run's log"):
        full_disk(150, lambda: store.append_log("run", LINE))


def test_an_append_that_does_not_fit_is_an_error_and_is_not_continued(store: LocalStore, full_disk):
    _append_cut(store, full_disk)
    assert store.read_log("run") == [LINE[:-1]]
    store.append_log("run", b"after\n")
    store.append_log("run", b"last\n")
    assert store.read_log("run") == [LINE[:-1], LINE[:50], b"after", b"last"]


def test_a_process_of_the_same_number_does_not_continue_a_cut_line(store: LocalStore, full_disk, monkeypatch):
    _append_cut(store, full_disk)
    monkeypatch.setattr(logs, "_whole", set())
    store.append_log("run", b"after\n")
    assert store.read_log("run")[-1] == b"after"


def test_a_log_that_vanishes_while_logs_are_listed_is_skipped(store: LocalStore, monkeypatch):
    for run_id in ("gone", "kept"):
        store.append_log(run_id, b"line\n")
    stat = Path.stat

    def vanish(path, **options):
        if path.parent.name == "gone":
            raise FileNotFoundError(path)
        return stat(path, **options)

    monkeypatch.setattr(Path, "stat", vanish)
    assert store.logs().keys() == {"kept"}
