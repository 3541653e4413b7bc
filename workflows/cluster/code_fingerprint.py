"""A digest of this program's code, by which the processes of a cluster find out whether they all run the same."""

from functools import cache
from hashlib import blake2b
from importlib.util import find_spec
from pathlib import Path

from moseg.schemas.errors import InputError

ROOMS = ("moseg.schemas", "moseg.store", "moseg.tasks", "moseg.workflows")
FRONT = ("api", "moseg")
"""Folder of `moseg.workflows` in the checkout only: installed, the package `moseg` stands above the rooms."""
DIGEST_BYTES = 8
"""Short enough to be read aloud; nobody forges it, it tells versions apart."""


@cache
def code_fingerprint() -> str:
    """Digest of the source files of all rooms as this process finds them installed.

    What counts is the name and the text of every ``.py`` file, comments included and line ends not: a comment cannot
    change a result, but that it differs shows that somebody installed something else. Read once for each process, about
    when its code is loaded (some 10 ms for 500 files), so a worker that was started before an upgrade still tells what
    it runs.

    Raises
    ------
    ModuleNotFoundError
        A room is not installed.
    """
    state = blake2b(digest_size=DIGEST_BYTES, person=b"moseg:code")
    for room in ROOMS:
        for folder in _folders(room):
            for path in sorted(folder.rglob("*.py"), key=lambda path: path.relative_to(folder).as_posix()):
                if path.relative_to(folder).parts[:2] == FRONT:
                    continue
                content = path.read_bytes().replace(b"\r\n", b"\n")
                name = f"{room}/{path.relative_to(folder).as_posix()}".encode()
                for part in (name, content):
                    state.update(len(part).to_bytes(8, "little"))
                    state.update(part)
    return state.hexdigest()


def refuse_other_code(where: str, got: str, expected: str) -> None:
    """Raise InputError where the code that is got is not the one expected."""
    if got != expected:
        expected = f"code {expected}, as here: install the same moseg there and start it anew, it keeps what it loaded"
        raise InputError("another version of moseg", where=where, got=f"code {got}", expected=expected)


def _folders(room: str) -> list[Path]:
    spec = find_spec(room)
    if spec is None or not spec.submodule_search_locations:
        raise ModuleNotFoundError(f"No module named {room!r}", name=room)
    return [Path(location) for location in spec.submodule_search_locations]
