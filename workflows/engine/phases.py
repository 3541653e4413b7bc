"""Parts of a plan that run one after the other, so that a worker holds one network at a time."""

from collections.abc import Callable, Iterable, Iterator, Mapping

from moseg.schemas.digests import canonical_json
from moseg.schemas.recipes import Recipe


def split_phases(compute: Mapping[str, Recipe]) -> list[dict[str, Recipe]]:
    """Cut a plan where another network is needed.

    A phase takes all that can be computed without a network or with the one network of the phase; then the next
    network follows, in the order in which the plan first names them. So each network is loaded once a phase on a
    worker, where the plan's own order would change networks with every frame.

    Parameters
    ----------
    compute : dict of reference to recipe
        Misses, in an order in which each follows its inputs.

    Returns
    -------
    list of dict of reference to recipe
        They hold every recipe once, each after its inputs; at most one network works in each.
    """
    waiting = dict(compute)
    phases = []
    while waiting:
        kind = None
        taken: dict[str, Recipe] = {}
        held: set[str] = set()
        for ref, recipe in waiting.items():
            needed = network_of(recipe)
            is_ready = not any(parent in held for parent in recipe.input_refs())
            if is_ready and needed is not None and kind is None:
                kind = needed
            if is_ready and needed in (None, kind):
                taken[ref] = recipe
            else:
                held.add(ref)
        waiting = {ref: recipe for ref, recipe in waiting.items() if ref in held}
        phases.append(taken)
    return phases


def network_of(recipe: Recipe) -> tuple[str, str] | None:
    """The network that computes a recipe, as its weights and the stage; None for one that needs no weights."""
    weights = recipe.inputs.get("weights")
    return (str(weights), recipe.task) if weights is not None else None


def batch_recipes(recipes: Mapping[str, Recipe], size: Callable[[Recipe], int]) -> Iterator[list[Recipe]]:
    """Recipes that one call computes: at most `size` of those that differ in nothing but what they read.

    A recipe that reads another one's result is alone. Calls follow those that they wait for.
    """
    groups: dict[object, list[Recipe]] = {}
    for ref, recipe in recipes.items():
        is_alone = size(recipe) == 1 or any(parent in recipes for parent in recipe.input_refs())
        kind = (recipe.task, recipe.version, canonical_json(recipe.params), recipe.inputs.get("weights"))
        groups.setdefault(ref if is_alone else kind, []).append(recipe)
    for group in groups.values():
        step = size(group[0])
        for start in range(0, len(group), step):
            yield group[start : start + step]


def join_brief(
    batches: Iterable[list[Recipe]], is_brief: Callable[[Recipe], bool], most: int
) -> Iterator[list[list[Recipe]]]:
    """Batches that one call computes one after the other.

    Up to `most` brief ones that follow each other are joined, any other batch is alone. Where the plan goes from frame
    to frame, a call so goes through neighbouring frames, whose images and flows then stay in its process. Calls follow
    those that they wait for as long as the batches do.
    """
    joined: list[list[Recipe]] = []
    for batch in batches:
        if not is_brief(batch[0]):
            if joined:
                yield joined
                joined = []
            yield [batch]
            continue
        joined.append(batch)
        if len(joined) == most:
            yield joined
            joined = []
    if joined:
        yield joined
