"""What a maker of tiny checkpoints returns."""

from typing import Any, NamedTuple


class TinyCheckpoint(NamedTuple):
    """Files by name, in the published network's format, and the sizes in which an own module differs from it."""

    files: dict[str, bytes]
    config: dict[str, Any] = {}
