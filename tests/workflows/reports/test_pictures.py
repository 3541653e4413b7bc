"""The pictures of a sequence in a report show the results of the run."""

import io

import av
import numpy as np
import pytest
from PIL import Image

from moseg.schemas.configs import PipelineConfig, SectionParams, Variant
from moseg.schemas.parameters import DepthParams, FlowParams
from moseg.schemas.recipes import leaf_recipe, split_ref
from moseg.store import open_store
from moseg.workflows.datasets import open_dataset
from moseg.workflows.exports.draw_errors import ERROR_COLOURS
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.leaves import ingest_jobs, make_leaves
from moseg.workflows.pipelines.plan_evaluation import foresee_ingest
from moseg.workflows.reports import layers
from moseg.workflows.reports import pictures as report_pictures
from moseg.workflows.reports.content import LayerKind
from moseg.workflows.reports.cue_layers import plan_cue_layers
from moseg.workflows.reports.layers import all_colours, as_hex
from moseg.workflows.reports.pictures import gather_pictures, picture_refs
from moseg.workflows.stages.registry import axes_of

CONFIG = PipelineConfig(sections=SectionParams(length=4, overlap=2))
FUSED = (Variant.FUSED,)
SHAPE = (96, 128)
OPAQUE = ["frame", "motion saliency", "optical flow", "flow relative to the background"]
OVER = ["moving objects (fused)", "ground truth", "errors (fused)", "proposals", "tracks"]


def _put(store, recipe, arrays, attributes=None):
    """Store an artifact of a stage or a leaf."""
    return store.put(recipe, arrays, attributes, dims=axes_of(recipe.task, arrays))


class _Recorder:
    """A store that records the references that are read."""

    def __init__(self, store):
        self._store = store
        self.refs = set()

    def __getattr__(self, name):
        if name in ("read", "read_rows", "attributes", "manifest"):
            return lambda ref, *more: (self.refs.add(ref), getattr(self._store, name)(ref, *more))[1]
        return getattr(self._store, name)


def _open(evaluation, config=CONFIG, **leaves):
    """Return the store of an evaluation and the graph of its only sequence, with other leaves where given."""
    store = open_store(str(evaluation.store), create=False)
    source = open_dataset("folder", str(evaluation.root), max_side=config.max_side).sequence("squares")
    jobs = ingest_jobs(source, CONFIG, annotated=True)
    ingested = {role: foresee_ingest(store, group)[0] for role, group in jobs.items()}
    return store, SequenceGraph(make_leaves(source, ingested)._replace(**leaves), config)


def _decode(picture):
    image = Image.open(io.BytesIO(picture.data))
    assert image.format == picture.media_type.removeprefix("image/").upper()
    assert image.size == (picture.width, picture.height)
    return np.asarray(image)


def _layer(pictures, name):
    return next(layer for layer in pictures.layers if layer.name == name)


def _read(evaluation, kind, number):
    return np.asarray(Image.open(evaluation.root / "squares" / kind / f"{number:05d}.png"))


@pytest.fixture(scope="module")
def pictures(evaluated):
    """Of three frames, 1, 5 and 8."""
    return gather_pictures(*_open(evaluated), CONFIG, FUSED, 3, fps=5.0)


def test_every_layer_has_a_picture_of_each_frame_at_its_size(pictures):
    assert pictures.frames == (1, 5, 8)
    assert [layer.name for layer in pictures.layers] == OPAQUE + OVER
    assert pictures.missing == ()
    for layer in pictures.layers:
        assert layer.kind == (LayerKind.BASE if layer.name in OPAQUE else LayerKind.OVER)
        assert layer.description.endswith(".")
        channels = 3 if layer.kind is LayerKind.BASE else 4
        assert [_decode(picture).shape for picture in layer.pictures] == [(*SHAPE, channels)] * 3
    assert [layer.name for layer in pictures.layers if layer.is_shown] == ["frame", "moving objects (fused)"]


def test_frames_are_those_of_the_sequence(pictures, evaluated):
    for frame, picture in zip(pictures.frames, _layer(pictures, "frame").pictures, strict=True):
        difference = _decode(picture).astype(int) - _read(evaluated, "frames", frame)
        assert np.abs(difference).mean() < 8


def test_masks_are_tinted_where_objects_are_and_transparent_elsewhere(pictures, evaluated):
    store, graph = _open(evaluated)
    labels = np.concatenate([store.read(ref, "labels") for ref in graph.segmentations(Variant.FUSED)])
    layer = _layer(pictures, "moving objects (fused)")
    for frame, picture in zip(pictures.frames, layer.pictures, strict=True):
        alpha = _decode(picture)[..., 3]
        assert (alpha[labels[frame] > 0] > 0).all()
        assert np.mean(alpha[labels[frame] == 0] == 0) > 0.9
    seen = sorted(set(np.unique(labels[list(pictures.frames)]).tolist()) - {0})
    assert len(layer.legend) >= len(seen) == 2
    assert len({entry.colour for entry in layer.legend}) == len(layer.legend)


