"""Reuse of artifacts by corrections: what they compute anew, and what the store has of them."""

from moseg.workflows.api import segment_video


def test_the_same_corrections_are_found_in_the_store_and_none_recompute_nothing(correct, several_edits):
    correct(several_edits)
    assert correct(several_edits).store_use.computed == 0
    assert correct(None).store_use.computed == 0
    assert correct([]).store_use.computed == 0
    assert correct([{"rename": {"object": 1, "name": "x"}}]).store_use.computed == 0
    # The objects; and labels, moves and confidences of three sections.
    more = correct([*several_edits, {"merge": [2, 4]}])
    assert more.store_use.computed <= 10


def test_what_is_left_out_needs_no_cues(frames, tmp_path, config):
    """They are not in the store after a run that does not keep them."""
    arguments = {"store": tmp_path / "store", "progress": False}
    plain = segment_video(frames, config, **arguments)
    for corrections in ([{"drop": 1}, {"rename": {"object": 2, "name": "x"}}], [{"static": 2}]):
        done = segment_video(frames, config, corrections=corrections, **arguments)
        assert done.store_use.computed == 4
        (left,) = done.objects
        before = next(each for each in plain.objects if each.identity == left.identity)
        assert (left.sure, left.moving_frames, left.score) == (before.sure, before.moving_frames, before.score)


def test_why_names_the_edit(frames, moseg, tmp_path, config):
    store = tmp_path / "store"
    listing = ("store", "ls", "--task", "segmentation", "--store", store)
    segment_video(frames, config, store=store, progress=False, keep_cues=True, corrections=[{"drop": 1}])
    before = set(moseg(*listing).out.split())
    segment_video(frames, config, store=store, progress=False, keep_cues=True, corrections=[{"drop": 2}])
    new = min(set(moseg(*listing).out.split()) - before)
    ran = moseg("store", "why", new, "--store", store)
    assert (ran.code, ran.err) == (0, "")
    assert ran.out.splitlines()[-1] == "  params.steps[0].objects[0]: 2 here, 1 there"
