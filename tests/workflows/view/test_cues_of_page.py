"""A page about a video computes the cues that a run before it let go of, so that a change of settings is quick."""

from moseg.schemas.recipes import split_ref
from moseg.store import open_store


def test_cues_that_an_earlier_run_let_go_of_are_computed(serve, segmented, tmp_path, moseg):
    out, store = tmp_path / "out", tmp_path / "store"
    arguments = (segmented.frames, "--out", out, "--store", store)
    assert moseg("segment", *arguments, "--quiet").code == 0

    def cues() -> set[str]:
        return {split_ref(ref)[0] for ref in open_store(str(store), create=False).refs()} & {"flow", "saliency"}

    assert not cues()
    serve(*arguments).wait("ready")
    assert cues() == {"flow", "saliency"}
