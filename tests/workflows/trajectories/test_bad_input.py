"""Bad use of labelled trajectories ends with exit code 2 and one clear line, before any work."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat, savemat

pytestmark = pytest.mark.usefixtures("in_empty_folder")


def _assert_refused(ran, *words):
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert line.startswith("moseg: ")
    for word in words:
        assert str(word) in line
    assert not Path(".moseg").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("eval --variant oc", ("--variant", "oc", "fused or trajs or homography or affine")),
        ("plan --variant base", ("--variant", "base")),
        ("eval --variant homograph", ("--variant",)),
        ("eval --proposals saliency", ("--proposals", "without images")),
        ("eval --depth none", ("--depth",)),
        ("eval --flow dis", ("--flow",)),
        ("eval --tracks lucas-kanade", ("--tracks",)),
        ("eval --affinity ork", ("--affinity",)),
        ("eval --section-length 4", ("--section-length",)),
        ("eval --sensitivity 2", ("--sensitivity",)),
        ("ablate --preset paper", ("--preset",)),
        ("plan --quality fast", ("--quality",)),
        ("eval --geometry paper", ("--geometry",)),
        ("eval --set flow.preset=fine", ("flow.preset", "hypotheses")),
        ("eval --set clustering.fusion=sum", ("clustering.fusion", "trajectory_clustering")),
        ("eval --set hypotheses.gaps=0", ("hypotheses.gaps",)),
        ("eval --set hypotheses.gaps=1,1", ("hypotheses.gaps",)),
        (
            "eval --set trajectory_clustering.energy.gaps=3,3",
            ("trajectory_clustering.energy.gaps", "different numbers"),
        ),
        ("eval --set kernel.window=2", ("kernel.window",)),
        ("eval --views affine,homographie", ("--views", "homographie", "fundamental")),
        ("eval --views affine,affine", ("--views",)),
        ("eval --views oc_depth", ("--views", "oc_depth")),
        ("eval --set fused_point_models=oc_depth", ("fused_point_models",)),
        ("eval --set fused_point_models=affine,affine", ("fused_point_models", "different models")),
        ("eval --seed 1 --seeds 2", ("--seed", "--seeds 2")),
        ("eval --seed 1 --set hypotheses.seed=2", ("two choices in --seed", "--set hypotheses.seed=2 too")),
        ("plan --seeds 2 --set hypotheses.seed=2", ("two choices in --seeds", "--set hypotheses.seed=2 too")),
        ("eval --motions 3 --set clustering.motions=4", ("two choices in --motions", "clustering.motions=4 too")),
        (
            "eval --views affine --variant trajs --variant homography",
            ("--views", "--variant trajs,homography", "fused"),
        ),
        (
            "eval --motions auto --variant fused --variant trajs --set trajectory_clustering.auto=stability",
            ("too few draws", "variant trajs", "spectrally"),
        ),
        (
            "plan --motions auto --set trajectory_clustering.auto=stability --set hypotheses.num_draws=1",
            ("too few draws", "num_draws=1"),
        ),
        ("eval --seeds 0", ("--seeds",)),
        ("eval --seed -1", ("--seed",)),
        ("eval --motions 0", ("clustering.motions",)),
        ("eval --sequences Seq005_Clip09", ("Seq005_Clip09", "Seq005_Clip0")),
        ("contact-sheet", ("no frames", "kt3dmoseg")),
    ],
)
def test_what_means_nothing_on_trajectories_is_refused(moseg, clips, arguments, words):
    command, *options = arguments.split()
    _assert_refused(moseg(command, "--dataset", "kt3dmoseg", "--root", clips, *options), *words)


def test_masks_are_not_scored_against_trajectories(moseg, clips, write_image, tmp_path):
    write_image(tmp_path / "masks" / "Seq005_Clip01" / "00000.png", np.zeros((8, 8), np.uint8))
    options = ("--predictions", tmp_path / "masks")
    _assert_refused(moseg("score", "--dataset", "kt3dmoseg", "--root", clips, *options), "no frames", "kt3dmoseg")


@pytest.mark.parametrize("option", ["--seeds", "--seed", "--views"])
@pytest.mark.parametrize("command", ["eval", "ablate", "plan"])
def test_what_means_nothing_on_frames_is_refused(moseg, command, option):
    value = "affine" if option == "--views" else "2"
    _assert_refused(moseg(command, option, value), option, "synthetic", "kt3dmoseg")


def test_variants_of_trajectories_are_none_of_frames(moseg):
    _assert_refused(moseg("eval", "--variant", "homography"), "--variant", "homography", "oc-depth")


@pytest.mark.parametrize("damage", [b"", b"not MATLAB's", None])
def test_a_damaged_clip_is_named(moseg, write_clip, tmp_path, damage):
    path = write_clip(tmp_path / "data" / "Seq005_Clip01_Tracks.mat")
    path.write_bytes(path.read_bytes()[:3000] if damage is None else damage)
    ran = moseg("eval", "--dataset", "kt3dmoseg", "--root", tmp_path / "data", "--quiet", "--store", tmp_path / "store")
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert str(path) in line


@pytest.mark.parametrize("num_workers", [0, 2])
def test_a_clip_that_cannot_be_grouped_is_named(moseg, write_clip, tmp_path, num_workers):
    for seed, name in enumerate(("Seq005_Clip01", "Seq005_Clip02", "Seq028_clip03")):
        path = write_clip(tmp_path / f"{name}_Tracks.mat", seed, hidden=0.0)
        if seed == 1:
            data = loadmat(path, simplify_cells=True)["Data"]
            few = {"ySparse": data["ySparse"][:, :5], "visibleSparse": data["visibleSparse"][:5]}
            savemat(path, {"Data": {**few, "GtLabel": data["GtLabel"][:5, None]}})
    ran = moseg("eval", "--dataset", "kt3dmoseg", "--root", tmp_path, "--quiet", "--workers", num_workers)
    assert ran.code == 2 and ran.err.count("\n") == 1
    assert "model in sequence Seq005_Clip02; got 5 in 6 frames" in ran.err


def test_an_option_and_a_setting_of_trajectories_may_give_the_same_value(moseg, clips, tmp_path):
    both = ("--views", "affine,homography", "--set", "fused_point_models=[affine, homography]")
    both += ("--seed", "1", "--set", "hypotheses.seed=1")
    data = ("--dataset", "kt3dmoseg", "--root", clips, "--store", tmp_path / "store")
    assert moseg("plan", *data, *both).code == 0