def test_identities_have_the_same_colour_in_legend_table_and_picture(pictures):
    layer = _layer(pictures, "moving objects (fused)")
    legend = {entry.colour for entry in layer.legend}
    assert {row.colour for row in pictures.objects} <= legend
    image = _decode(layer.pictures[1])
    solid = {as_hex(colour) for colour in image[image[..., 3] == 255][:, :3]}
    assert {row.colour for row in pictures.objects if row.first_frame <= 5 <= row.last_frame} <= solid


def test_errors_have_the_colours_of_their_legend(pictures, evaluated):
    store, graph = _open(evaluated)
    labels = np.concatenate([store.read(ref, "labels") for ref in graph.segmentations(Variant.FUSED)])
    layer = _layer(pictures, "errors (fused)")
    assert [entry.colour for entry in layer.legend] == [as_hex(colour) for colour in ERROR_COLOURS.values()]
    for frame, picture in zip(pictures.frames, layer.pictures, strict=True):
        truth, found, image = _read(evaluated, "masks", frame) > 0, labels[frame] > 0, _decode(picture)
        for where, colour in zip((truth & found, ~truth & found, truth & ~found), ERROR_COLOURS.values(), strict=True):
            drawn = image[where & (image[..., 3] > 100)][:, :3].astype(int)
            assert len(drawn) == np.count_nonzero(where)
            if len(drawn):
                assert (np.abs(np.median(drawn, axis=0) - colour) < 40).all()


def test_tracks_lie_on_objects_in_their_colour_and_elsewhere_in_grey(pictures, evaluated):
    layer = _layer(pictures, "tracks")
    image, truth = _decode(layer.pictures[1]), _read(evaluated, "masks", 5)
    drawn = image[..., 3] > 200
    is_coloured = drawn & (np.ptp(image[..., :3].astype(int), axis=-1) > 100)
    assert np.mean(truth[is_coloured] > 0) > 0.8
    assert np.count_nonzero(drawn & (truth == 0)) > 20
    assert {entry.meaning for entry in layer.legend} >= {"on static pixels"}


def test_flow_has_the_wheel_as_its_key_and_names_its_scale(pictures):
    layer = _layer(pictures, "optical flow")
    assert _decode(layer.key).shape[2] == 4
    assert "px/frame" in layer.description
    # The backdrop moves a pixel to the left in every frame: towards cyan.
    red, green, blue = _decode(layer.pictures[1])[80:, 20:100].reshape(-1, 3).mean(axis=0)
    assert red < green < blue


def test_the_last_frame_has_no_flow(evaluated):
    pictures = gather_pictures(*_open(evaluated), CONFIG, FUSED, 10, fps=5.0)
    assert pictures.frames == tuple(range(10))
    for name in ("optical flow", "flow relative to the background"):
        *rest, last = _layer(pictures, name).pictures
        assert last is None
        assert None not in rest


def test_objects_are_those_of_all_frames(pictures, evaluated):
    store, graph = _open(evaluated)
    labels = np.concatenate([store.read(ref, "labels") for ref in graph.segmentations(Variant.FUSED)])
    assert [row.identity for row in pictures.objects] == (np.flatnonzero(np.bincount(labels.ravel())[1:]) + 1).tolist()
    for row in pictures.objects:
        (seen,) = np.nonzero((labels == row.identity).any(axis=(1, 2)))
        assert (row.first_frame, row.last_frame, row.num_frames) == (seen[0], seen[-1], len(seen))
        assert row.mean_area_percent == pytest.approx(100 * np.mean(labels[seen] == row.identity))
        assert row.motion > 0


def test_timelines_and_masks_are_those_of_all_frames(pictures, evaluated):
    store, graph = _open(evaluated)
    labels = np.concatenate([store.read(ref, "labels") for ref in graph.segmentations(Variant.FUSED)])
    assert {each.name.split(" ")[0] for each in pictures.timelines} == {str(row.identity) for row in pictures.objects}
    for timeline in pictures.timelines:
        share = 100 * (labels == int(timeline.name.split(" ")[0])).mean(axis=(1, 2))
        assert timeline.step == 1 and timeline.areas == pytest.approx(share.tolist(), abs=1e-3)
        for thumbnail in filter(None, timeline.thumbnails):
            assert share[thumbnail.frame] > 0 and _decode(thumbnail.picture).shape == (72, 96, 3)
        assert len(timeline.thumbnails) == 8
    assert [frame for frame, _, _ in pictures.masks.places] == list(range(10))
    for frame, start, size in pictures.masks.places:
        mask = np.asarray(Image.open(io.BytesIO(pictures.masks.data[start : start + size])))
        assert np.array_equal(mask, labels[frame])


