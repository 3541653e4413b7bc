"""The files of the page, which are part of the package: nothing else is served by name."""

from functools import cache
from importlib.resources import files
from typing import NamedTuple

MEDIA_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
}
INDEX, COLOURS = "index.html", "colours.css"


class PageFile(NamedTuple):
    """The content and the media type of a file."""

    content: bytes
    media_type: str


@cache
def page_files() -> dict[str, PageFile]:
    """Return the files of the page by name, read once."""
    found = {}
    # Both pages have the same colours.
    shared = files("moseg.workflows.reports.page").joinpath(COLOURS)
    for entry in (shared, *files(__package__).joinpath("page").iterdir()):
        suffix = entry.name[entry.name.rfind(".") :]
        if suffix in MEDIA_TYPES:
            found[entry.name] = PageFile(entry.read_bytes(), MEDIA_TYPES[suffix])
    return found
