"""Fixtures: a small report, and a function that opens it in a browser."""

import io
from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from itertools import count

import av
import cv2
import numpy as np
import pytest

from moseg.workflows.reports.content import (
    EigenvaluePlot,
    GroupedObject,
    Layer,
    LayerKind,
    LegendEntry,
    Matrix,
    ObjectRow,
    ObjectTimeline,
    ParameterRow,
    Picture,
    ReportPage,
    ScoreTable,
    SequencePanel,
    StageRow,
    Thumbnail,
    VariantPanel,
    Video,
)
from moseg.workflows.reports.mask_archive import MaskArchiver
from moseg.workflows.reports.page import render_page
from moseg.workflows.results.mask_history import ChangeKind, MaskChange

WIDTH, HEIGHT = 64, 48
FRAMES = (0, 4, 8, 12)
NUM_FRAMES = 13
FPS = 12.0
OBJECT_COLOUR = (230, 0, 0)


class _Counting:
    """A store that counts how often each array is read whole."""

    def __init__(self, store):
        self._store = store
        self.reads = Counter()

    def read(self, ref, name):
        self.reads[ref, name] += 1
        return self._store.read(ref, name)

    def __getattr__(self, name):
        return getattr(self._store, name)


def _picture(pixels: np.ndarray) -> Picture:
    order = cv2.COLOR_RGBA2BGRA if pixels.shape[2] == 4 else cv2.COLOR_RGB2BGR
    data = cv2.imencode(".png", cv2.cvtColor(pixels, order))[1].tobytes()
    return Picture("image/png", data, pixels.shape[1], pixels.shape[0])


def _flat(*colour: int) -> Picture:
    return _picture(np.full((HEIGHT, WIDTH, len(colour)), colour, np.uint8))


