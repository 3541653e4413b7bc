"""Timelines of objects: their thumbnails, outline and sentences; masks in an archive; one pair without a matrix."""

import io
import zipfile

import numpy as np
from PIL import Image

from moseg.workflows.exports.write_masks import write_mask
from moseg.workflows.reports.content import Layer, LayerKind, LegendEntry, Matrix, ObjectTimeline, Picture
from moseg.workflows.reports.layers import merge_layers
from moseg.workflows.reports.mask_archive import MaskArchiver
from moseg.workflows.reports.page import render_page
from moseg.workflows.reports.page.pairs import read_pair
from moseg.workflows.reports.page.timeline_layout import MAX_CHANGES, lay_out_timelines
from moseg.workflows.reports.timelines import choose_thumbnails, cut_out
from moseg.workflows.results.mask_history import ChangeKind, MaskChange


def test_thumbnails_are_near_the_middle_of_equal_stretches():
    areas = np.array([0, 0, 0, 5, 5, 5, 5, 5, 0, 0, 0, 5])
    assert choose_thumbnails(areas, 4) == (None, 4, 7, 11)
    assert choose_thumbnails(areas[3:5], 4) == (0, 1)
    assert choose_thumbnails(areas[:0]) == ()


def test_an_object_is_cut_out_whole_and_bright():
    image = np.full((60, 80, 3), 200, np.uint8)
    mask = np.zeros((60, 80), bool)
    mask[20:32, 50:66] = True
    cut = cut_out(image, mask, (36, 48))
    assert cut.shape == (36, 48, 3)
    bright = cut[..., 0] > 190
    assert bright[18, 24] and not bright[0].any() and not bright[:, 0].any()
    rows, columns = np.nonzero(bright)
    # 16 x 12 px with the margin fill the picture's 48 x 36.
    assert 30 <= np.ptp(columns) + 1 <= 40 and 22 <= np.ptp(rows) + 1 <= 30
    corner = np.zeros_like(mask)
    corner[0, 0] = True
    assert cut_out(image, corner).shape == (72, 96, 3)


def test_an_outline_is_as_high_as_the_largest_area(make_page):
    panel = make_page("dog").sequences[0]
    many = tuple(MaskChange(frame, ChangeKind.VANISHES, frame % 2, False) for frame in range(20))
    timeline = ObjectTimeline("3", "#123456", (2.0, 4.0, 0.0), 5, many)
    (track,) = lay_out_timelines(panel._replace(timelines=(timeline,)))
    assert track.outline == "0,30 0,15 5,15 5,0 10,0 10,30 13,30 13,30"
    assert len(track.changes) == MAX_CHANGES and track.num_more == 8
    assert [jump.text for jump in track.changes[:2]] == ["not seen again", "gone for 1 frame"]


def test_an_archive_holds_the_files_that_masks_are_written_as(tmp_path):
    archiver = MaskArchiver()
    frames = {0: np.eye(8, dtype=np.uint16), 3: 300 * np.eye(8, dtype=np.uint16)}
    for frame, labels in frames.items():
        archiver.add(frame, labels)
    made = archiver.finish()
    with zipfile.ZipFile(io.BytesIO(made.data)) as archive:
        assert archive.namelist() == ["00000.png", "00003.png"]
    for frame, start, size in made.places:
        data = made.data[start : start + size]
        write_mask(tmp_path / "mask.png", frames[frame])
        assert data == (tmp_path / "mask.png").read_bytes()
        assert np.array_equal(np.asarray(Image.open(io.BytesIO(data))), frames[frame])


def test_one_pair_is_said_in_words():
    values = np.array([[0.5, 9.0], [7.0, np.nan]])
    residuals = Matrix("residuals", values, ("background", "1"), "px²", "", True)
    assert read_pair(residuals) == (
        "background: 0.5 px² under its own model, 7 px² under the other's;"
        " object 1: no value under its own model, 9 px² under the other's"
    )
    assert read_pair(Matrix("affinity", values, ("background", "1"))) == "9"
    assert read_pair(Matrix("affinity", values[:1, :1], ("background",))) == "nothing to compare"
    assert read_pair(Matrix("kernel", values, ())) is None
    assert read_pair(Matrix("affinity", np.eye(3), ("background", "1", "2"))) is None


def test_a_page_about_one_object_has_no_matrices(make_page):
    page = make_page("dog")
    (panel,) = page.sequences
    variant = panel.variants[0]
    pair = Matrix("affinity, oc", np.array([[1.0, 0.25], [0.25, 1.0]]), ("background", "1"))
    plot = variant.eigenvalues._replace(eigenvalues=np.array([1.0, 0.7]))

    def text(objects, matrix):
        shown = variant._replace(objects=objects, matrices=(matrix,), eigenvalues=plot)
        return render_page(page._replace(sequences=(panel._replace(variants=(shown,)),)))

    one = text(variant.objects[:2], pair)
    assert "There is one object beside the background" in one and "<dt>affinity, oc</dt><dd>0.25</dd>" in one
    alone = text(variant.objects[:1], Matrix("affinity, oc", np.ones((1, 1)), ("background",)))
    assert "There is no object beside the background" in alone
    for each in (one, alone):
        assert 'class="figure matrix' not in each and 'class="figure plot' not in each and "At least 0.5." in each


def test_layers_of_variants_with_the_same_pictures_are_one():
    def layer(name, data=b"", meaning=""):
        return Layer(name, LayerKind.OVER, (Picture("image/webp", data, 1, 1),), (LegendEntry("#000000", meaning),))

    layers = (layer("objects (fused)"), layer("objects (oc)"), layer("objects (trajs)", b"other"), layer("errors (oc)"))
    layers += (layer("objects (base)"), layer("tracks"), layer("points"), layer("objects (rigid)", meaning="motion 2"))
    assert [each.name for each in merge_layers(layers)] == [
        "objects (fused, oc, base)",
        *("objects (trajs)", "errors (oc)", "tracks", "points", "objects (rigid)"),
    ]