def _play(video):
    with av.open(io.BytesIO(video.data)) as container:
        stream = container.streams.video[0]
        assert stream.codec_context.name == "h264"
        assert float(stream.average_rate) == pytest.approx(video.fps)
        return [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]


def test_the_video_shows_every_frame(pictures):
    frames = _play(pictures.video)
    assert [frame.shape for frame in frames] == [(*SHAPE, 3)] * 10
    assert (pictures.video.height, pictures.video.width, pictures.video.fps, pictures.video.step) == (*SHAPE, 5.0, 1)


def test_a_large_and_long_video_is_reduced_to_even_sizes_and_every_nth_frame(evaluated, monkeypatch):
    monkeypatch.setattr(report_pictures, "MAX_VIDEO_FRAMES", 4)
    for module in (report_pictures, layers):
        monkeypatch.setattr(module, "PICTURE_SIDE", 101)
    pictures = gather_pictures(*_open(evaluated), CONFIG, FUSED, 1, fps=6.0)
    assert [frame.shape for frame in _play(pictures.video)] == [(76, 102, 3)] * 4
    assert (pictures.video.height, pictures.video.width, pictures.video.fps) == (76, 102, 2.0)
    assert pictures.video.step == 3 and pictures.missing == ("The video shows one frame in 3 of 10.",)
    assert [frame for frame, _, _ in pictures.masks.places] == [0, 3, 6, 9]
    assert _decode(_layer(pictures, "proposals").pictures[0]).shape == (76, 101, 4)


def test_pictures_read_exactly_the_sinks_of_the_run(evaluated):
    store, graph = _open(evaluated)
    recorder = _Recorder(store)
    gather_pictures(recorder, graph, CONFIG, FUSED, 10, fps=5.0)
    refs = picture_refs(graph, CONFIG, FUSED, 10)
    assert recorder.refs == set(refs)
    assert len(refs) == len(set(refs))
    assert store.present(refs) == set(refs)


def test_given_depth_is_shown_lighter_where_near(evaluated_copy):
    store, _ = _open(evaluated_copy)
    recipe = leaf_recipe("given_depth", "0" * 64)
    depth = np.tile(np.linspace(0, 2, SHAPE[1], dtype=np.float32), (SHAPE[0], 1))
    _put(store, recipe, {"inverse_depth": depth})
    config = CONFIG.model_copy(update={"depth": DepthParams(method="groundtruth")})
    _, graph = _open(evaluated_copy, config, depth=(recipe.ref,) * 10)
    layer = _layer(gather_pictures(store, graph, config, FUSED, 2, fps=5.0), "inverse depth")
    brightness = _decode(layer.pictures[0]).sum(axis=-1, dtype=int).mean(axis=0)
    assert brightness[10] < brightness[64] < brightness[118]
    assert layer.key is not None


def test_ground_truth_at_points_is_drawn_as_points(evaluated_copy):
    store, graph = _open(evaluated_copy)
    recipe = leaf_recipe("labelled_points", "0" * 64)
    # Of frames twice as large: one point on a square, one on the backdrop, one that stands in neither.
    points = np.tile(np.array([[[60.0, 50.0]], [[200.0, 180.0]], [[20.0, 170.0]]]), (1, 10, 1))
    visible = np.ones((3, 10), bool)
    visible[:, :4] = False
    labels = np.array([1, 2, 0], np.uint16)
    _put(store, recipe, {"points": points, "visible": visible, "labels": labels}, {"size": [192, 256]})
    _, graph = _open(evaluated_copy, annotation=None, labelled_points=recipe.ref)
    pictures = gather_pictures(store, graph, CONFIG, FUSED, 2, fps=5.0)
    assert pictures.frames == (5, 8)
    truth, errors = (_decode(_layer(pictures, name).pictures[0]) for name in ("ground truth", "errors (fused)"))
    assert {tuple(truth[y, x, :3].tolist()) for x, y in ((30, 25), (100, 90))} == {(255, 255, 255)}
    assert truth[85, 10, 3] > 200
    assert truth[85, 10, 0] < 128
    assert tuple(errors[25, 30, :3].tolist()) == ERROR_COLOURS["true positive"]
    assert tuple(errors[90, 100, :3].tolist()) == ERROR_COLOURS["false negative"]
    assert errors[85, 10, 3] == 0


