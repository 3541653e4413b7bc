"""Plans: which of a graph's nodes must be computed, and which stored artifacts they build on."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from moseg.schemas.recipes import Recipe, split_ref
from moseg.store import ArtifactStore


class Plan(NamedTuple):
    """Nodes to compute, inputs before outputs, and the hits at which the walk ended.

    Attributes
    ----------
    compute : dict of reference to recipe
        Misses, in an order in which each follows its inputs.
    reuse : tuple of references
        Stored artifacts that a sink or a miss reads; their own inputs are not looked up.
    """

    compute: dict[str, Recipe]
    reuse: tuple[str, ...]

    def touched(self) -> set[str]:
        """Return every artifact that the execution of the plan reads or writes."""
        inputs = (parent for recipe in self.compute.values() for parent in recipe.input_refs())
        return {*self.compute, *self.reuse, *inputs}

    def count(self) -> tuple[Counter[str], Counter[str]]:
        """Count artifacts to compute and to reuse, by stage; leaves are not counted."""
        computed = Counter(split_ref(ref)[0] for ref in self.compute)
        return computed, Counter(split_ref(ref)[0] for ref in self.reuse)


def make_plan(store: ArtifactStore, recipes: Mapping[str, Recipe], sinks: Iterable[str]) -> Plan:
    """Walk from the sinks towards the leaves, stop at every stored artifact, and return the plan.

    References without a recipe are leaves: ingest has stored them, so they are neither computed nor counted.
    """
    ends = [ref for ref in dict.fromkeys(sinks) if ref in recipes]
    stored = _look_up(store, recipes, ends)
    compute: dict[str, Recipe] = {}
    reuse: dict[str, None] = {}
    entered: set[str] = set()
    stack = [(ref, False) for ref in reversed(ends)]
    while stack:
        ref, inputs_done = stack.pop()
        if inputs_done:
            compute[ref] = recipes[ref]
            continue
        if ref in entered or ref not in recipes:
            continue
        entered.add(ref)
        if ref in stored:
            reuse[ref] = None
            continue
        stack.append((ref, True))
        stack.extend((parent, False) for parent in reversed(recipes[ref].input_refs()))
    return Plan(compute, tuple(reuse))


def _look_up(store: ArtifactStore, recipes: Mapping[str, Recipe], ends: Sequence[str]) -> set[str]:
    """Return the stored ones of all artifacts on a walk from `ends`; a step towards the leaves is one request to the
    store, which may be remote."""
    stored: set[str] = set()
    met: set[str] = set()
    step = list(ends)
    while step:
        met.update(step)
        hits = store.present(step)
        stored |= hits
        parents = (parent for ref in step if ref not in hits for parent in recipes[ref].input_refs())
        step = [parent for parent in dict.fromkeys(parents) if parent in recipes and parent not in met]
    return stored
