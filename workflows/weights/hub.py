"""Addresses of files on a model hub: their commit, and the hub's record of a file's digest and size."""

import json
import re
from typing import NamedTuple
from urllib.parse import urlsplit

from moseg.schemas.errors import InputError
from moseg.workflows.weights.connection import read_url

HUB = "huggingface.co"
TOKEN_VARIABLE = "HF_TOKEN"
_PATH = re.compile(r"/(?P<repository>[^/]+/[^/]+)/resolve/(?P<revision>[^/]+)/(?P<path>.+)")
_COMMIT = re.compile(r"[0-9a-f]{40}")
_POINTER = re.compile(
    r"version https://git-lfs\.github\.com/spec/v1\noid sha256:(?P<sha256>[0-9a-f]{64})\nsize (?P<size>[1-9]\d*)\n"
)
POINTER_BYTES = 1024
"""A pointer of Git LFS is shorter than this by the format's definition."""
ANSWER_BYTES = 16 * 2**20


class HubFile(NamedTuple):
    """A file of a repository of the hub at a revision: a commit, or a branch, whose commit changes."""

    origin: str
    repository: str
    revision: str
    path: str

    @property
    def is_pinned(self) -> bool:
        """Return whether the revision is a commit."""
        return _COMMIT.fullmatch(self.revision) is not None

    @property
    def url(self) -> str:
        """Return the address from which the file is downloaded."""
        return f"{self.origin}/{self.repository}/resolve/{self.revision}/{self.path}"


class Pointer(NamedTuple):
    """What Git LFS stores in place of a large file."""

    sha256: str
    size: int


def parse_hub_url(url: str) -> HubFile | None:
    """Return the file that an address of the hub's form names; None for any other address."""
    parts = urlsplit(url)
    match = _PATH.fullmatch(parts.path)
    return HubFile(f"{parts.scheme}://{parts.netloc}", **match.groupdict()) if match else None


def resolve_commit(file: HubFile, token: str | None) -> str:
    """Return the current commit of the file's branch.

    Raises
    ------
    InputError
        The hub cannot be reached or gives no commit.
    """
    url = f"{file.origin}/api/models/{file.repository}/revision/{file.revision}"
    answer = read_url(url, ANSWER_BYTES, token_for(url, token))
    try:
        commit = json.loads(answer)["sha"]
    except (KeyError, TypeError, ValueError, RecursionError):
        commit = None
    if not isinstance(commit, str) or not _COMMIT.fullmatch(commit):
        raise InputError("the hub names no commit", where=url, got=repr(answer[:80]))
    return commit


def read_pointer(file: HubFile, token: str | None) -> Pointer | None:
    """Return digest and size of a file in Git LFS; None for one in Git itself, as small files are."""
    url = f"{file.origin}/{file.repository}/raw/{file.revision}/{file.path}"
    match = _POINTER.fullmatch(read_url(url, POINTER_BYTES, token_for(url, token)).decode("utf-8", "replace"))
    return Pointer(match["sha256"], int(match["size"])) if match else None


def token_for(url: str, token: str | None) -> str | None:
    """Return the user's token if the address is the hub's; no other host may see it.

    Raises InputError, without the token in its message, if it cannot be a token.
    """
    parts = urlsplit(url)
    if token is None or (parts.scheme, parts.hostname) != ("https", HUB):
        return None
    if not re.fullmatch(r"[!-~]+", token):
        got, expected = "characters that no token has", "printable ASCII without blanks"
        raise InputError("not a token", where=TOKEN_VARIABLE, got=got, expected=expected)
    return token
