"""Cuts of groups where few joins hold them together."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix, triu

from moseg.schemas.parameters import RegroupParams
from moseg.tasks.track_objects import thin_joins
from moseg.tasks.track_objects.thin_joins import cut_thin_joins

PARAMS = RegroupParams()


def _blocks(sizes, bridges=()):
    """Return joins (n, n) within rings of blocks with chords, and bridges of (block, block, similarity)."""
    starts = np.concatenate([[0], np.cumsum(sizes)])
    joins = [
        (start + place, start + (place + step) % size, 1.0)
        for start, size in zip(starts, sizes, strict=False)
        for place in range(size)
        for step in (1, 2, size // 3)
    ]
    # Each bridge ends at other tracks than the ones before.
    joins += [(starts[first] + at, starts[second] + at, value) for at, (first, second, value) in enumerate(bridges)]
    rows, columns, values = np.array(joins).T
    rows, columns = np.sort([rows.astype(int), columns.astype(int)], axis=0)
    return triu(coo_matrix((values, (rows, columns)), (starts[-1],) * 2)).tocsr()


def _labels(sizes):
    return np.repeat(np.arange(len(sizes)), sizes)


def _cut(sizes, bridges=(), motions=None, group=None, **changes):
    """Return the group of each track, all of one group unless given; by default one sample knows every block."""
    motions = [_labels(sizes)] if motions is None else motions
    group = np.zeros(sum(sizes), np.int64) if group is None else group
    return cut_thin_joins(group, _blocks(sizes, bridges), motions, PARAMS.model_copy(update=changes))


THIN = ((0, 1, 0.5),)


def test_a_thin_join_is_cut_and_the_larger_side_keeps_the_number():
    found = _cut((40, 30), THIN)
    assert found.dtype == np.int64
    assert found.tolist() == [0] * 40 + [1] * 30
    assert _cut((30, 40), THIN).tolist() == [1] * 30 + [0] * 40


def test_a_thick_join_is_not_cut():
    # A side of 30 tracks has six ends of joins each, and that of the bridge.
    conductance = 0.5 / (30 * 6 + 0.5)
    assert (_cut((40, 30), THIN, thin_join=conductance * 0.999) == 0).all()
    assert (_cut((40, 30), THIN, thin_join=conductance * 1.001) == _labels((40, 30))).all()
    assert (_cut((40, 30), ((0, 1, 5.0),)) == 0).all()


def test_one_sample_that_tells_the_sides_apart_suffices_and_none_does_not():
    sizes = (40, 30)
    alike, apart = np.zeros(70, np.int64), _labels(sizes)
    assert (_cut(sizes, THIN, [alike, alike, apart]) == apart).all()
    assert (_cut(sizes, THIN, [alike, alike]) == 0).all()
    assert (_cut(sizes, THIN, []) == 0).all()


@pytest.mark.parametrize(("share", "is_cut"), [(0.2, False), (0.4, True)])
def test_the_motion_groups_of_the_sides_must_differ_by_a_share(share, is_cut):
    sizes = (40, 30)
    motion = np.zeros(70, np.int64)
    motion[40 : 40 + round(30 * share)] = 3
    # What no group reached says nothing: of the others of that side the share is the same.
    motion[:20] = -1
    assert (_cut(sizes, THIN, [motion]).max() == 1) == is_cut


def test_a_side_of_unknown_motion_is_not_told_apart():
    motion = np.where(np.arange(70) < 40, 0, -1)
    assert (_cut((40, 30), THIN, [motion]) == 0).all()


def test_sides_are_cut_again():
    sizes = (30, 40, 50)
    found = _cut(sizes, ((0, 1, 0.5), (1, 2, 0.5)))
    assert [len(np.unique(found[_labels(sizes) == block])) for block in range(3)] == [1, 1, 1]
    assert len(np.unique(found)) == 3
    assert found[[0, 30, 70]].tolist() == [2, 0, 1]


def test_the_smaller_side_is_cut_again_too():
    sizes = (100, 30, 40)
    found = _cut(sizes, ((0, 1, 0.1), (1, 2, 0.5)))
    assert (found == np.repeat([0, 2, 1], sizes)).all()


def test_what_nothing_joins_stays_in_its_group():
    assert (_cut((40, 30)) == 0).all()
    # A piece beside that is cut stays with the group, and so does the larger side.
    found = _cut((40, 30, 35), THIN)
    assert (found == np.repeat([0, 1, 0], (40, 30, 35))).all()


def test_a_small_side_is_no_side():
    # Six of 106 parts of the joins.
    assert (_cut((100, 6), ((0, 1, 0.1),)) == 0).all()
    assert (_cut((100, 6), ((0, 1, 0.1),), min_side=0.05) == _labels((100, 6))).all()


def test_groups_are_cut_apart_and_tracks_of_none_stay_so():
    sizes = (40, 30, 40, 30)
    group = np.repeat([1, 1, -1, 0], sizes)
    found = _cut(sizes, ((0, 1, 0.5), (2, 3, 0.5)), group=group)
    assert (found == np.repeat([1, 2, -1, 0], sizes)).all()


def test_large_groups_are_cut_as_small_ones_are():
    sizes = (260, 140)
    assert (_cut(sizes, THIN) == _labels(sizes)).all()
    assert (_cut((400, 1), ()) == 0).all()


@pytest.mark.parametrize("dense", [10, 1000])
def test_thicker_joins_are_found_if_asked_for(dense, monkeypatch):
    monkeypatch.setattr(thin_joins, "_DENSE", dense)
    sizes, joins = (40, 30), ((0, 1, 1.0),) * 10
    assert (_cut(sizes, joins) == 0).all()
    assert (_cut(sizes, joins, thin_join=0.06) == _labels(sizes)).all()


def test_no_tracks_and_few_tracks():
    nothing = cut_thin_joins(np.zeros(0, np.int64), coo_matrix((0, 0)).tocsr(), [], PARAMS)
    assert nothing.shape == (0,)
    pair = coo_matrix(([0.001], ([0], [1])), (2, 2)).tocsr()
    assert (cut_thin_joins(np.zeros(2, np.int64), pair, [np.arange(2)], PARAMS) == 0).all()
