"""Runs on a video of several scenes: each is segmented like a video of its own, and the result is of the whole."""

from itertools import chain

import cv2
import numpy as np
import pytest

import moseg
from moseg.schemas.configs import Variant
from moseg.schemas.recipes import split_ref
from moseg.store import open_store
from moseg.workflows.api.open_run import open_run
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.graph import make_graph
from moseg.workflows.reports.from_log import report_run
from moseg.workflows.reports.subject import read_subject
from moseg.workflows.runlog.status import list_runs

LENGTHS = 7, 6
CUT, NUM_FRAMES = LENGTHS[0], sum(LENGTHS)
CONFIG = {"sections.length": 4, "sections.overlap": 2}


@pytest.fixture(scope="module")
def shots(write_squares, tmp_path_factory):
    """Return the frames of two shots of other squares, uint8 (frame, y, x, rgb) each."""
    found = []
    for seed, length in zip((0, 7), LENGTHS, strict=True):
        folder = write_squares(tmp_path_factory.mktemp("shot") / "squares", num_frames=length, seed=seed) / "frames"
        found.append(np.stack([cv2.imread(str(path))[..., ::-1] for path in sorted(folder.iterdir())]))
    return found


@pytest.fixture(scope="module")
def film(shots):
    """Return the frames of both shots, joined by a cut."""
    return np.concatenate(shots)


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    """Return the folder of the store of all runs."""
    return tmp_path_factory.mktemp("scenes") / "store"


@pytest.fixture(scope="module")
def segment(store):
    """Return a function that segments frames."""

    def call(frames, config=(), **options):
        options = {"store": store, "progress": False, "keep_cues": True, "name": "film", **options}
        return moseg.segment_video(frames, CONFIG | dict(config), **options)

    return call


@pytest.fixture(scope="module")
def whole(segment, film):
    """Return the result of the film."""
    return segment(film)


def _identities(labels):
    return [*np.unique(labels[labels > 0]).tolist()]


def test_masks_are_those_of_each_shot_alone_with_identities_of_their_own(segment, whole, shots, store):
    parts = whole.labels[:CUT], whole.labels[CUT:]
    found = [_identities(labels) for labels in parts]
    assert all(found) and not {*found[0]} & {*found[1]}
    for shot, labels, identities in zip(shots, parts, found, strict=True):
        before = {*open_store(str(store)).refs()}
        alone = segment(shot)
        new = {split_ref(ref)[0] for ref in open_store(str(store)).refs() if ref not in before}
        with_other_identities = {"segmentation", "moves_now", "confidence"}
        assert new <= {"ingest", "black_bars", "screen_graphics", "scene_cuts"} | with_other_identities
        renumbered = np.zeros_like(labels)
        for own, identity in zip(_identities(alone.labels), identities, strict=True):
            renumbered[alone.labels == own] = identity
        assert np.array_equal(renumbered, labels)
    groups = {each.identity: each.motion for each in whole.objects}
    assert not {groups[identity] for identity in found[0]} & {groups[identity] for identity in found[1]}
    assert whole.num_motions == 1 + len(set(groups.values()))


def test_objects_are_found_in_the_frames_of_the_film(whole):
    for each in whole.objects:
        assert each.last_frame < CUT or each.first_frame >= CUT
    assert any(line.startswith(f"cut before frame {CUT}: the scenes are segmented apart") for line in whole.look_at)


def test_between_objects_of_two_scenes_there_is_no_evidence(whole):
    rows = np.array(whole.row_identities)
    assert {each.identity for each in whole.objects} <= {*rows.tolist()}
    in_first = np.isin(rows, _identities(whole.labels[:CUT]))
    in_second = np.isin(rows, _identities(whole.labels[CUT:]))
    for values in (*whole.affinities.values(), *chain.from_iterable(whole.residuals.values())):
        assert values.shape == (len(rows), len(rows))
        assert np.isnan(values[np.ix_(in_first, in_second)]).all()
    affinity = whole.affinities["oc_depth"]
    assert np.isfinite(affinity[in_first, 0]).all() and np.isfinite(affinity[in_second, 0]).all()
    assert all(each.static_support for each in whole.objects)


def test_flow_leads_over_no_cut(whole):
    assert whole.cue("flow", CUT - 2).shape == whole.cue("flow", CUT).shape
    with pytest.raises(IndexError, match=f"frame {CUT - 1} is the last one of its scene"):
        whole.cue("flow", CUT - 1)
    assert whole.cue("saliency", CUT - 1).ndim == 2


