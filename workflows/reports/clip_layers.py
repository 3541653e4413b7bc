"""Layers of a clip of labelled trajectories: points on a blank picture, because there are no images."""

from collections.abc import Sequence

import numpy as np

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant
from moseg.store import ArtifactStore
from moseg.workflows.exports.draw_errors import ERROR_COLOURS
from moseg.workflows.exports.draw_tracks import TAIL_FRAMES, DrawnPoints, draw_tracks
from moseg.workflows.graph import TrajectoryGraph
from moseg.workflows.reports.content import Layer, LayerKind, LegendEntry, SequencePanel
from moseg.workflows.reports.layers import PlannedLayer, as_hex, encode_opaque, encode_transparent, make_layers
from moseg.workflows.reports.missing import WhyAbsent, format_missing, name_absent
from moseg.workflows.results.shown_frames import spread
from moseg.workflows.sources.resize import working_size

CLIP_SIDE = 960
"""Longer side of a clip's pictures, px: hundreds of points can lie on one car, and blank pictures are small files."""
CANVAS = (24, 26, 30)
"""RGB of the blank picture."""
POINT_RADIUS = 2.5
MOTION_COLOURS = np.array(
    [
        *((86, 180, 233), (230, 159, 0), (0, 158, 115), (240, 228, 66)),
        *((213, 94, 0), (204, 121, 167), (0, 114, 178), (200, 200, 200)),
    ],
    np.uint8,
)
"""The palette of Okabe and Ito for colour-blind readers, with grey in place of black, which the dark picture would
hide; beyond eight motions colours repeat."""
_TAILS = f"Tails reach back {TAIL_FRAMES} frames."
RIGHT_COLOUR, WRONG_COLOUR = (150, 150, 150), ERROR_COLOURS["false positive"]
UNLABELLED_COLOUR = (80, 80, 80)
"""Of trajectories without a label, which are not scored."""


def gather_clip_pictures(
    store: ArtifactStore,
    graph: TrajectoryGraph,
    config: PipelineConfig,
    variants: Sequence[TrajectoryVariant],
    num_frames: int,
    why_absent: WhyAbsent = WhyAbsent.GONE,
) -> SequencePanel:
    """Gather the panel of a clip without its variants: at most `num_frames` frames, no objects, no video.

    Parameters
    ----------
    why_absent : WhyAbsent
        Reason that is given for artifacts that are not stored; without its points a clip has no frames and no size.

    Raises
    ------
    CorruptArtifactError
        An artifact's bytes are not those committed.
    """
    leaves = graph.leaves
    if not store.has(leaves.trajectories):
        absent = name_absent("the clip", [leaves.trajectories])
        return SequencePanel(leaves.name, 0, (0, 0), (), (), missing=format_missing([absent], why_absent))
    clip = _Clip(store, graph, num_frames)
    layers = [
        PlannedLayer("points", (), clip.make_canvas),
        *(
            PlannedLayer(
                f"motions ({variant})",
                (leaves.labels, graph.clustering(variant)),
                lambda variant=variant: clip.make_motions(variant, is_shown=variant == variants[0]),
            )
            for variant in variants
        ),
        PlannedLayer("ground truth", (leaves.labels,), clip.make_truth),
        *(
            PlannedLayer(
                f"errors ({variant})",
                (leaves.labels, graph.clustering(variant)),
                lambda variant=variant: clip.make_errors(variant),
            )
            for variant in variants
        ),
    ]
    made, missing = make_layers(store, layers)
    missing = format_missing(missing, why_absent)
    return SequencePanel(leaves.name, clip.num_frames, clip.size, clip.frames, made, missing=missing)


def clip_extent(points: np.ndarray, visible: np.ndarray) -> tuple[int, int]:
    """Return height and width, px, of a picture that begins at pixel 0 and holds all visible points (N, F, xy)."""
    farthest = points[visible].max(axis=0, initial=0)
    width, height = (int(np.floor(side + 0.5)) + 1 for side in farthest)
    return height, width


def match_groups(predicted: np.ndarray, truth: np.ndarray) -> dict[int, int]:
    """Return the label of each matched group, by the matching that is scored; integers (N,) both.

    A trajectory of label 0 has no label and does not count.
    """
    # Here, because other reports and evaluations do not need SciPy.
    from scipy.optimize import linear_sum_assignment

    # `clustering_error` returns only a count. Sharing the matching would change the code that is in the keys of scores;
    # a test compares the two.
    groups, group_index = np.unique(predicted[truth > 0], return_inverse=True)
    labels, label_index = np.unique(truth[truth > 0], return_inverse=True)
    shared = np.zeros((len(groups), len(labels)), np.int64)
    np.add.at(shared, (group_index, label_index), 1)
    rows, columns = linear_sum_assignment(shared, maximize=True)
    return {int(groups[row]): int(labels[column]) for row, column in zip(rows, columns, strict=True)}


