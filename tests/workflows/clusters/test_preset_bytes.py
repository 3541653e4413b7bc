"""Presets with networks give the same bytes in one process, in two workers, and on a cluster of one worker."""

import pytest

NUM_FRAMES = 6
PRESETS = {
    "modern": ("--preset", "modern"),
    "light": ("--preset", "modern", "--light"),
    "modern-prompts": ("--preset", "modern", "--proposals", "motion-prompts"),
    "light-prompts": ("--preset", "modern", "--light", "--proposals", "motion-prompts"),
}
FITTING = ("--set", "motion_prompts.min_coverage=0", "--set", "motion_prompts.max_growth=1000")
"""Random networks give masks that fit no region otherwise."""


@pytest.fixture(scope="module")
def cluster(make_cluster, tiny, tmp_path_factory):
    """A scheduler and a worker that finds the weights."""
    cluster = make_cluster(tmp_path_factory.mktemp("cluster"))
    cluster.hold_scheduler()
    try:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("MOSEG_WEIGHTS", str(tiny))
            cluster.add_worker("one")
        yield cluster
    finally:
        cluster.close()


@pytest.fixture
def segment(moseg, tiny, contents_of, tmp_path, monkeypatch, write_squares):
    """Returns a function that segments a video into a store of its own, and returns all that it left."""
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tiny))
    monkeypatch.setenv("MOSEG_OFFLINE", "1")
    video = write_squares(tmp_path / "clip", num_frames=NUM_FRAMES) / "frames"

    def call(name, *words):
        store, out = tmp_path / name / "store", tmp_path / name / "out"
        options = ("--section-length", str(NUM_FRAMES // 2), "--device", "cpu", *FITTING)
        ran = moseg("segment", video, "--store", store, "--out", out, "--quiet", *options, *words)
        assert ran.code == 0, ran.err
        masks = [path.read_bytes() for path in sorted((out / "masks").glob("*.png"))]
        assert len(masks) == NUM_FRAMES
        return contents_of(store), masks, (out / "motion.json").read_bytes()

    return call


@pytest.mark.parametrize("preset", PRESETS)
def test_workers_and_a_cluster_give_the_bytes_of_one_process(preset, segment, cluster):
    words = PRESETS[preset]
    alone = segment("alone", *words)
    tasks = {ref.partition("/")[0] for ref in alone[0]}
    assert tasks >= {"instances", "proposals", "tracks", "flow", "depth"}
    assert ("motion_prompts" in tasks) == ("--proposals" in words) and ("tags" in tasks) != ("--proposals" in words)
    assert segment("two", *words, "--workers", "2") == alone
    assert segment("cluster", *words, "--scheduler", cluster.address) == alone
