"""A recipe: the sentence whose digest is an artifact's key."""

from functools import cached_property
from typing import Annotated

from pydantic import JsonValue, StringConstraints

from schemas.digests import digest_json
from schemas.frozen import Frozen

TaskName = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]{0,63}$")]
Ref = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]{0,63}/[0-9a-f]{64}$")]
"""``<task>/<key>``: where an artifact lies, and what it is."""


class Recipe(Frozen):
    """Task name, task version, the parameters that the task reads and the references of its inputs.

    Attributes
    ----------
    task : str
        Lower-case name of the task.
    version : int
        Version of the task's code.
    params : dict of JSON values
        Only what the task reads: anything else would split equal work.
    inputs : dict of reference or list of references
        Each input by its role. Order matters inside a list.
    """

    task: TaskName
    version: int
    params: dict[str, JsonValue] = {}
    inputs: dict[str, Ref | tuple[Ref, ...]] = {}

    @cached_property
    def key(self) -> str:
        """BLAKE2b-256 of the recipe's canonical JSON, hexadecimal."""
        return digest_json("recipe", [self.task, self.version, self.params, self.inputs])

    @cached_property
    def ref(self) -> str:
        """``<task>/<key>``."""
        return f"{self.task}/{self.key}"

    def input_refs(self) -> tuple[str, ...]:
        """Every input reference, flat, in the order of the roles."""
        flat = []
        for value in self.inputs.values():
            flat.extend([value] if isinstance(value, str) else value)
        return tuple(flat)


def leaf_recipe(task: str, content_digest: str) -> Recipe:
    """Recipe of data that came from outside: its content's digest is its only parameter."""
    return Recipe(task=task, version=1, params={"content": content_digest})


def split_ref(ref: str) -> tuple[str, str]:
    """Task name and key of a reference."""
    task, _, key = ref.partition("/")
    return task, key
