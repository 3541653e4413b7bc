"""A task reads no parameter that its recipe does not name, under any configuration."""

import ast
import itertools
import typing
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.errors import UnnamedParameterError
from moseg.schemas.parameters import ClusteringParams, TrajectoryClusteringParams
from moseg.schemas.recipes import Recipe
from moseg.workflows import stages
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.graph.trajectory_graph import TrajectoryGraph
from moseg.workflows.graph.trajectory_leaves import TrajectoryLeaves
from moseg.workflows.stages.registry import find_task

NUM_OBJECTS, NUM_FRAMES = 4, 6
BY_METHOD = {
    *("proposal_source", "flow.method", "depth.method", "tracks.method", "cameras.method"),
    *("detections.tagger", "detections.masks", "detections.tracker"),
}
"""Choices between stages, not values that one stage reads."""


def _values(model: type, field: str) -> tuple:
    return typing.get_args(model.model_fields[field].annotation)


def _ref(task: str, number: int) -> str:
    return f"{task}/{digest_bytes('test', str(number).encode())}"


class _Artifact(SimpleNamespace):
    """Stored artifact of given arrays."""

    def array(self, name):
        return self.arrays[name]

    cached = array
    ref = "toy/1"

    def find_kept(self, name):
        """No other task has left anything."""


class _Inputs(dict):
    def all(self, role):
        return self[role]


def _run(recipe: Recipe, inputs: dict):
    params = dict(recipe.params)
    task = find_task(recipe.task, params.pop("method"))
    return task.compute(params, [_Inputs(inputs)], [np.random.default_rng(0)])[0]


def _object_inputs() -> dict:
    """Return the inputs of a clustering of a sequence of one section: affinities of two views, and tracks."""
    rng = np.random.default_rng(0)
    half = rng.random((2, NUM_OBJECTS, NUM_OBJECTS))
    views = [(affinity + affinity.T) / 4 + np.eye(NUM_OBJECTS) / 2 for affinity in half]
    owner = np.repeat(np.arange(NUM_OBJECTS), 12)
    start, steps = (
        rng.random((len(owner), 1, 2)) * 90,
        np.arange(NUM_FRAMES)[:, None] * rng.normal(size=(NUM_OBJECTS, 1, 2)),
    )
    points = (start + steps[owner] + rng.normal(scale=0.05, size=(len(owner), NUM_FRAMES, 2))).astype(np.float32)
    tracks = {"points": points, "visible": np.ones(points.shape[:2], bool), "object": owner.astype(np.uint16)}
    return {
        "affinities": [_Artifact(arrays={"affinity": view, "static_support": view[0]}) for view in views],
        "tracks": [_Artifact(arrays=tracks)],
        "linking": _Artifact(arrays={"identity": np.arange(NUM_OBJECTS, dtype=np.uint16)[None]}),
        "rigid_support": [_Artifact(arrays={"support": np.array([1.0, 0.0, 1.0, np.nan])})],
    }


CLUSTERINGS = list(
    itertools.product(
        _values(ClusteringParams, "fusion"),
        _values(ClusteringParams, "grouping"),
        _values(ClusteringParams, "auto"),
        _values(ClusteringParams, "static"),
        ("auto", "gt", 3),
        ("saliency", "groundtruth"),
        ("always", "never"),
    )
)


def test_clusterings_of_objects_read_what_their_recipes_name():
    frames = tuple(_ref("frame", number) for number in range(NUM_FRAMES))
    leaves = SequenceLeaves(
        name="toy",
        shape=(96, 96),
        frames=frames,
        num_motions=2,
        masks=_ref("masks", 0),
        motion_weights=_ref("motion_weights", 0),
    )
    inputs, done = _object_inputs(), set()
    for fusion, grouping, auto, static, motions, source, use in CLUSTERINGS:
        values = {"fusion": fusion, "grouping": grouping, "auto": auto, "static": static, "motions": motions}
        values["count"] = {"most_motions": 3, "num_samples": 5, "num_resamples": 2, "affinity": {"num_hypotheses": 20}}
        for variant in (Variant.FUSED, Variant.OC):
            config = PipelineConfig(proposal_source=source, clustering=values, rigid_support={"use": use})
            graph = SequenceGraph(leaves, config)
            recipe = graph.recipes[graph.clustering(variant)]
            question = (str(recipe.params), *recipe.inputs)
            if question not in done:
                done.add(question)
                views = inputs["affinities"][: len(recipe.inputs["affinities"])]
                _run(recipe, {role: inputs[role] for role in recipe.inputs} | {"affinities": views})
    assert len(done) > 100
    assert sum("rigid_support" in question for question in done) > 40


