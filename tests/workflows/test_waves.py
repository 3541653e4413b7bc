"""A data set is planned one wave at a time, and no score depends on where it was cut."""

from json import loads
from types import SimpleNamespace

from hypothesis import given
from hypothesis import strategies as st

from moseg.workflows.engine import waves
from moseg.workflows.engine.waves import cut_waves


def _sources(counts):
    return [SimpleNamespace(frames=SimpleNamespace(num_frames=lambda count=count: count)) for count in counts]


@given(st.lists(st.integers(1, 9000), max_size=20), st.integers(1, 6))
def test_waves_hold_every_sequence_once_and_at_most_the_limit_of_frames(counts, num_workers):
    sources = _sources(counts)
    cut = list(cut_waves(sources, num_workers))
    assert [source for wave in cut for source in wave] == sources
    limit = max(waves.FRAMES, waves.FRAMES_PER_WORKER * num_workers)
    for wave in cut:
        assert len(wave) == 1 or sum(source.frames.num_frames() for source in wave) <= limit


def test_small_sequences_share_a_wave():
    assert [len(wave) for wave in cut_waves(_sources([60] * 8), 2)] == [8]


def test_scores_do_not_depend_on_where_a_data_set_is_cut(write_squares, moseg, tmp_path, monkeypatch):
    for name in "abc":
        write_squares(tmp_path / "data" / name)
    reports = {}
    for limit in (1, 4096):
        monkeypatch.setattr(waves, "FRAMES", limit)
        monkeypatch.setattr(waves, "FRAMES_PER_WORKER", 1)
        options = ("--root", tmp_path / "data", "--store", tmp_path / f"of {limit}")
        json = tmp_path / f"{limit}.json"
        ran = moseg("eval", "--dataset", "folder", *options, "--variant", "base", "--json", json)
        assert ran.code == 0 and ("wave 2 of 3: 1 sequences, b to b" in ran.err) == (limit == 1)
        reports[limit] = loads(json.read_text())
    assert reports[1]["rows"] == reports[4096]["rows"]
    assert reports[1]["rows"][0]["sequences"].keys() == set("abc")
