"""Draw the graph of a sequence, one box per stage: ``python docs/tools/draw_graph.py`` writes docs/images/graph*.svg.

Boxes and arrows are read from the recipes that `moseg.workflows.graph.SequenceGraph` writes.
"""

from itertools import pairwise
from pathlib import Path
from xml.sax.saxutils import escape

from graph_layout import Edge, Layout, lay_out

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.schemas.presets import PRESETS, Choices
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.needed_weights import needed_items

IMAGES = Path(__file__).resolve().parents[1] / "images"
DRAWINGS = {
    "graph.svg": (PRESETS["weights-free"], "The graph of the default pipeline"),
    "graph_tracks.svg": ({"proposal_source": "tracks"}, "The graph with objects of dense tracks"),
    "graph_cameras.svg": (
        {"proposal_source": "tracks", "cameras": {"method": "depth-anything-3"}},
        "The graph with objects of dense tracks and cameras from a network",
    ),
    "graph_networks.svg": (PRESETS["paper"], "The graph with objects, points, flow and depth from networks"),
}
"""Parameters that differ from their defaults, and title, of each drawing."""

PARTS = {
    "from outside": ("frame", "annotation", "weights", "motion_weights"),
    "cues": ("flow", "depth", "background", "saliency", "motion_network"),
    "what moves": (
        *("consistency", "accumulation", "motion_memory", "own_motion", "coherence", "appearance", "foreground"),
        "components",
        *("dense_tracks", "cameras", "rigidity", "moving_tracks", "track_surfaces", "track_groups", "track_objects"),
        "object_points",
    ),
    "objects": (
        "tags",
        "detections",
        "motion_prompts",
        "instances",
        "seeds",
        "proposals",
        "sightings",
        "linking",
        "tracks",
    ),
    "motions": (
        *("fundamental", "fundamental_residual", "flow_model", "flow_residual", "affinity"),
        *("rigid_support", "clustering"),
    ),
    "results": ("segmentation", "moves_now", "confidence", "score"),
}
"""Stages by part; the part sets the colour of a box."""
UNITS = {
    "frame": "file content",
    "annotation": "file content",
    "weights": "files of a network",
    "motion_weights": "our own network",
    "flow": "a pair and direction",
    "background": "64 frames",
    "saliency": "a frame",
    "motion_network": "a frame",
    "depth": "a frame",
    "tags": "first frame of a section",
    "detections": "first frame of a section",
    "motion_prompts": "first frame of a section",
    "instances": "first frame of a section",
    "linking": "the sequence",
    "affinity": "the sequence and model",
    "clustering": "the sequence and variant",
    "segmentation": "a section and variant",
    "score": "the sequence and variant",
}
"""Unit of one artifact, for stages whose unit is not a section."""

HANDED_ON = {("proposals", "seeds")}
"""Edges from a section to the next one, except those from a stage to itself; drawn upwards."""

BOX, HEIGHT, STEP, MARGIN, HEAD, KEY = 172.0, 38.0, 66.0, 24.0, 74.0, 106.0
"""Sizes and distances, px."""
STYLE = """
  .page { fill: #ffffff; } .text { fill: #1b1f24; } .unit, .key { fill: #57606a; }
  .box { stroke-width: 1.5; } .edge { fill: none; stroke: #6e7781; stroke-width: 1.4; }
  .from-frame, .from-weights { stroke: #afb8c1; stroke-width: 1.1; } .head { fill: #6e7781; }
  .part0 { fill: #f0f2f4; stroke: #8c959f; } .part1 { fill: #ddf1ff; stroke: #2f81c7; }
  .part2 { fill: #e3f6e5; stroke: #3c9a50; } .part3 { fill: #fff3cf; stroke: #b58407; }
  .part4 { fill: #fbe4ec; stroke: #c2487a; } .part5 { fill: #ece4fb; stroke: #7d52c4; }
  @media (prefers-color-scheme: dark) {
    .page { fill: #0d1117; } .text { fill: #e6edf3; } .unit, .key { fill: #9aa4ae; }
    .edge { stroke: #8b949e; } .from-frame, .from-weights { stroke: #4a525b; } .head { fill: #8b949e; }
    .part0 { fill: #21262d; } .part1 { fill: #10304a; } .part2 { fill: #12351c; }
    .part3 { fill: #3d2f06; } .part4 { fill: #43182b; } .part5 { fill: #2b1d4a; }
  }
"""


def stage_edges(changes: Choices) -> list[Edge]:
    """Return the edges between the stages of the fused variant and its score, and the leaves that they read."""
    config = PipelineConfig.model_validate({**changes, "sections": {"length": 4, "overlap": 1}})
    graph = SequenceGraph(_leaves(config), config)
    graph.score(Variant.FUSED)
    return sorted(
        {(ref.partition("/")[0], recipe.task) for recipe in graph.recipes.values() for ref in recipe.input_refs()}
    )


