"""The benchmark of joblib's memory computes the same as an evaluation, and finds its results again."""

import importlib
from pathlib import Path

import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.workflows.datasets import open_dataset

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture
def benchmark(monkeypatch):
    """Return the benchmark's module."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("joblib_memory")


def test_joblib_gives_the_scores_of_an_evaluation_cold_and_warm(benchmark, tmp_path):
    videos = importlib.import_module("engine.tiny_videos")
    videos.write_videos(tmp_path / "data", num_videos=1, num_pairs=3, size=(96, 128))
    config = PipelineConfig()
    dataset = open_dataset("folder", str(tmp_path / "data"), max_side=config.max_side)
    sources = [dataset.sequence(name) for name in dataset.names]
    scripts = benchmark.write_scripts(sources, config, tmp_path / "scripts")
    runs = {
        "ours": lambda: benchmark.run_ours(sources, config, tmp_path / "ours", jobs=1),
        "joblib": lambda: benchmark.run_joblib(scripts, tmp_path / "joblib", jobs=1),
    }
    # It raises ValueError unless both sides give the same scores.
    found = benchmark.compare(runs, tmp_path)
    assert set(found) == {"cold", "warm", "on disk"}
    assert all(value > 0 for values in found.values() for value in values)