def test_a_run_again_computes_nothing(segment, whole, film):
    again = segment(film)
    assert again.store_use.computed == 0 and np.array_equal(again.labels, whole.labels)


def test_switched_off_the_film_is_one_scene(segment, film):
    result = segment(film, {"scene_cuts.apart": False})
    (line,) = [line for line in result.look_at if line.startswith(f"cut before frame {CUT}: ")]
    assert "objects are not followed" in line
    assert result.cue("flow", CUT - 1).shape == result.cue("flow", CUT).shape


def test_a_single_frame_is_no_scene(segment, film):
    result = segment(film[CUT - 1 :])
    assert any(line.startswith("cut before frame 1: objects are not followed") for line in result.look_at)
    assert len(result.labels) == NUM_FRAMES - CUT + 1


def test_given_masks_are_of_one_scene(segment, film, tmp_path):
    masks = np.zeros(film.shape[:3], np.uint8)
    masks[:, 20:40, 20:40] = 3
    (tmp_path / "masks").mkdir()
    for number, mask in enumerate(masks):
        cv2.imwrite(str(tmp_path / "masks" / f"{number:05}.png"), mask)
    result = segment(film, variant=Variant.BASE, proposals=tmp_path / "masks")
    assert _identities(result.labels) == [3]
    assert any("objects are not followed" in line for line in result.look_at)


@pytest.mark.parametrize("motions", [2, 3])
def test_a_number_of_motions_is_that_of_each_scene(segment, film, motions):
    result = segment(film, motions=motions)
    for labels in (result.labels[:CUT], result.labels[CUT:]):
        groups = {each.motion for each in result.objects if each.identity in _identities(labels)}
        assert len(groups) <= motions - 1
    assert result.num_motions == 1 + 2 * (motions - 1)


def test_corrections_name_frames_and_identities_of_the_film(segment, whole, film):
    first, second = (_identities(labels)[0] for labels in (whole.labels[:CUT], whole.labels[CUT:]))
    result = segment(film, corrections=[{"merge": [first, second]}, {"rename": {"object": first, "name": "dog"}}])
    expected = np.where(whole.labels == second, first, whole.labels)
    assert np.array_equal(result.labels, expected)
    (merged,) = [each for each in result.objects if each.identity == first]
    assert (merged.first_frame, merged.last_frame, merged.name) == (0, NUM_FRAMES - 1, "dog")


def test_workers_give_the_same_masks(segment, whole, film, tmp_path):
    result = segment(film, workers=2, store=tmp_path / "store")
    assert np.array_equal(result.labels, whole.labels)
    # The cuts are computed before the rest, and read after it.
    assert result.store_use.reused == 0


def test_the_log_of_a_run_has_its_scenes(whole, store):
    opened = open_store(str(store), create=False)
    subjects = [read_subject(opened, run) for run in list_runs(opened)]
    found = [subject for subject in subjects if subject.sequences[0].leaves.cuts]
    assert found
    for subject in found:
        leaves = subject.sequences[0].leaves
        labels = make_graph(leaves, subject.config).segmentations(Variant.FUSED)
        assert leaves.cuts == (CUT,) and opened.present(labels) == {*labels}


def test_a_report_has_the_groups_of_each_scene(whole, store):
    opened = open_store(str(store), create=False)
    runs = [run for run in list_runs(opened) if read_subject(opened, run).sequences[0].leaves.cuts]
    page = report_run(opened, runs[-1])
    (panel,) = page.sequences
    assert [each.title for each in panel.variants] == [
        f"fused, frames 0 to {CUT - 1}",
        f"fused, frames {CUT} to {NUM_FRAMES - 1}",
    ]
    assert panel.num_frames == NUM_FRAMES
    named = [each.name for variant in panel.variants for each in variant.objects if each.name != "background"]
    assert sorted(named) == sorted({*named}) and len(named) == len(whole.row_identities) - 1
    for variant in panel.variants:
        assert variant.matrices and all(len(each.labels) == len(variant.objects) for each in variant.matrices)


def test_labels_of_an_open_run_are_those_of_the_result(film, whole, store):
    with open_run(film, RunSettings(str(store), quiet=True), PipelineChoices(CONFIG), name="film") as run:
        run.apply([])
        assert all(np.array_equal(run.labels(frame), whole.labels[frame]) for frame in range(NUM_FRAMES))
        dropped, kept = (_identities(labels)[0] for labels in (whole.labels[:CUT], whole.labels[CUT:]))
        changed = run.apply([{"drop": dropped}])
        assert {*changed.frames} <= {*range(CUT)} and dropped not in changed.shown and kept in changed.shown
        assert {*run.judge().motions} >= {dropped, kept}
