"""Strict reading of YAML files that users write: texts, lists and mappings, and one clear line for what is wrong."""

from pathlib import Path
from typing import Any, NamedTuple

import yaml

from moseg.schemas.errors import InputError, MissingInputError

_LIST, _MAPPING, _TEXT = (f"tag:yaml.org,2002:{kind}" for kind in ("seq", "map", "str"))
MAX_DEPTH = 10
"""Of lists and mappings within each other; parameters lie four deep, points of strokes nine."""


class YamlKind(NamedTuple):
    """Content of a kind of file, in the words of its errors.

    Attributes
    ----------
    name : str
        A file of the kind, ``configuration file``.
    content : str
        ``parameters``.
    layout : str
        What is expected at the top.
    max_nbytes : int
    has_dots : bool
        Whether names may have dots.
    """

    name: str
    content: str
    layout: str
    max_nbytes: int
    has_dots: bool = False


def read_yaml(path: str | Path, kind: YamlKind) -> dict[str, Any] | None:
    """Return the mapping that a file holds, None for an empty one.

    Scalars are as the file spells them: a text, or None for an empty value and for a plain null.

    Raises
    ------
    InputError
        Not UTF-8, not YAML or not a mapping; an alias, or a name twice.
    MissingInputError
        There is no such file.
    """
    text = _read_text(Path(path), kind)
    try:
        values = yaml.load(text, _DottedLoader if kind.has_dots else StrictLoader)
    except yaml.YAMLError as error:
        raise _not_yaml(error, path, kind) from error
    if values is not None and not isinstance(values, dict):
        got = "a list" if isinstance(values, list) else f"the text {str(values)[:40]!r}"
        raise InputError(f"not a {kind.name}", where=path, got=got, expected=kind.layout)
    return values


class StrictLoader(yaml.SafeLoader):
    """Reader of scalars as they are spelt, which refuses what no user's file needs: aliases, tags and names twice."""

    yaml_implicit_resolvers: dict = {}
    # Any other tag is undefined, so that it is an error of YAML, with its line.
    yaml_constructors = {tag: yaml.SafeLoader.yaml_constructors[tag] for tag in (_LIST, _MAPPING, None)}
    has_dots = False
    _depth = 0

    def compose_node(self, parent, index):
        event = self.peek_event()
        # Nested aliases expand a few lines to gigabytes.
        if isinstance(event, yaml.AliasEvent):
            raise yaml.composer.ComposerError(None, None, "an alias (*), which is not read", event.start_mark)
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise yaml.composer.ComposerError(None, None, "nested too deep", event.start_mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_mapping(self, node, deep=False):
        seen = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode) or key.tag != _TEXT:
                raise yaml.constructor.ConstructorError(None, None, "a name that is no text", key.start_mark)
            if key.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"{key.value!r} twice", key.start_mark)
            if "." in key.value and not self.has_dots:
                problem = f"{key.value!r}, a name with a dot"
                raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep=deep)

    def construct_text(self, node: yaml.ScalarNode) -> str | None:
        """Return the scalar's text; None for an empty value and for a plain null."""
        return None if node.style is None and node.value in ("", "~", "null", "Null", "NULL") else node.value


StrictLoader.add_constructor(_TEXT, StrictLoader.construct_text)


class _DottedLoader(StrictLoader):
    has_dots = True


def spell_value(value: Any) -> str:
    """Return a value in YAML, on one line."""
    plain = list(value) if isinstance(value, tuple) else value
    text = yaml.safe_dump(plain, default_flow_style=True, allow_unicode=True, width=float("inf"))
    return text.removesuffix("\n...\n").rstrip("\n")


def _read_text(path: Path, kind: YamlKind) -> str:
    expected = f"a YAML file of {kind.content}"
    try:
        if path.is_dir():
            raise InputError("a folder, not a file", where=path, expected=expected)
        if path.is_fifo():
            # Choices are checked before the work, and read again by it.
            raise InputError(f"a {kind.name} that can be read only once", where=path, got="a pipe", expected=expected)
        with path.open("rb") as file:
            content = file.read(kind.max_nbytes + 1)
    except FileNotFoundError as error:
        raise MissingInputError(f"no such {kind.name}", where=path) from error
    except OSError as error:
        raise InputError("a file that cannot be read", where=path, got=error.strerror) from error
    if len(content) > kind.max_nbytes:
        allowed = f"at most {kind.max_nbytes >> 10} KiB"
        raise InputError(f"too large for {kind.content}", where=path, expected=allowed)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        got = f"byte 0x{content[error.start]:02x} at {error.start}"
        raise InputError("not UTF-8", where=path, got=got, expected=expected) from error


def _not_yaml(error: yaml.YAMLError, path: str | Path, kind: YamlKind) -> InputError:
    mark = getattr(error, "problem_mark", None)
    where = path if mark is None else f"{path}, line {mark.line + 1}"
    problem = getattr(error, "problem", None) or getattr(error, "reason", None) or "unreadable"
    return InputError(f"not a {kind.name}", where=where, got=problem, expected=f"YAML: {kind.layout}")
