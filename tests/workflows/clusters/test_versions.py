"""Client, scheduler and workers run the same code and have the same packages, or the run is refused by name."""

import shutil
from pathlib import Path

import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.cluster import distributed_runner, process_facts
from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.check import ClusterCheck
from moseg.workflows.cluster.runners import open_runner

DEADLINE_SEC = 600
ROOT = Path(__file__).resolve().parents[3]
NO_SUCH_PACKAGE = """
import sys

class Blocker:
    def find_spec(name, path=None, target=None):
        if name in MISSING:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Blocker)
"""


@pytest.fixture
def other_version(tmp_path) -> Path:
    """A folder with a copy of the package `moseg` that has one more line."""
    # Compiled files spare a compilation; those that another process is about to write have one more suffix.
    ignored = shutil.ignore_patterns("*.pyc.*")
    package = shutil.copytree(ROOT / "workflows" / "api" / "moseg", tmp_path / "other" / "moseg", ignore=ignored)
    for room, folder in zip(process_facts.ROOMS, ("schemas", "store", "moseg_tasks", "workflows"), strict=True):
        shutil.copytree(ROOT / folder, package / room.partition(".")[2], ignore=ignored)
    path = package / "tasks" / "flow" / "dis.py"
    path.write_text(path.read_text() + "\nWORD = 1\n")
    return tmp_path / "other"


@pytest.fixture
def without(tmp_path):
    """Returns a folder that hides packages from a Python that has it on its path."""

    def make(*packages: str) -> Path:
        folder = tmp_path / "-".join(packages)
        folder.mkdir()
        (folder / "sitecustomize.py").write_text(f"MISSING = {packages!r}\n{NO_SUCH_PACKAGE}")
        return folder

    return make


@pytest.fixture
def small_windows(monkeypatch):
    """Use small windows: new workers are checked whenever calls are submitted, so they are checked often."""
    monkeypatch.setattr(distributed_runner, "MIN_WINDOW", 8)
    monkeypatch.setattr(distributed_runner, "CALLS_PER_THREAD", 8)


def _slow_calls(count, needs_gpu=False):
    """Calls of a tenth of a second."""

    # Workers cannot import this file; what is defined in a function travels as code.
    def wait(number):
        import time

        time.sleep(0.1)
        return number

    return [Call(f"slow-{number}", wait, (number,), needs_gpu=needs_gpu) for number in range(count)]


def _expect_refusal(moseg, cluster, *parts):
    ran = moseg("eval", "--scheduler", cluster.address)
    assert ran.code == 2, ran.err
    assert len(ran.err.splitlines()) == 1
    for part in parts:
        assert part in ran.err


def test_a_worker_of_another_version_is_refused_by_name(with_a_worker, other_version, moseg, in_empty_folder):
    cluster = with_a_worker
    cluster.add_worker("other", path=other_version)
    address = cluster.worker_address("other")
    own = process_facts.code_fingerprint()
    expected = f"expected code {own}, as here: install the same moseg there"
    _expect_refusal(moseg, cluster, f"another version of moseg in worker {address}; got code ", expected)


def test_a_scheduler_of_another_version_is_refused(start_cluster, other_version, moseg, in_empty_folder):
    cluster = start_cluster(path=other_version)
    _expect_refusal(moseg, cluster, f"another version of moseg in scheduler {cluster.address}")


@pytest.mark.parametrize(
    ("packages", "what"),
    [(process_facts.ROOMS, "no moseg"), (["cv2"], "no package cv2"), (["poselib"], "no package poselib")],
)
def test_a_worker_with_a_missing_package_is_refused_by_name(
    with_a_worker, without, moseg, in_empty_folder, packages, what
):
    cluster = with_a_worker
    cluster.add_worker("incomplete", path=without(*packages))
    _expect_refusal(moseg, cluster, what, f"in worker {cluster.worker_address('incomplete')}")


def test_a_worker_without_the_packages_of_networks_runs_all_other_calls(cluster, without):
    pytest.importorskip("torch")
    cluster.add_worker("incomplete", path=without("torch"))
    found = {}
    with open_runner(scheduler=cluster.address, device="cpu") as runner:
        runner.run(_slow_calls(1), found.__setitem__)
        with pytest.raises(InputError, match=f"no package torch in worker {cluster.worker_address('incomplete')}"):
            runner.run(_slow_calls(1, needs_gpu=True), found.__setitem__)
    assert found == {"slow-0": 0}


def test_a_worker_of_another_version_that_joins_later_ends_the_run(with_a_worker, other_version, small_windows):
    late = []

    def join(name, result):
        if not late:
            late.append(with_a_worker.add_worker("late", path=other_version))

    with (
        open_runner(scheduler=with_a_worker.address) as runner,
        pytest.raises(InputError, match="another version of moseg in worker tcp://"),
    ):
        runner.run(_slow_calls(100), join)
    assert late


