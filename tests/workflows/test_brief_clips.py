"""Many independent parts of a plan whose recipes take little time are computed by one call each."""

from moseg.schemas.recipes import Recipe
from moseg.workflows.engine.brief_clips import split_brief_clips

BRIEF = {"noise_reduction", "kernel", "score"}


def _is_brief(recipe):
    return recipe.task in BRIEF


def _recipe(task, number, *parents):
    inputs = {"leaf": f"trajectories/{number:064x}", "parents": tuple(parent.ref for parent in parents)}
    return Recipe(task=task, version=1, params={"method": task}, inputs=inputs)


def _clip(number, *kernels):
    """Return the recipes of a clip; each name of `kernels` is a task between the first recipe and the score."""
    first = _recipe("noise_reduction", number)
    between = [_recipe(name, 100 * number + place, first) for place, name in enumerate(kernels)]
    return [first, *between, _recipe("score", number, *between)]


def _plan(*clips):
    return {recipe.ref: recipe for clip in clips for recipe in clip}


def test_each_clip_is_one_call_and_each_recipe_follows_its_inputs():
    clips = [_clip(number, "kernel", "kernel") for number in range(4)]
    assert split_brief_clips(_plan(*clips), _is_brief, 4) == (clips, {})


def test_the_recipes_of_few_clips_are_left_to_all_workers():
    plan = _plan(*(_clip(number, "kernel") for number in range(4)))
    assert split_brief_clips(plan, _is_brief, 5) == ([], plan)


def test_a_part_with_one_recipe_that_takes_longer_is_left_whole():
    brief = [_clip(number, "kernel") for number in range(3)]
    long = _clip(3, "kernel", "flow")
    plan = _plan(brief[0], long, *brief[1:])
    assert split_brief_clips(plan, _is_brief, 3) == (brief, _plan(long))


def test_clips_that_share_a_recipe_are_one_part():
    shared = _recipe("noise_reduction", 0)
    scores = [_recipe("score", number, _recipe("kernel", number, shared)) for number in range(1, 3)]
    kernels = [_recipe("kernel", number, shared) for number in range(1, 3)]
    joined = [shared, *kernels, *scores]
    alone = _clip(7, "kernel")
    clips, rest = split_brief_clips(_plan(joined, alone), _is_brief, 1)
    assert clips == [joined, alone] and rest == {}


def test_recipes_of_interleaved_clips_are_told_apart():
    clips = [_clip(number, "kernel") for number in range(3)]
    plan = _plan(*zip(*clips, strict=True))
    assert split_brief_clips(plan, _is_brief, 3) == (clips, {})
