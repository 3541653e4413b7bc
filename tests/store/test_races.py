"""Several processes and threads at once."""

import asyncio
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore, PutOutcome

WRITERS = """
import os, sys
import numpy as np
from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore

root = sys.argv[1]
LocalStore(root + "-warm").put(Recipe(task="toy", version=1), {"x": np.zeros(1)}, dims={"x": ("object",)})
gate, opener = os.pipe()
writers = []
for number in range(8):
    pid = os.fork()
    if pid == 0:
        os.close(opener)
        os.read(gate, 1)
        array = np.full((4, 50, 50), number, np.float32)
        outcome = LocalStore(root).put(Recipe(task="toy", version=1), {"x": array}, dims={"x": ("frame", "y", "x")})
        os.write(1, f"{outcome}\\n".encode())
        os._exit(0)
    writers.append(pid)
os.close(opener)
sys.exit(max(os.waitpid(pid, 0)[1] for pid in writers))
"""


def test_one_of_eight_processes_that_put_one_key_wins(tmp_path):
    root = tmp_path / "store"
    done = subprocess.run([sys.executable, "-c", WRITERS, str(root)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert Counter(done.stdout.split()) == {"committed": 1, "lost-race": 7}
    store = LocalStore(root)
    array = store.read(Recipe(task="toy", version=1).ref, "x", check=True)
    assert (array == array.flat[0]).all()
    assert [result.is_intact for result in store.verify()] == [True]
    assert list((root / "staging").iterdir()) == []


def test_threads_share_one_store(store, put_toy):
    array = np.arange(4 * 60 * 60, dtype=np.float32).reshape(4, 60, 60)

    def put_and_read(number: int) -> bool:
        return np.array_equal(store.read(put_toy(store, number, array=array + number), "x"), array + number)

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(put_and_read, range(24)))


def test_store_works_under_a_running_event_loop(store, put_toy):
    async def notebook() -> np.ndarray:
        return store.read(put_toy(store), "x")

    assert np.array_equal(asyncio.run(notebook()), np.arange(6.0).reshape(2, 3))


def test_an_error_inside_a_task_reaches_the_caller(store, monkeypatch):
    monkeypatch.setattr("moseg.store.codec.hash_array", lambda array: 1 // 0)
    recipe = Recipe(task="toy", version=1)
    with pytest.raises(ZeroDivisionError):
        store.put(recipe, {"x": np.zeros(2)}, dims={"x": ("object",)})
    monkeypatch.undo()
    assert store.put(recipe, {"x": np.zeros(2)}, dims={"x": ("object",)}) is PutOutcome.COMMITTED
