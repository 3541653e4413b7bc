"""Cues: dense maps that results are computed from, large on the disk and cheap to compute again."""

from collections.abc import Iterable, Mapping

from moseg.schemas.recipes import Recipe
from moseg.workflows.stages.registry import find_task


def split_cues(recipes: Mapping[str, Recipe], results: Iterable[str]) -> tuple[list[str], list[str]]:
    """Split results and all that they are computed from into what is kept and cues.

    Parameters
    ----------
    recipes : mapping of reference to recipe
        References without a recipe are leaves, which are kept.
    results : iterable of references

    Returns
    -------
    kept, cues : list of references
        Of both, the results first.
    """
    kept: list[str] = []
    cues: list[str] = []
    waiting = list(dict.fromkeys(results))
    entered = set(waiting)
    for ref in waiting:
        recipe = recipes.get(ref)
        if recipe is None:
            kept.append(ref)
            continue
        (cues if is_cue(recipe) else kept).append(ref)
        new = [parent for parent in dict.fromkeys(recipe.input_refs()) if parent not in entered]
        entered.update(new)
        # the loop goes on through what is added here
        waiting.extend(new)
    return kept, cues


def cues_behind(recipes: Mapping[str, Recipe], results: Iterable[str]) -> list[str]:
    """Return the cues among results and all that they are computed from; see `split_cues`."""
    return split_cues(recipes, results)[1]


def is_cue(recipe: Recipe) -> bool:
    """Return whether a recipe computes a cue."""
    return find_task(recipe.task, recipe.params["method"]).is_cue
