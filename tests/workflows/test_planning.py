"""A plan walks from the sinks and stops at stored artifacts."""

from types import SimpleNamespace

from hypothesis import given
from hypothesis import strategies as st

from moseg.schemas.recipes import Recipe
from moseg.workflows.engine.planning import make_plan

LEAF = f"frame/{'0' * 64}"


class Graph:
    """Graph of toy recipes; node `n` reads the nodes of `inputs[n]`, or a leaf if it reads none."""

    def __init__(self, inputs):
        self.refs, self.recipes = [], {}
        for number, parents in enumerate(inputs):
            refs = tuple(self.refs[parent] for parent in parents)
            recipe = Recipe(task="toy", version=1, params={"number": number}, inputs={"of": refs or LEAF})
            self.refs.append(recipe.ref)
            self.recipes[recipe.ref] = recipe

    def plan(self, stored, sinks):
        store = SimpleNamespace(present={self.refs[number] for number in stored}.intersection)
        plan = make_plan(store, self.recipes, [self.refs[number] for number in sinks])
        return [self.refs.index(ref) for ref in plan.compute], sorted(self.refs.index(ref) for ref in plan.reuse), plan


def _missing_and_needed(inputs, stored, sinks):
    """Return the nodes that a plan must compute, by definition: missing sinks, and missing nodes that they read."""
    needed = set()
    for number in reversed(range(len(inputs))):
        is_read = any(number in inputs[other] for other in needed)
        if number not in stored and (number in sinks or is_read):
            needed.add(number)
    return needed


@st.composite
def _cases(draw):
    size = draw(st.integers(1, 12))
    inputs = [sorted(draw(st.sets(st.integers(0, n - 1), max_size=3))) if n else [] for n in range(size)]
    numbers = st.sets(st.integers(0, size - 1))
    return inputs, draw(numbers), sorted(draw(numbers))


@given(_cases())
def test_exactly_the_missing_and_needed_nodes_are_computed(case):
    inputs, stored, sinks = case
    compute, _, _ = Graph(inputs).plan(stored, sinks)
    assert len(compute) == len(set(compute))
    assert set(compute) == _missing_and_needed(inputs, stored, sinks)


@given(_cases())
def test_each_node_follows_its_inputs(case):
    inputs, stored, sinks = case
    compute, _, _ = Graph(inputs).plan(stored, sinks)
    for position, number in enumerate(compute):
        assert {parent for parent in inputs[number] if parent not in stored} <= set(compute[:position])


@given(_cases())
def test_reused_are_the_inputs_of_sinks_and_misses_and_nothing_below(case):
    inputs, stored, sinks = case
    compute, reuse, _ = Graph(inputs).plan(stored, sinks)
    read = set(sinks).union(*(inputs[number] for number in compute))
    assert set(reuse) == read & stored


@given(_cases())
def test_a_warm_plan_stops_at_its_sinks(case):
    inputs, _, sinks = case
    compute, reuse, plan = Graph(inputs).plan(range(len(inputs)), sinks)
    assert compute == []
    assert reuse == sinks
    assert plan.touched() == set(plan.reuse)


@given(_cases(), st.data())
def test_dropping_one_artifact_recomputes_it_only_where_it_is_needed(case, data):
    inputs, _, sinks = case
    dropped = data.draw(st.integers(0, len(inputs) - 1))
    compute, _, _ = Graph(inputs).plan(set(range(len(inputs))) - {dropped}, sinks)
    assert compute == ([dropped] if dropped in sinks else [])


def test_only_the_path_to_a_dropped_artifact_is_recomputed():
    #   0 -> 1 -> 3 -> 4
    #   0 -> 2 ---^
    inputs = [[], [0], [0], [1, 2], [3]]
    compute, reuse, plan = Graph(inputs).plan({0, 2}, [4])
    assert compute == [1, 3, 4]
    assert reuse == [0, 2]
    assert plan.count() == ({"toy": 3}, {"toy": 2})


def test_leaves_are_neither_computed_nor_counted_but_kept():
    compute, reuse, plan = Graph([[]]).plan(set(), [0])
    assert (compute, reuse) == ([0], [])
    assert LEAF in plan.touched()


def test_no_node_below_a_stored_sink_is_looked_up():
    asked = []
    graph = Graph([[], [0], [1], [0, 1]])

    def present(refs):
        asked.append(list(refs))
        return {graph.refs[2]}.intersection(refs)

    make_plan(SimpleNamespace(present=present), graph.recipes, [graph.refs[2]])
    assert asked == [[graph.refs[2]]]


def test_the_nodes_of_one_step_are_looked_up_in_one_request():
    asked = []
    graph = Graph([[], [], [0, 1], [0, 1]])

    def present(refs):
        asked.append(list(refs))
        return set()

    make_plan(SimpleNamespace(present=present), graph.recipes, [graph.refs[2], graph.refs[3]])
    assert asked == [[graph.refs[2], graph.refs[3]], [graph.refs[0], graph.refs[1]]]
