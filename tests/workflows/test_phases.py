"""A plan is divided so that every network is loaded once and computes several frames in a call."""

from moseg.schemas.recipes import Recipe
from moseg.workflows.engine.calls import batch_cheap, batch_recipes
from moseg.workflows.engine.phases import network_of, split_phases

WEIGHTS = {name: f"weights/{digit * 64}" for name, digit in (("raft", "a"), ("depth", "b"), ("deaot", "c"))}


def _recipe(task, number, weights=None, **inputs):
    if weights is not None:
        inputs["weights"] = WEIGHTS[weights]
    return Recipe(task=task, version=1, params={"method": task}, inputs={"frame": f"frame/{number:064x}", **inputs})


def _plan(*recipes):
    return {recipe.ref: recipe for recipe in recipes}


def _video(num_frames):
    """Return recipes of flow, depth and a fit of both for every frame, in the order of a walk from the fits down."""
    recipes = []
    for number in range(num_frames):
        flow, depth = _recipe("flow", number, "raft"), _recipe("depth", number, "depth")
        recipes += [flow, depth, _recipe("flow_model", number, flow=flow.ref, depth=depth.ref)]
    return _plan(*recipes)


def _chain(num_sections):
    """Return recipes of sections that start from the objects tracked into them."""
    recipes, tracked = [], {}
    for number in range(num_sections):
        found = _recipe("instances", number, "depth")
        seeds = _recipe("seeds", number, found=found.ref, **tracked)
        masks = _recipe("proposals", number, "deaot", seeds=seeds.ref)
        tracked = {"tracked": masks.ref}
        recipes += [found, seeds, masks]
    return _plan(*recipes)


def test_each_network_works_in_one_phase():
    phases = split_phases(_video(6))
    networks = [{network_of(recipe) for recipe in phase.values()} - {None} for phase in phases]
    assert networks == [{(WEIGHTS["raft"], "flow")}, {(WEIGHTS["depth"], "depth")}]


def test_a_chain_of_sections_runs_in_one_phase_of_its_tracker():
    phases = split_phases(_chain(5))
    assert [sorted({recipe.task for recipe in phase.values()}) for phase in phases] == [
        ["instances", "seeds"],
        ["proposals", "seeds"],
    ]


def test_phases_hold_every_recipe_once_and_after_its_inputs():
    for plan in (_video(4), _chain(4)):
        order = [ref for phase in split_phases(plan) for ref in phase]
        assert sorted(order) == sorted(plan)
        for ref, recipe in plan.items():
            assert all(order.index(parent) < order.index(ref) for parent in recipe.input_refs() if parent in plan)


def test_a_plan_without_networks_is_one_phase():
    plan = _plan(*(_recipe("saliency", number) for number in range(3)))
    assert split_phases(plan) == [plan]


def test_frames_of_a_network_share_a_call():
    (flows, *_) = split_phases(_plan(*(_recipe("flow", number, "raft") for number in range(5))))
    batches = list(batch_recipes(flows, lambda recipe: 2))
    assert [len(batch) for batch in batches] == [2, 2, 1]
    assert [recipe.ref for batch in batches for recipe in batch] == list(flows)


def test_a_recipe_that_waits_for_another_is_computed_alone():
    plan = _chain(3)
    batches = [[recipe.task for recipe in batch] for batch in batch_recipes(plan, lambda recipe: 8)]
    assert batches == [["instances"] * 3, *[["seeds"], ["proposals"]] * 3]


def test_recipes_of_other_parameters_form_another_batch():
    fast = Recipe(
        task="flow", version=1, params={"method": "raft", "iterations": 4}, inputs={"weights": WEIGHTS["raft"]}
    )
    slow = Recipe(
        task="flow", version=1, params={"method": "raft", "iterations": 9}, inputs={"weights": WEIGHTS["raft"]}
    )
    assert len(list(batch_recipes(_plan(fast, slow), lambda recipe: 8))) == 2


def _join(plan, max_batches):
    batches = [[recipe] for recipe in plan.values()]
    return list(batch_cheap(batches, lambda recipe: recipe.task in ("flow", "saliency"), max_batches))


def test_cheap_recipes_that_follow_each_other_share_a_call():
    flows = [_recipe("flow", number) for number in range(5)]
    proposals = _recipe("proposals", 0, flow=flows[0].ref)
    joined = _join(_plan(*flows[:3], proposals, *flows[3:]), 2)
    tasks = [[recipe.task for (recipe,) in batches] for batches in joined]
    assert tasks == [["flow", "flow"], ["flow"], ["proposals"], ["flow", "flow"]]


def test_batched_calls_hold_every_recipe_once_and_after_its_inputs():
    recipes = []
    for number in range(7):
        flow = _recipe("flow", number)
        saliency = _recipe("saliency", number, flow=flow.ref)
        recipes += [flow, saliency, *([_recipe("proposals", number, saliency=saliency.ref)] if number % 3 == 2 else [])]
    plan = _plan(*recipes)
    assert [recipe.ref for batches in _join(plan, 4) for (recipe,) in batches] == list(plan)