class _Clip:
    """A clip's points and their layers."""

    def __init__(self, store: ArtifactStore, graph: TrajectoryGraph, num_frames: int):
        self._store, self._graph = store, graph
        self._points, self._visible = (store.read(graph.leaves.trajectories, name) for name in ("points", "visible"))
        self.size = clip_extent(self._points, self._visible)
        self._shape = working_size(self.size, CLIP_SIDE)
        self.num_frames = self._visible.shape[1]
        self.frames = spread(self.num_frames, num_frames)

    def make_canvas(self) -> Layer:
        blank = encode_opaque(np.broadcast_to(np.array(CANVAS, np.uint8), (*self._shape, 3)).copy())
        height, width = self.size
        description = f"The clip has no images: {width}x{height} px that hold all its points."
        return Layer("points", LayerKind.BASE, (blank,) * len(self.frames), description=description, is_shown=True)

    def make_motions(self, variant: TrajectoryVariant, is_shown: bool) -> Layer:
        labels, groups = self._labels(), self._groups(variant)
        places = {label: place for place, label in enumerate(np.unique(labels[labels > 0]).tolist())}
        matched = match_groups(groups, labels)
        entries, colours = [], np.zeros((len(groups), 3), np.uint8)
        num_extra = 0
        for group in np.unique(groups).tolist():
            if group in matched:
                place = places[matched[group]]
                meaning = f"motion {group}, matched with label {matched[group]}"
            else:
                place, num_extra = len(places) + num_extra, num_extra + 1
                meaning = f"motion {group}, matched with no label"
            colours[groups == group] = MOTION_COLOURS[place % len(MOTION_COLOURS)]
            entries.append(_describe(place, meaning, groups == group))
        description = (
            "Trajectories by the motion group that was found; a group has the colour of the label it is matched with."
            f" {_TAILS}"
        )
        return self._draw(f"motions ({variant})", colours, tuple(entries), description, is_shown=is_shown)

    def make_truth(self) -> Layer:
        labels = self._labels()
        names = np.unique(labels[labels > 0])
        legend = tuple(_describe(place, f"label {name}", labels == name) for place, name in enumerate(names.tolist()))
        colours = MOTION_COLOURS[np.searchsorted(names, labels) % len(MOTION_COLOURS)]
        colours[labels == 0] = UNLABELLED_COLOUR
        legend += _describe_unlabelled(labels)
        return self._draw("ground truth", colours, legend, f"Trajectories by their true motion. {_TAILS}")

    def make_errors(self, variant: TrajectoryVariant) -> Layer:
        labels, groups = self._labels(), self._groups(variant)
        matched = match_groups(groups, labels)
        wrong = np.array([matched.get(group) for group in groups.tolist()], dtype=object) != labels
        scored = labels > 0
        wrong = wrong.astype(bool) & scored
        colours = np.where(wrong[:, None], np.array(WRONG_COLOUR, np.uint8), np.array(RIGHT_COLOUR, np.uint8))
        colours[~scored] = UNLABELLED_COLOUR
        legend = (
            LegendEntry(as_hex(RIGHT_COLOUR), f"right: {_count(scored & ~wrong)}"),
            LegendEntry(as_hex(WRONG_COLOUR), f"wrong: {_count(wrong)}"),
            *_describe_unlabelled(labels),
        )
        description = "Trajectories outside the group of their label, under the best matching of groups and labels."
        order = np.argsort(wrong, kind="stable")
        return self._draw(f"errors ({variant})", colours, legend, description, order=order)._replace(is_beside=True)

    def _draw(
        self,
        name: str,
        colours: np.ndarray,
        legend: tuple[LegendEntry, ...],
        description: str,
        is_shown: bool = False,
        order: np.ndarray | slice = slice(None),
    ) -> Layer:
        drawn = DrawnPoints(self._points[order], self._visible[order], colours[order], self.size)
        pictures = tuple(
            encode_transparent(draw_tracks(drawn.until(frame), self._shape, POINT_RADIUS)) for frame in self.frames
        )
        return Layer(name, LayerKind.OVER, pictures, legend, description=description, is_shown=is_shown)

    def _labels(self) -> np.ndarray:
        return self._store.read(self._graph.leaves.labels, "labels")

    def _groups(self, variant: TrajectoryVariant) -> np.ndarray:
        return self._store.read(self._graph.clustering(variant), "motion")


def _describe(place: int, meaning: str, members: np.ndarray) -> LegendEntry:
    return LegendEntry(as_hex(MOTION_COLOURS[place % len(MOTION_COLOURS)]), f"{meaning}: {_count(members)}")


def _describe_unlabelled(labels: np.ndarray) -> tuple[LegendEntry, ...]:
    """Return the entry of the trajectories that are not scored, if there are any."""
    unlabelled = labels == 0
    meaning = f"no label, not scored: {_count(unlabelled)}"
    return (LegendEntry(as_hex(UNLABELLED_COLOUR), meaning),) if unlabelled.any() else ()


def _count(members: np.ndarray) -> str:
    count = int(np.count_nonzero(members))
    return f"{count} " + ("trajectory" if count == 1 else "trajectories")
