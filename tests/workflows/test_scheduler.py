"""Runs on a Dask cluster of the user's own, and runs on local workers that are interrupted."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from distributed import Client, LocalCluster

from moseg.store import open_store

MOSEG = [sys.executable, "-c", "from moseg.workflows.cli import main; main()"]
DEADLINE_SEC = 600
CTRL_C = "os.killpg(0, signal.SIGINT)"

needs_process_groups = pytest.mark.skipif(os.name != "posix", reason="process groups are POSIX")


def _contents(folder):
    """Return all artifacts' arrays, by digest of their bytes, and attributes."""
    store = open_store(str(folder), create=False)
    found = {}
    for ref in store.refs():
        manifest = store.manifest(ref)
        found[ref] = ({entry.name: entry.digest for entry in manifest.arrays}, manifest.attributes)
    return found


def _wait(is_done):
    deadline = time.monotonic() + DEADLINE_SEC
    while not is_done():
        assert time.monotonic() < deadline
        time.sleep(0.005)


def _has_group(group):
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_an_existing_cluster_gives_the_same_keys_and_bytes_and_keeps_running(evaluated, moseg, tmp_path):
    with LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
        silence_logs="ERROR",
    ) as cluster:
        options = ("--scheduler", cluster.scheduler_address, "--store", tmp_path / "store")
        ran = moseg(*evaluated.arguments, *options, "--json", tmp_path / "report.json")
        assert (ran.code, ran.err) == (0, "")
        with Client(cluster) as client:
            assert client.submit(sum, [1, 2]).result(timeout=DEADLINE_SEC) == 3
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["rows"] == evaluated.report["rows"]
    assert report["store"] == evaluated.report["store"]
    assert _contents(tmp_path / "store") == _contents(evaluated.store)


def _interrupt(arguments, env):
    """Run with two workers until Ctrl-C, and check that all started processes end."""
    run = subprocess.Popen(
        [*MOSEG, *arguments, "--workers", "2"],
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # Processes that a shell runs in the background ignore Ctrl-C.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    out, err = run.communicate(timeout=DEADLINE_SEC)
    assert (run.returncode, out) == (130, "")
    assert err.startswith("moseg: interrupted")
    assert len(err.splitlines()) == 1, err
    _wait(lambda: not _has_group(run.pid))


@needs_process_groups
def test_ctrl_c_while_workers_start_ends_all_with_one_line(evaluated, strike_at, tmp_path):
    env, pressed = strike_at("event == 'import' and arguments[0] == 'distributed'", CTRL_C, in_worker=True)
    _interrupt((*evaluated.arguments, "--store", str(tmp_path / "store")), env)
    assert pressed.exists()
    assert list(open_store(str(tmp_path / "store"), create=False).refs()) == []


@needs_process_groups
def test_ctrl_c_during_a_run_ends_all_with_one_line_and_the_run_can_be_resumed(evaluated, moseg, strike_at, tmp_path):
    step = "event == 'os.rename' and '/objects/flow/' in str(arguments[1])"
    env, pressed = strike_at(step, CTRL_C, in_worker=True, steps=2)
    arguments = (*evaluated.arguments, "--store", str(tmp_path / "store"))
    _interrupt(arguments, env)
    assert pressed.exists()

    store = open_store(str(tmp_path / "store"), create=False)
    assert store.pinned() == {}
    committed = set(store.refs())
    assert not list(store.refs("score"))
    ran = moseg(*arguments, "--json", tmp_path / "report.json")
    assert (ran.code, ran.err) == (0, "")
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["rows"] == evaluated.report["rows"]
    assert report["store"]["computed"] == len(set(store.refs()) - committed)
    assert _contents(tmp_path / "store") == _contents(evaluated.store)
