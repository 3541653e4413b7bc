"""Leftovers of processes that died: by the newest of their files."""

from moseg.store.remote.leftovers import find_leftovers
from moseg.store.remote.requests import Found

DAY = 86_400.0


class Listed:
    """Objects by name, each with its age in seconds; none has content."""

    def __init__(self, **ages):
        self._items = [Found(name=name, nbytes=1, modified=10 * DAY - age) for name, age in ages.items()]

    def listing(self, folder):
        return (item for item in self._items if item.name.startswith(f"{folder}/"))

    def get_many(self, names):
        return dict.fromkeys(names)


def test_a_put_whose_last_file_is_new_goes_on():
    folder = f"payloads/toy/00/{'0' * 64}/{'0' * 16}-1-{'0' * 32}"
    ages = {f"{folder}/a": 2 * DAY, f"{folder}/b": 60.0}
    assert find_leftovers(Listed(**ages), 10 * DAY, 0.0) == {}
    assert find_leftovers(Listed(**ages | {f"{folder}/b": 2 * DAY}), 10 * DAY, 0.0) == {folder: 2}


def test_what_was_quarantined_a_moment_ago_stays():
    ages = {"quarantine/toy-0-1/reason.json": 60.0, "quarantine/toy-0-1/artifact/manifest.json": 2 * DAY}
    assert find_leftovers(Listed(**ages), 10 * DAY, 9 * DAY) == {}
