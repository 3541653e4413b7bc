"""Make the pictures of the documents: ``python docs/tools/make_pictures.py`` writes docs/images/*.webp.

They are rendered from the results of moseg on scenes of the embedded synthetic data set.
"""

import argparse
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import ArtifactStore
from moseg.tasks.flow.flow_grid import full_flow
from moseg.workflows.datasets import open_dataset
from moseg.workflows.engine.session import open_session
from moseg.workflows.exports.colour_maps import colour_soft_map
from moseg.workflows.exports.draw_flow import colour_flow
from moseg.workflows.exports.draw_overlay import draw_overlay
from moseg.workflows.exports.overlay_style import OverlayMode, OverlayStyle
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.leaves import ingest_sequences
from moseg.workflows.reports.matrices import clustering_params, fused_kernel

IMAGES = Path(__file__).resolve().parents[1] / "images"
STRIP = {"strong-parallax": 8, "two-motions": 12, "nonrigid": 8}
"""Scenes and frames of the first picture: the default pipeline."""
AFFINITIES = {"forward-drive-epipolar-car": 10, "slow-mover": 12}
"""Scenes and frames of the second: every object is given, moving or not, and so is depth."""
GIVEN = {"proposal_source": "groundtruth", "depth": {"method": "groundtruth"}}
RESULT = OverlayStyle()
NUMBERED = OverlayStyle(mode=OverlayMode.CONTOUR, has_identities=True)
VARIANT = Variant.FUSED
WIDTH, SPACE, LINE = 296, 8, 24
PAPER, INK, FAINT = (255, 255, 255), (31, 35, 40), (110, 118, 129)
LOW, HIGH = np.array([247.0, 251.0, 255.0]), np.array([8.0, 69.0, 148.0])


class Column(NamedTuple):
    """Column of a picture: the title above a panel, and the panel, uint8 (y, x, rgb)."""

    title: str
    panel: np.ndarray


def strip_columns(store: ArtifactStore, graph: SequenceGraph, config: PipelineConfig, frame: int) -> list[Column]:
    """Return the columns from the frame to the moving objects."""
    image = store.read(graph.leaves.frames[frame], "image")
    ref = graph.frame_cues.flow(frame, frame + 1)
    flow = full_flow(store.read(ref, "flow"), store.attributes(ref))
    saliency = store.read(graph.frame_cues.saliency(frame), "saliency").astype(np.float32)
    return [
        Column("frame", image),
        Column("optical flow", colour_flow(flow, float(np.hypot(flow[..., 0], flow[..., 1]).max()))),
        Column("residual of the background's motion", _resized(colour_soft_map(saliency), image.shape)),
        Column("what moves", draw_overlay(image, _result(store, graph, config, frame), RESULT)),
    ]


def affinity_columns(store: ArtifactStore, graph: SequenceGraph, config: PipelineConfig, frame: int) -> list[Column]:
    """Return the columns from the objects over each model's and the fused affinity to the moving objects."""
    image = store.read(graph.leaves.frames[frame], "image")
    section, row = divmod(frame, config.sections.length)
    identity = store.read(graph.objects.linking(), "identity")[section]
    objects = identity[store.read(graph.objects.proposals(section), "masks")[row]]
    views = config.views(VARIANT)
    refs = [graph.motions.affinity(view) for view in views]
    affinities = [store.read(ref, "affinity") for ref in refs]
    supports = [store.read(ref, "static_support") for ref in refs]
    fused = fused_kernel(affinities, supports, clustering_params(graph, VARIANT))
    names = {"trajs": "affinity: trajectories", "oc_depth": "affinity: flow model"}
    return [
        Column("objects, 0 = background", draw_overlay(image, objects.astype(np.uint16), NUMBERED)),
        *(Column(names[view], _matrix(each, image.shape[0])) for view, each in zip(views, affinities, strict=True)),
        Column("affinity: fused", _matrix(fused, image.shape[0])),
        Column("what moves", draw_overlay(image, _result(store, graph, config, frame), RESULT)),
    ]


def _result(store: ArtifactStore, graph: SequenceGraph, config: PipelineConfig, frame: int) -> np.ndarray:
    section, row = divmod(frame, config.sections.length)
    return store.read_rows(graph.segmentations(VARIANT)[section], "labels", row, row + 1)[0]


