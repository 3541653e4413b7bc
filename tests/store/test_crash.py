"""Real kills: nothing incomplete that a killed writer leaves is ever returned.

One helper process imports everything once and forks a victim for each kill; it has a single thread, so forking is safe.
"""

import json
import subprocess
import sys

import numpy as np
import pytest

from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore, PutOutcome

VICTIMS = """
import json, os, random, signal, sys, time
import numpy as np
from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore

root, mode = sys.argv[1:]
store = LocalStore(root)
ARRAY = np.arange(6 * 100 * 100, dtype=np.float32).reshape(6, 100, 100)
EVENTS = {"open", "os.mkdir", "os.rename", "os.rmdir", "os.remove", "os.listdir", "os.scandir"}


def put(number):
    recipe = Recipe(task="toy", version=1, params={"number": number})
    store.put(recipe, {"x": ARRAY + number}, {"number": number}, dims={"x": ("frame", "y", "x")})


def die_at(step):
    seen = 0

    def count(event, args):
        nonlocal seen
        if event in EVENTS and args and root in str(args[0]):
            seen += 1
            if seen == step:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(count)


def run(victim):
    pid = os.fork()
    if pid == 0:
        try:
            victim()
        finally:
            os._exit(0)
    return pid


def every_step():
    kills = 0
    while True:
        pid = run(lambda: (die_at(kills + 1), put(kills)))
        if os.waitpid(pid, 0)[1] == 0:
            return kills
        kills += 1


def random_moments():
    rng = random.Random(0)
    started, start = os.pipe()
    for trial in range(20):
        pid = run(lambda: (os.write(start, b"x"), [put(1000 * trial + number) for number in range(1000)]))
        os.read(started, 1)
        time.sleep(rng.uniform(0.0, 0.02))
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)
    return 20


put(-1)
print(json.dumps(every_step() if mode == "steps" else random_moments()))
"""
ARRAY = np.arange(6 * 100 * 100, dtype=np.float32).reshape(6, 100, 100)


@pytest.mark.parametrize("mode", ["steps", "moments"])
def test_killed_writers_leave_complete_artifacts_or_none(tmp_path, mode):
    root = tmp_path / "store"
    done = subprocess.run([sys.executable, "-c", VICTIMS, str(root), mode], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    # the folder and files of one put, its rename and the sweep after it
    assert json.loads(done.stdout) >= 5

    store = LocalStore(root)
    stored = list(store.refs())
    assert stored
    assert [result for result in store.verify() if not result.is_intact] == []
    for ref in stored[:20]:
        assert np.array_equal(store.read(ref, "x"), ARRAY + store.attributes(ref)["number"])

    leftovers = list((root / "staging").iterdir())
    assert leftovers or mode == "moments"
    for number in range(12):
        recipe = Recipe(task="toy", version=1, params={"number": number})
        expected = PutOutcome.LOST_RACE if store.has(recipe.ref) else PutOutcome.COMMITTED
        assert store.put(recipe, {"x": ARRAY}, dims={"x": ("frame", "y", "x")}) is expected

    report = store.gc(is_dry=False)
    assert len(report.leftovers) == len(leftovers) and report.removed == ()
    assert list((root / "staging").iterdir()) == []