def test_a_worker_without_moseg_that_joins_later_leaves_its_calls_to_the_others(with_a_worker, without, small_windows):
    cluster = with_a_worker
    late, found = [], {}

    def join(name, result):
        found[name] = result
        if not late:
            late.append(cluster.add_worker("late", path=without(*process_facts.ROOMS)))

    with open_runner(scheduler=cluster.address) as runner:
        runner.run(_slow_calls(40), join)
    assert len(found) == 40
    late[0].wait(timeout=DEADLINE_SEC)
    assert "No module named 'moseg." in cluster.log("late")


def test_nothing_of_a_run_stays_on_the_cluster(with_a_worker, without):
    with open_runner(scheduler=with_a_worker.address) as runner:
        runner.run(_slow_calls(3), lambda name, result: None)
    # A plugin that was left behind would keep it from joining.
    with_a_worker.add_worker("strange", path=without(*process_facts.ROOMS))


class _Workers:
    """A cluster whose workers give the answers of the test."""

    def __init__(self, versions, answers=()):
        self._versions = versions
        self._answers = dict(answers)

    def run(self, function, workers, on_error):
        facts = function()
        said = {
            address: facts | {"versions": facts["versions"] | self._versions.get(address, {})} for address in workers
        }
        return said | {address: answer for address, answer in self._answers.items() if address in workers}


def test_other_versions_of_libraries_are_reported_once_in_one_line(capsys):
    other = {"a": {"numpy": "1.0"}, "b": {"numpy": "1.0"}, "c": {}, "d": {"scipy": "2.0", "numpy": "1.0"}}
    check = ClusterCheck(_Workers(other))
    assert check.check_workers("abc") == ["a", "b", "c"]
    err = capsys.readouterr().err
    assert len(err.splitlines()) == 1
    assert "numpy 1.0 (here " in err and ") on a and 1 more" in err
    assert check.check_workers("abcd") == ["d"]
    err = capsys.readouterr().err
    assert "scipy 2.0" in err and "numpy" not in err
    assert check.check_workers("abcd") == []
    assert capsys.readouterr().err == ""


def test_a_late_worker_that_cannot_answer_is_left_out_and_reported_once(capsys):
    missing = ModuleNotFoundError("No module named 'moseg.workflows'")
    check = ClusterCheck(_Workers({}, {"b": missing, "c": OSError("gone")}))
    assert check.check_workers("a") == ["a"]
    for new in (["d"], []):
        assert check.check_late_workers("abcd") == new
        assert check.unresponsive == {"b"}
    (line,) = capsys.readouterr().err.splitlines()
    assert "in worker b" in line and "No module named 'moseg.workflows'" in line
    # After a call has failed for want of a module, the worker is named as the reason.
    check.forget_workers()
    with pytest.raises(InputError, match="no moseg, or another version of it in worker b"):
        check.check_workers("abd")


def test_a_late_worker_of_another_version_is_refused():
    check = ClusterCheck(_Workers({}, {"b": {"fingerprint": "0", "missing": None, "versions": {}}}))
    with pytest.raises(InputError, match="another version of moseg in worker b"):
        check.check_late_workers("ab")


def _installed(folder: Path, **files: str) -> Path:
    for room in process_facts.ROOMS:
        (folder / room).mkdir(parents=True)
        (folder / room / "__init__.py").write_bytes(b"")
    for name, text in files.items():
        (folder / "moseg.store" / f"{name}.py").write_bytes(text.encode())
    return folder


def _fingerprint(folder, monkeypatch):
    monkeypatch.setattr(process_facts, "_folders", lambda room: [folder / room])
    return process_facts.code_fingerprint.__wrapped__()


def test_the_code_is_its_files_names_and_texts(tmp_path, monkeypatch):
    first = _fingerprint(_installed(tmp_path / "0", a="x = 1\n", b="y\n"), monkeypatch)
    assert _fingerprint(_installed(tmp_path / "1", b="y\n", a="x = 1\r\n"), monkeypatch) == first
    others = [
        {"a": "x = 2\n", "b": "y\n"},
        {"a": "x = 1\n", "c": "y\n"},
        {"a": "x = 1\n"},
        {"a": "x = 1\ny\n", "b": ""},
    ]
    found = [_fingerprint(_installed(tmp_path / f"o{i}", **files), monkeypatch) for i, files in enumerate(others)]
    assert len({first, *found}) == 5
    (tmp_path / "0" / "moseg.store" / "a.pyc").write_bytes(b"compiled")
    assert _fingerprint(tmp_path / "0", monkeypatch) == first


def test_the_code_of_this_process_is_read_once():
    assert process_facts.code_fingerprint() is process_facts.code_fingerprint()
