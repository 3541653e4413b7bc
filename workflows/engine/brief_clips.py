"""Brief clips: independent parts of a plan that one call each computes, because their recipes take little time."""

from collections.abc import Callable, Mapping

from moseg.schemas.recipes import Recipe


def split_brief_clips(
    recipes: Mapping[str, Recipe], is_brief: Callable[[Recipe], bool], min_clips: int
) -> tuple[list[list[Recipe]], dict[str, Recipe]]:
    """Split a plan into clips, each of which one call computes, and the rest.

    A clip is a part of the plan that neither reads results of the rest nor is read by it, and of which every recipe is
    brief. One call for it saves the scheduler's time, and later recipes find what earlier ones have kept in the same
    process. With fewer clips than `min_clips` there are none: their recipes are then divided among the workers.

    Parameters
    ----------
    recipes : mapping of reference to recipe
        In an order in which each follows its inputs.
    is_brief : function of a recipe
    min_clips : int
        Number of clips with which no worker is without work for long, although each call takes a whole clip.

    Returns
    -------
    clips : list of list of Recipe
        In the order of their first recipes; within a clip each recipe follows its inputs.
    rest : dict of reference to recipe
        In the order of the plan.
    """
    if not any(map(is_brief, recipes.values())):
        return [], dict(recipes)
    clips = [part for part in _independent_parts(recipes) if all(map(is_brief, part))]
    if len(clips) < min_clips:
        return [], dict(recipes)
    taken = {recipe.ref for clip in clips for recipe in clip}
    return clips, {ref: recipe for ref, recipe in recipes.items() if ref not in taken}


def _independent_parts(recipes: Mapping[str, Recipe]) -> list[list[Recipe]]:
    """Return the parts of a plan that read no results of each other."""
    above: dict[str, str] = {}

    def find(ref: str) -> str:
        while (parent := above.setdefault(ref, ref)) != ref:
            above[ref] = ref = above[parent]
        return ref

    for ref, recipe in recipes.items():
        for parent in recipe.input_refs():
            if parent in recipes:
                above[find(parent)] = find(ref)
    parts: dict[str, list[Recipe]] = {}
    for ref, recipe in recipes.items():
        parts.setdefault(find(ref), []).append(recipe)
    return list(parts.values())