def draw(changes: Choices, title: str) -> str:
    """Return the drawing as SVG, readable on light and dark pages."""
    edges = stage_edges(changes)
    stages = sorted({stage for edge in edges for stage in edge})
    layout = lay_out(
        [e for e in edges if e[0] != e[1] and e not in HANDED_ON], dict.fromkeys(stages, BOX), gap=14, lane=6
    )
    width = max(*(x + BOX / 2 for x in layout.x.values()), *(x for r in layout.routes.values() for x, _ in r))
    parts = [(index, part) for index, part in enumerate(PARTS) if {*PARTS[part]} & {*stages}]
    width = max(width, KEY * len(parts)) + 2 * MARGIN
    height = HEAD + STEP * (max(layout.rows.values()) + 1) + MARGIN
    drawn = [_edge(edge, layout.routes[edge], _end(edge, layout)) for edge in layout.routes]
    drawn += [_upwards(edge, layout) for edge in edges if edge[0] == edge[1] or edge in HANDED_ON]
    drawn += [_box(stage, layout.x[stage], layout.rows[stage]) for stage in stages]
    drawn += [_key(place, index, part) for place, (index, part) in enumerate(parts)]
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}"'
            f' width="{width:.0f}" height="{height:.0f}"'
            ' font-family="system-ui, sans-serif" role="img">',
            f"<title>{escape(title)}</title>",
            f"<style>{STYLE}</style>",
            '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7"'
            ' orient="auto">'
            '<path class="head" d="M0 0L8 4L0 8z"/></marker></defs>',
            f'<rect class="page" width="{width:.0f}" height="{height:.0f}" rx="8"/>',
            f'<text class="text" x="{MARGIN:.0f}" y="30" font-size="16" font-weight="600">{escape(title)}</text>',
            *drawn,
            "</svg>\n",
        ]
    )


def _leaves(config: PipelineConfig) -> SequenceLeaves:
    def refs(task: str, count: int) -> tuple[str, ...]:
        return tuple(f"{task}/{digest_bytes('drawing', f'{task} {index}'.encode())}" for index in range(count))

    return SequenceLeaves(
        name="drawing",
        shape=(48, 64),
        frames=refs("frame", 9),
        annotation=refs("annotation", 1)[0],
        num_motions=2,
        motion_weights=refs("motion_weights", 1)[0],
        weights={item: refs("weights", 1)[0] for item in needed_items(config)},
    )


def _top(row: int) -> float:
    return HEAD + STEP * row


def _box(stage: str, x: float, row: int) -> str:
    part = next(index for index, names in enumerate(PARTS.values()) if stage in names)
    left, top = MARGIN + x - BOX / 2, _top(row)
    unit = UNITS.get(stage, "a section")
    return (
        f'<g data-stage="{stage}"><rect class="box part{part}" x="{left:.1f}" y="{top:.1f}" width="{BOX:.0f}"'
        f' height="{HEIGHT:.0f}" rx="6"/>'
        f'<text class="text" x="{left + BOX / 2:.1f}" y="{top + 16:.1f}" font-size="13" font-weight="600"'
        f' text-anchor="middle">{stage}</text>'
        f'<text class="unit" x="{left + BOX / 2:.1f}" y="{top + 31:.1f}" font-size="11"'
        f' text-anchor="middle">{unit}</text>'
        "</g>"
    )


def _end(edge: Edge, layout: Layout) -> float:
    """Return the end of an arrow relative to the middle of its box; arrows into one box end side by side."""
    into = sorted((route[-2][0], other) for other, route in layout.routes.items() if other[1] == edge[1])
    place = [other for _, other in into].index(edge) - (len(into) - 1) / 2
    return place * min(28.0, (BOX - 24) / len(into))


def _edge(edge: Edge, route: list[tuple[float, int]], end: float) -> str:
    (x0, row0), *between, (x1, row1) = route
    points = [(x0, _top(row0) + HEIGHT)]
    for x, row in between:
        points += [(x, _top(row) - 4), (x, _top(row) + HEIGHT + 4)]
    points.append((x1 + end, _top(row1)))
    path = f"M{MARGIN + points[0][0]:.1f} {points[0][1]:.1f}"
    for (xa, ya), (xb, yb) in pairwise(points):
        bend = (yb - ya) / 2
        path += f"C{MARGIN + xa:.1f} {ya + bend:.1f} {MARGIN + xb:.1f} {yb - bend:.1f} {MARGIN + xb:.1f} {yb:.1f}"
    return f'<path class="edge from-{edge[0]}" data-edge="{edge[0]} {edge[1]}" marker-end="url(#head)" d="{path}"/>'


def _upwards(edge: Edge, layout: Layout) -> str:
    """Return the edges from one section to the next as SVG."""
    source, target = edge
    x0, y0 = MARGIN + layout.x[source] + BOX / 2, _top(layout.rows[source]) + HEIGHT - 10
    x1, y1 = MARGIN + layout.x[target] + BOX / 2, _top(layout.rows[target]) + 10
    out = max(x0, x1) + 26
    path = f"M{x0:.1f} {y0:.1f}C{out:.1f} {y0 + 8:.1f} {out:.1f} {y1 - 8:.1f} {x1 + 1:.1f} {y1:.1f}"
    return f'<path class="edge" data-edge="{source} {target}" marker-end="url(#head)" d="{path}"/>'


def _key(place: int, index: int, part: str) -> str:
    x = MARGIN + KEY * place
    return (
        f'<rect class="box part{index}" x="{x:.0f}" y="44" width="14" height="14" rx="3"/>'
        f'<text class="key" x="{x + 20:.0f}" y="55.5" font-size="12">{part}</text>'
    )


def main() -> None:
    """Write all drawings."""
    IMAGES.mkdir(exist_ok=True)
    for name, (changes, title) in DRAWINGS.items():
        (IMAGES / name).write_text(draw(changes, title), encoding="utf-8")
        print(IMAGES / name)


if __name__ == "__main__":
    main()
