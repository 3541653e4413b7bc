"""Phases: parts of a plan that run one after the other, so that a worker holds one network at a time."""

from collections.abc import Mapping

from moseg.schemas.recipes import Recipe


def split_phases(compute: Mapping[str, Recipe]) -> list[dict[str, Recipe]]:
    """Split a plan where another network is needed.

    A phase takes all that can be computed without a network or with the one network of the phase; then the next
    network follows, in the order in which the plan first names them. So each worker loads each network once a phase;
    in the plan's own order the network would change with every frame.

    Parameters
    ----------
    compute : dict of reference to recipe
        Misses, in an order in which each follows its inputs.

    Returns
    -------
    list of dict of reference to recipe
        They hold every recipe once, each after its inputs, and at most one network each.
    """
    waiting = dict(compute)
    phases = []
    while waiting:
        network = None
        taken: dict[str, Recipe] = {}
        held: set[str] = set()
        for ref, recipe in waiting.items():
            needed = network_of(recipe)
            is_ready = not any(parent in held for parent in recipe.input_refs())
            if is_ready and needed is not None and network is None:
                network = needed
            if is_ready and needed in (None, network):
                taken[ref] = recipe
            else:
                held.add(ref)
        waiting = {ref: recipe for ref, recipe in waiting.items() if ref in held}
        phases.append(taken)
    return phases


def network_of(recipe: Recipe) -> tuple[str, str] | None:
    """Return the network that computes a recipe, as its weights and the stage, or None if it needs no weights."""
    weights = recipe.inputs.get("weights")
    return (str(weights), recipe.task) if weights is not None else None
