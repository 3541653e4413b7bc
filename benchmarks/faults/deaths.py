"""Processes that kill themselves, or each other, at a step of their own work: no outside observer is as exact.

Each Python loads ``sitecustomize`` at its start, and these lines are put first under that name. They count the steps
that it takes in the file system (audit events) and send SIGKILL at one of them.
"""

import os
from pathlib import Path

_COUNTED = """
import os, signal, sys

steps = {steps}
names = {{"open", "os.mkdir", "os.rename", "os.rmdir", "os.remove"}}

def die(event, arguments):
    global steps
    if event not in names or {store!r} not in str(arguments[0]):
        return
    steps -= 1
    if steps == 0:
        try:
            os.close(os.open({token!r}, os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            return
        {kill}

is_worker = any("spawn_main" in word for word in sys.orig_argv)
if is_worker == {in_worker} and not any("resource_tracker" in word for word in sys.orig_argv):
    sys.addaudithook(die)
"""
_AT_TASK = """
import os, signal, sys

def die(event, arguments):
    if event == "os.rename" and "/objects/{task}/" in str(arguments[1]):
        os.kill(os.getpid(), signal.SIGKILL)

if any("spawn_main" in word for word in sys.orig_argv):
    sys.addaudithook(die)
"""
_KILLS = {
    "worker": "os.kill(os.getpid(), signal.SIGKILL)",
    "client": "os.kill(os.getppid() if is_worker else os.getpid(), signal.SIGKILL)",
    "both": "os.kill(os.getppid(), signal.SIGKILL), os.kill(os.getpid(), signal.SIGKILL)",
    "group": "os.killpg(0, signal.SIGKILL)",
}


def die_at_step(folder: Path, store: str, steps: int, victim: str, in_worker: bool) -> tuple[dict[str, str], Path]:
    """Return an environment in which the first process that takes so many steps in a store kills the victim, once.

    Returns
    -------
    dict
        The environment.
    Path
        A file that exists once a process was killed.
    """
    token = folder / "killed"
    site = _COUNTED.format(steps=steps, store=store, token=str(token), kill=_KILLS[victim], in_worker=in_worker)
    return _environ(folder, site), token


def die_at_task(folder: Path, task: str) -> dict[str, str]:
    """Return an environment in which no worker survives the work of a task: each dies before it commits it."""
    return _environ(folder, _AT_TASK.format(task=task))


def _environ(folder: Path, site: str) -> dict[str, str]:
    folder.mkdir(parents=True)
    (folder / "sitecustomize.py").write_text(site, encoding="utf-8")
    paths = [str(folder), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