def test_clusterings_of_trajectories_read_what_their_recipes_name():
    rng = np.random.default_rng(1)
    points = (rng.random((14, 1, 2)) * 400 + rng.random((14, NUM_FRAMES, 2))).astype(np.float64)
    kernel = np.exp(-rng.random((2, 14, 14))).astype(np.float32)
    kernels = _Artifact(arrays={"kernel": kernel + kernel.transpose(0, 2, 1)})
    clip = _Artifact(arrays={"points": points, "visible": np.ones((14, NUM_FRAMES), bool), "stray": np.zeros(14, bool)})
    leaves = TrajectoryLeaves(name="toy", trajectories=_ref("trajectories", 0), labels=_ref("labels", 0), num_motions=2)
    drawn: dict[str, _Artifact] = {}
    fields, done = ("method", "auto"), set()
    choices = itertools.product(*(_values(TrajectoryClusteringParams, field) for field in fields), (True, False))
    for (method, auto, separate), motions in itertools.product(choices, ("auto", "gt")):
        config = PipelineConfig(
            clustering={"motions": motions},
            hypotheses={"num_draws": 2},
            trajectory_clustering={
                "method": method,
                "auto": auto,
                "separate": separate,
                "most_motions": 2,
                "num_starts": 1,
                "count": {"num_samples": 5},
                "pieces": {"counts": (4,), "num_tried": 1},
            },
        )
        for variant in (TrajectoryVariant.FUSED, TrajectoryVariant.TRAJS):
            graph = TrajectoryGraph(leaves, config)
            recipe = graph.recipes[graph.clustering(variant)]
            clustering = recipe.params["clustering"]
            # Published methods have one grouping, so that `stability` has nothing to compare and is rejected.
            is_refused = clustering.get("auto") == "stability" and clustering["method"] != "energy"
            if not is_refused and str(recipe.params) not in done:
                done.add(str(recipe.params))
                for ref in recipe.inputs["hypotheses"]:
                    if ref not in drawn:
                        made = _run(graph.recipes[ref], {"trajectories": clip})
                        drawn[ref] = _Artifact(arrays=made.arrays, attributes=made.attributes)
                hypotheses = [drawn[ref] for ref in recipe.inputs["hypotheses"]]
                models = [kernels] * len(recipe.inputs["kernels"])
                _run(recipe, {"hypotheses": hypotheses, "kernels": models, "trajectories": clip})
    assert len(done) > 30


def _choices(model: type, prefix: str = "") -> dict[str, tuple]:
    """Return the values of every field that has a few, by the name in ``--set``."""
    found: dict[str, tuple] = {}
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and hasattr(field.annotation, "model_fields"):
            found |= _choices(field.annotation, f"{prefix}{name}.")
        elif declared := [each for each in field.metadata if isinstance(each, ChoiceOf)]:
            found[prefix + name] = declared[0].names
        elif typing.get_origin(field.annotation) is typing.Literal:
            found[prefix + name] = typing.get_args(field.annotation)
        elif field.annotation is bool:
            found[prefix + name] = (True, False)
    return {name: values for name, values in found.items() if name not in BY_METHOD}


NUM_RUNS = max(len(values) for values in _choices(PipelineConfig).values())


def _settings(number: int) -> list[str]:
    """Return one value of each field; over all runs each value occurs at least once, in different combinations."""
    chosen = []
    for place, (name, values) in enumerate(_choices(PipelineConfig).items()):
        chosen += ["--set", f"{name}={values[(number + place * (number // len(values))) % len(values)]}"]
    return chosen


def test_every_value_is_part_of_some_run():
    for place, (name, values) in enumerate(_choices(PipelineConfig).items()):
        met = {values[(number + place * (number // len(values))) % len(values)] for number in range(NUM_RUNS)}
        assert met == set(values), name


@pytest.mark.parametrize("number", range(NUM_RUNS))
def test_whole_runs_read_what_their_recipes_name(number, moseg, squares, tmp_path):
    source = ("--proposals", "groundtruth") if number % 2 else ()
    given = ("--root", squares, "--store", tmp_path / "store", "--quiet", "--section-length", "5")
    # A network of the video's own need not learn anything here.
    given += ("--set", "video_network.steps=2")
    ran = moseg("ablate", "--dataset", "folder", *given, *source, *_settings(number))
    assert ran.code == 0, ran.err


def test_stages_build_their_parameters_from_recipes_alone():
    for path in sorted(Path(stages.__file__).parent.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert not node.func.id.endswith("Params"), f"{path.name}:{node.lineno}: take {node.func.id}.of_recipe"


def test_a_stage_that_reads_more_is_found():
    recipe = Recipe(
        task="clustering",
        version=1,
        params={"method": "motion-groups", "num_motions": None, "clustering": {"auto": "threshold", "static": "group"}},
    )
    inputs = _object_inputs()
    with pytest.raises(UnnamedParameterError, match="threshold"):
        _run(recipe, inputs)
    del inputs["rigid_support"]
    with pytest.raises(UnnamedParameterError, match="fusion"):
        _run(recipe, inputs)