def _left_half(*colour: int) -> Picture:
    pixels = np.zeros((HEIGHT, WIDTH, 4), np.uint8)
    pixels[:, : WIDTH // 2] = (*colour, 255)
    return _picture(pixels)


def _video(step: int) -> Video:
    buffer = io.BytesIO()
    with av.open(buffer, "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=Fraction(FPS) / step)
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        for number in range(0, NUM_FRAMES, step):
            image = np.full((HEIGHT, WIDTH, 3), 10 * number, np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())
    return Video(buffer.getvalue(), WIDTH, HEIGHT, FPS / step, step)


def _masks(step: int):
    """Return masks whose left half is object 1."""
    archiver = MaskArchiver()
    for frame in range(0, NUM_FRAMES, step):
        labels = np.zeros((HEIGHT, WIDTH), np.uint16)
        labels[:, : WIDTH // 2] = 1
        archiver.add(frame, labels)
    return archiver.finish()


def _timelines(name: str) -> tuple[ObjectTimeline, ...]:
    thumbnails = (Thumbnail(2, _flat(200, 0, 0)), None, Thumbnail(10, _flat(0, 0, 200)))
    changes = (MaskChange(6, ChangeKind.SHRINKS, 31, False), MaskChange(11, ChangeKind.SPLITS, 2, True))
    areas = (5.0,) * 6 + (1.5,) * (NUM_FRAMES - 6)
    return (
        ObjectTimeline(f"1 {name}", "#e60000", areas, 1, changes, thumbnails, ((0, 4),)),
        ObjectTimeline("2", "#00a000", (1.0,) * 4 + (0.0,) * (NUM_FRAMES - 4), 1),
    )


def _layers() -> tuple[Layer, ...]:
    count = len(FRAMES)
    frames = tuple(_flat(*(40 + 40 * place,) * 3) for place in range(count))
    flow = tuple(_flat(0, 0, 200) if place + 1 < count else None for place in range(count))
    masks = tuple(_left_half(*OBJECT_COLOUR) for _ in FRAMES)
    wrong = tuple(_left_half(255, 160, 40) for _ in FRAMES)
    return (
        Layer("frame", LayerKind.BASE, frames, is_shown=True),
        Layer("optical flow", LayerKind.BASE, flow, key=_flat(1, 2, 3), description="To the next frame, px."),
        Layer("moving objects", LayerKind.OVER, masks, (LegendEntry("#e60000", "object 1"),), is_shown=True),
        Layer("ground truth", LayerKind.OVER, masks),
        Layer("errors", LayerKind.OVER, wrong, (LegendEntry("#ffa028", "missed"),), is_beside=True),
    )


def _matrix(title: str, size: int, labels: tuple[str, ...], is_log: bool = False) -> Matrix:
    values = np.random.default_rng(size).random((size, size)) + 0.01
    np.fill_diagonal(values, np.nan)
    return Matrix(title, values, labels, "px" if is_log else "", "Large is another motion.", is_log)


def _variants(name: str) -> tuple[VariantPanel, ...]:
    labels = ("background", "1", name)
    background, car = GroupedObject("background", 0), "2 " + name
    spectrum = np.array([1.0, 0.9, 0.2, 0.1])
    fused = VariantPanel(
        "fused",
        (background, GroupedObject("1", 1, "#e60000"), GroupedObject(car, 0)),
        (_matrix("residuals, trajs", 3, labels, is_log=True), _matrix("fused affinity", 3, labels)),
        EigenvaluePlot(spectrum, 2, "At least 0.5."),
    )
    many = tuple(map(str, range(15)))
    trajs = VariantPanel(
        "trajs",
        (background, GroupedObject("1", 0), GroupedObject(car, 1, "#00a000")),
        (_matrix("affinity, trajs", 15, many), _matrix("affinity of tracks", 50, ())),
        EigenvaluePlot(np.stack([spectrum, spectrum / 2]), 1, "The largest gap."),
        missing=("residuals: collected.",),
    )
    return fused, trajs, VariantPanel("base", (background,))


def _make_page(*names: str, video_step: int = 1) -> ReportPage:
    columns = ("variant", "P", "R", "F")
    return ReportPage(
        title="davis16: fused, trajs",
        facts=(("command", "moseg eval --dataset davis16 " * 5), ("took", "3 min 12 s")),
        notes=("The backends need no weights.",),
        scores=(
            ScoreTable("means", columns, (("fused", (78.31, 81.2, 79.4)), ("base", (43.2, 86.2, None))), over="pixels"),
            ScoreTable("the paper", columns, (("paper, fused", (99.9, 99.8, 99.7)),), True, "pixels"),
        ),
        sequences=tuple(
            SequencePanel(
                name=name,
                num_frames=NUM_FRAMES,
                shape=(HEIGHT, WIDTH),
                frames=FRAMES,
                layers=_layers(),
                objects=(ObjectRow(1, "#e60000", 1, 0, 12, 13, 6.42, name), ObjectRow(2, "#00a000", 0, 0, 3, 4, 0.5)),
                variants=_variants(name),
                video=_video(video_step),
                timelines=_timelines(name),
                masks=_masks(video_step),
            )
            for name in names
        ),
        stages=(StageRow("ingest", 26, 0, 0.0), StageRow("flow", 30, 10, 61.0), StageRow("depth", 0, 40, 0.0)),
        parameters=(ParameterRow("flow.iterations", "12", "20", f"Refinements of {names[-1]}."),),
    )


@pytest.fixture(scope="session")
def make_page() -> Callable[..., ReportPage]:
    """Make a report on sequences of the names given.

    Their pictures are flat, so that a pixel identifies frame and layer: frames grow brighter by 40 from 40, masks and
    errors cover the left half. Their video, brighter by 10 a frame, holds every `video_step`-th frame.
    """
    return _make_page


@pytest.fixture
def count_reads():
    """Wrap a store so that it counts its reads by reference and array."""
    return _Counting


@pytest.fixture
def open_report(new_page, tmp_path):
    """Open a report in a browser of the options given, and wait for its first picture."""
    numbers = count()

    def open_in(report: ReportPage, **options):
        path = tmp_path / f"report {next(numbers)} with space.html"
        path.write_text(render_page(report), encoding="utf-8")
        page = new_page(**options)
        page.goto(path.as_uri())
        if options.get("java_script_enabled", True):
            page.wait_for_selector("canvas[data-frame]")
        return page

    return open_in