def _matrix(values: np.ndarray, side: int) -> np.ndarray:
    """Draw a matrix as squares from light, 0, to dark, 1, with their numbers."""
    margin = 16
    step = (side - margin) // len(values)
    image = Image.new("RGB", (side, side), PAPER)
    pen, font = ImageDraw.Draw(image), ImageFont.load_default(max(9, min(13, step // 3)))
    for row, line in enumerate(values):
        pen.text((margin // 2, margin + (row + 0.5) * step), str(row), FAINT, font, anchor="mm")
        pen.text((margin + (row + 0.5) * step, margin // 2), str(row), FAINT, font, anchor="mm")
        for column, value in enumerate(line):
            share = float(np.clip(np.nan_to_num(value), 0, 1))
            colour = tuple(np.rint(LOW + share * (HIGH - LOW)).astype(int).tolist())
            left, top = margin + column * step, margin + row * step
            pen.rectangle((left, top, left + step - 2, top + step - 2), colour)
            ink = PAPER if share > 0.5 else INK
            text = f"{share:.1f}" if np.isfinite(value) else "?"
            pen.text((left + step / 2 - 1, top + step / 2 - 1), text, ink, font, anchor="mm")
    return np.asarray(image)


def _resized(panel: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    return np.asarray(Image.fromarray(panel).resize((shape[1], shape[0]), Image.Resampling.BILINEAR))


def _compose(rows: dict[str, list[Column]]) -> Image.Image:
    """Draw scenes below each other, each with its name."""
    scale = WIDTH / max(column.panel.shape[1] for columns in rows.values() for column in columns)
    sizes = {
        name: [(round(c.panel.shape[1] * scale), round(c.panel.shape[0] * scale)) for c in columns]
        for name, columns in rows.items()
    }
    width = max(sum(w for w, _ in row) + SPACE * (len(row) + 1) for row in sizes.values())
    height = LINE + sum(row[0][1] + LINE for row in sizes.values()) + SPACE
    sheet = Image.new("RGB", (width, height), PAPER)
    pen, font, small = ImageDraw.Draw(sheet), ImageFont.load_default(14), ImageFont.load_default(12)
    top = LINE
    for index, (name, columns) in enumerate(rows.items()):
        left = SPACE
        for column, size in zip(columns, sizes[name], strict=True):
            if index == 0:
                pen.text((left, LINE / 2), column.title, INK, font, anchor="lm")
            sheet.paste(Image.fromarray(column.panel).resize(size, Image.Resampling.LANCZOS), (left, top))
            left += size[0] + SPACE
        top += sizes[name][0][1]
        pen.text((SPACE, top + LINE / 2 - 1), name, FAINT, small, anchor="lm")
        top += LINE
    return sheet


def _draw(session, scenes: dict[str, int], config: PipelineConfig, columns) -> Image.Image:
    dataset = open_dataset("synthetic", sequences=tuple(scenes), max_side=config.max_side)
    sources = [dataset.sequence(name) for name in scenes]
    graphs: list[SequenceGraph] = []

    def build():
        graphs[:] = [
            SequenceGraph(leaves, config) for leaves in ingest_sequences(session, sources, config, annotated=False)
        ]
        sinks = []
        for graph, frame in zip(graphs, scenes.values(), strict=True):
            sinks += [*graph.segmentations(VARIANT), *map(graph.motions.affinity, config.views(VARIANT))]
            sinks += [graph.frame_cues.flow(frame, frame + 1), graph.frame_cues.saliency(frame)]
        return {ref: recipe for graph in graphs for ref, recipe in graph.recipes.items()}, sinks

    def read():
        drawn = zip(graphs, scenes.items(), strict=True)
        return _compose({name: columns(session.store, graph, config, frame) for graph, (name, frame) in drawn})

    return session.compute(build, read)


def main() -> None:
    """Write both pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=IMAGES, help="folder of the pictures")
    parser.add_argument("--store", default=None, help="artifact store; a temporary one if none is named")
    options = parser.parse_args()
    pictures = {
        "strip.webp": (STRIP, PipelineConfig(), strip_columns),
        "affinities.webp": (AFFINITIES, PipelineConfig.model_validate(GIVEN), affinity_columns),
    }
    options.out.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory() as folder,
        open_session(options.store or f"{folder}/store", quiet=True) as session,
    ):
        for name, (scenes, config, columns) in pictures.items():
            _draw(session, scenes, config, columns).save(options.out / name, quality=80, method=6)
            print(options.out / name)


if __name__ == "__main__":
    main()
