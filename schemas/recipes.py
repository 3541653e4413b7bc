"""Recipes: the descriptions of computations whose digests are the keys of artifacts."""

from collections.abc import Mapping
from functools import cached_property
from typing import Annotated

from pydantic import JsonValue, StringConstraints, TypeAdapter

from moseg.schemas.digests import canonical_json, digest_bytes
from moseg.schemas.frozen import Frozen

TaskName = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]{0,63}$")]
Ref = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]{0,63}/[0-9a-f]{64}$")]
"""``<task>/<key>``: identity and place of an artifact."""

_INPUTS = TypeAdapter(dict[str, Ref | tuple[Ref, ...]])


class Recipe(Frozen):
    """Task name, task version, the parameters that the task reads and the references of its inputs.

    Attributes
    ----------
    task : str
        Lower-case name of the task.
    version : int
        Version of the task's code.
    params : dict of JSON values
        Only the parameters that the task reads: others would give equal computations different keys.
    inputs : dict of reference or list of references
        References by role. The order inside a list matters.
    """

    task: TaskName
    version: int
    params: dict[str, JsonValue] = {}
    inputs: dict[str, Ref | tuple[Ref, ...]] = {}

    def about(self, inputs: Mapping[str, str | tuple[str, ...]]) -> "Recipe":
        """Return the same recipe with other inputs; the rest is shared, without checks and encoding.

        For the thousands of nodes of a plan that only differ in their inputs.
        """
        recipe = Recipe.model_construct(
            task=self.task, version=self.version, params=self.params, inputs=_INPUTS.validate_python(inputs)
        )
        recipe.__dict__["head"] = self.head
        return recipe

    @cached_property
    def head(self) -> bytes:
        """Canonical JSON list of task, version and parameters, without the closing bracket."""
        return canonical_json([self.task, self.version, self.params])[:-1]

    @cached_property
    def key(self) -> str:
        """BLAKE2b-256 of the canonical JSON of task, version, parameters and inputs, hexadecimal."""
        return digest_bytes("recipe", b"".join([self.head, b",", _encode_inputs(self.inputs), b"]"]))

    @cached_property
    def ref(self) -> str:
        """``<task>/<key>``."""
        return f"{self.task}/{self.key}"

    def input_refs(self) -> tuple[str, ...]:
        """Return all input references in the order of the roles."""
        flat = []
        for value in self.inputs.values():
            flat.extend([value] if isinstance(value, str) else value)
        return tuple(flat)


def _encode_inputs(inputs: Mapping[str, str | tuple[str, ...]]) -> bytes:
    """Return the canonical JSON of inputs, in a third of the time: references need no escapes."""
    parts = []
    for role in sorted(inputs):
        value = inputs[role]
        listed = f'"{value}"' if isinstance(value, str) else "[" + ",".join([f'"{ref}"' for ref in value]) + "]"
        parts.append(f"{canonical_json(role).decode()}:{listed}" if not role.isidentifier() else f'"{role}":{listed}')
    return ("{" + ",".join(parts) + "}").encode()


def leaf_recipe(task: str, content_digest: str) -> Recipe:
    """Return the recipe of external data: the digest of the content is its only parameter."""
    return Recipe(task=task, version=1, params={"content": content_digest})


def split_ref(ref: str) -> tuple[str, str]:
    """Return the task name and the key of a reference."""
    task, _, key = ref.partition("/")
    return task, key