def test_without_ground_truth_there_is_neither_it_nor_errors(evaluated):
    store, graph = _open(evaluated, annotation=None)
    pictures = gather_pictures(store, graph, CONFIG, FUSED, 2, fps=5.0)
    assert pictures.frames == (2, 7)
    assert not [layer.name for layer in pictures.layers if "truth" in layer.name or "errors" in layer.name]
    assert pictures.missing == ()


def test_cues_that_a_run_does_not_read_are_no_sinks(evaluated):
    config = CONFIG.model_copy(update={"proposal_source": "groundtruth"})
    _, plain = _open(evaluated)
    _, graph = _open(evaluated, config, masks=plain.leaves.annotation)
    stages = {split_ref(ref)[0] for ref in picture_refs(graph, config, (Variant.BASE,), 4)}
    assert stages == {"frame", "annotation", "proposals", "linking", "segmentation"}
    stages = {split_ref(ref)[0] for ref in picture_refs(graph, config, (Variant.OC,), 4)}
    assert stages >= {"flow", "clustering"}
    assert not stages & {"saliency", "depth"}


def test_with_ground_truth_of_no_frame_all_frames_and_their_depth_are_shown(evaluated_copy):
    store, _ = _open(evaluated_copy)
    depth, annotation = leaf_recipe("given_depth", "0" * 64), leaf_recipe("annotation", "1" * 64)
    _put(store, depth, {"inverse_depth": np.ones(SHAPE, np.float32)})
    _put(store, annotation, {"masks": np.zeros((0, *SHAPE), np.uint16)}, {"indices": []})
    config = CONFIG.model_copy(update={"depth": DepthParams(method="groundtruth")})
    _, graph = _open(evaluated_copy, config, depth=(depth.ref,) * 10, annotation=annotation.ref)
    pictures = gather_pictures(store, graph, config, FUSED, 2, fps=5.0)
    assert (pictures.frames, pictures.missing[-1]) == ((2, 7), "No frame has ground truth.")
    assert len(_layer(pictures, "inverse depth").pictures) == 2
    _, graph = _open(evaluated_copy, annotation=annotation.ref)
    pictures = gather_pictures(store, graph, CONFIG, FUSED, 2, fps=5.0)
    assert (pictures.frames, pictures.missing) == ((2, 7), ("No frame has ground truth.",))
    assert _layer(pictures, "ground truth").pictures == _layer(pictures, "errors (fused)").pictures == (None, None)


def test_the_palette_of_all_identities_is_made_once(pictures):
    assert all_colours() is all_colours()
    assert not all_colours().flags.writeable


def test_tracks_are_read_once_a_section_and_labelled_points_once_a_layer(evaluated_copy, count_reads):
    store, _ = _open(evaluated_copy)
    recipe = leaf_recipe("labelled_points", "0" * 64)
    arrays = {"points": np.full((3, 10, 2), 9.0), "visible": np.ones((3, 10), bool), "labels": np.ones(3, np.uint16)}
    _put(store, recipe, arrays, {"size": list(SHAPE)})
    _, graph = _open(evaluated_copy, annotation=None, labelled_points=recipe.ref)
    counted = count_reads(store)
    pictures = gather_pictures(counted, graph, CONFIG, FUSED, 10, fps=5.0)
    assert len(_layer(pictures, "tracks").pictures) == 10
    assert {counted.reads[graph.motions.tracks(section), "points"] for section in range(3)} == {1}
    # Once for the truth, once for the errors.
    assert counted.reads[recipe.ref, "points"] == counted.reads[recipe.ref, "labels"] == 2


def test_residual_flow_is_black_where_flow_is_unknown(evaluated_copy):
    store, plain = _open(evaluated_copy)
    flow = np.full((*SHAPE, 2), 3.0, np.float32)
    flow[:40, :60] = np.nan
    recipe = leaf_recipe("given_flow", "0" * 64)
    _put(store, recipe, {"flow": flow})
    config = CONFIG.model_copy(update={"flow": FlowParams(method="folder")})
    _, graph = _open(evaluated_copy, config, flow_forward=(recipe.ref,) * 9, flow_backward=(recipe.ref,) * 9)
    view = layers.SequenceView(store, graph, config, (2, 7))
    for frame in view.frames:
        found = plain.recipes[plain.frame_cues.saliency(frame)].ref
        arrays = {name: store.read(found, name) for name in ("saliency", "strict_saliency", "flows", "residual_flows")}
        _put(store, graph.recipes[graph.frame_cues.saliency(frame)], arrays)
    (planned,) = [plan for plan in plan_cue_layers(view, FUSED) if plan.name == "flow relative to the background"]
    assert recipe.ref in planned.refs
    for picture in planned.make().pictures:
        brightness = _decode(picture).max(axis=-1)
        assert (brightness[5:35, 5:55] < 16).all()
        assert (brightness[45:, 65:] > 100).all()
