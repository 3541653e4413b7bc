"""The fused decision is right where each single view fails, as the method claims."""

import json

from moseg.workflows.cli.app import run

FAILING = {"trajs": "forward-drive-epipolar-car", "oc-depth": "slow-mover", "oc": "nothing-moves"}
"""A scene for each view that is blind to it."""


def test_fused_is_right_where_each_single_view_fails(tmp_path):
    exact = [f"--{cue}=groundtruth" for cue in ("proposals", "flow", "depth", "tracks")]
    where = [
        "--store",
        f"{tmp_path}/store",
        "--json",
        f"{tmp_path}/scores.json",
        "--sequences",
        ",".join(FAILING.values()),
    ]
    assert run(["ablate", "--quiet", *exact, *where]) == 0
    rows = json.loads((tmp_path / "scores.json").read_text())["rows"]
    scores = {row["variant"]: {name: score["F"] for name, score in row["sequences"].items()} for row in rows}
    assert scores["fused"] == dict.fromkeys(FAILING.values(), 100.0)
    for variant, scene in FAILING.items():
        assert scores[variant][scene] < 75.0
