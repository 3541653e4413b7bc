"""Short forms of the experiments in ``benchmarks/faults``: real faults on real runs, every law checked.

Each experiment ends with exit code 1 and names the law if one was broken.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

FAULTS = Path(__file__).resolve().parents[2] / "benchmarks" / "faults"

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="process groups and mounts as Linux has")


@pytest.fixture
def experiment(tmp_path):
    """Return a function that runs an experiment in an empty folder and returns its table."""

    def run(script: str, *options: object) -> str:
        command = [sys.executable, str(FAULTS / script), *map(str, options), "--root", str(tmp_path)]
        # The result must not depend on the number of threads of the machine.
        environ = {**os.environ, "OMP_NUM_THREADS": "1"}
        done = subprocess.run(command, cwd=tmp_path, env=environ, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        assert list(tmp_path.iterdir()) == []
        return done.stdout

    return run


def rows(table: str) -> list[list[str]]:
    """Return the cells of the lines below a table's head."""
    lines = [line for line in table.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[1:]]


def test_a_killed_run_leaves_complete_artifacts_and_can_be_resumed(experiment):
    table = experiment("crash.py", "--only-steps", "--kills", 1, "--frames", 4, "--cells", "segment-2-both")
    assert [cells[1:4] for cells in rows(table)] == [["segment", "2", "both"]]


def test_a_run_killed_on_an_object_store_leaves_complete_artifacts(experiment):
    pytest.importorskip("moto")
    options = ("--only-steps", "--kills", 1, "--frames", 4, "--cells", "eval-0-client")
    assert len(rows(experiment("crash.py", "--object-store", *options))) == 1


def test_damage_to_every_task_is_found_and_repaired(experiment):
    table = experiment("corruption.py", "--frames", 5, "--cases", "pack:flipped byte")
    ((_, _, num_tasks, found, met, made, at_the_end),) = rows(table)
    assert int(num_tasks) >= 15 and int(met) >= 1
    assert num_tasks == found == made
    assert at_the_end == "identical"


def test_processes_at_once_compute_each_artifact_once(experiment):
    table = experiment("races.py", "--processes", 3, "--rounds", 1, "--frames", 5)
    assert [cells[1] for cells in rows(table)] == ["1 of 1", "3 of 3"]


def test_a_full_or_read_only_disk_gives_one_line_and_loses_nothing(experiment):
    table = rows(experiment("disk.py", "--cases", "full", "read-only", "--short", "--frames", 5))
    if table[0][2] == "not run":
        # Without permission to mount, a limit on the size of files has the same effect.
        (cells,) = rows(experiment("disk.py", "--cases", "file-size", "--short", "--frames", 5))
        assert cells[2] == "1"
        pytest.skip(f"full and read-only disks: {table[0][3]}")
    assert [cells[2] for cells in table] == ["2", "1", "0", "1", "1"]


def test_a_store_named_in_another_script_works(experiment):
    table = experiment("odd_paths.py", "--frames", 4, "--names", "letters")
    assert [cells[3] for cells in rows(table)] == ["0", "0", "0"]


def test_damaged_files_of_every_kind_are_read_or_refused_in_one_line(experiment):
    # Time is not a law here: a machine may be busy.
    table = rows(experiment("fuzz_readers.py", "--mutations", 30, "--seconds", 30))
    assert len(table) >= 29
    assert all(int(results) + int(refusals) == 30 for _, _, results, refusals, *_ in table)
    # The damage is strong enough that some files are refused, and weak enough that some are read.
    assert sum(int(cells[2]) > 0 for cells in table) >= 25 and sum(int(cells[3]) > 0 for cells in table) >= 25


def test_a_run_survives_the_loss_of_a_worker(experiment):
    (cells,) = rows(experiment("worker_loss.py", "--rounds", 1, "--frames", 6, "--cases", "lost-worker"))
    assert cells[2] == "0"
