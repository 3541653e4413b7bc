"""Draw the errors on disturbed trajectories: ``python docs/tools/draw_curves.py [--out FILE]``.

Reads ``benchmarks/results/apart/robustness.json``, the file of ``benchmarks/trajectories/robustness.py``, and writes
``docs/images/robustness.svg``: one diagram for each disturbance, with the mean and the median error over clips.
"""

import argparse
import json
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RESULT = ROOT / "benchmarks" / "results" / "apart" / "robustness.json"
IMAGE = ROOT / "docs" / "images" / "robustness.svg"
TITLES = {
    "outliers": ("random tracks added, % of all", 100.0),
    "noise": ("noise added, px", 1.0),
    "missing": ("missing entries, %", 100.0),
}
"""Title of each disturbance's axis, and the factor of its strengths."""
LINES = {"error": "mean", "median_error": "median"}
WIDTH, HEIGHT, LEFT, TOP, GAP = 200.0, 150.0, 48.0, 46.0, 34.0
"""Size of a diagram, margins and space between diagrams, px."""
STYLE = """
  .page { fill: #ffffff; } text { fill: #1b1f24; } .axis { stroke: #8c959f; fill: none; } .grid { stroke: #e3e6e9; }
  .error { stroke: #2f81c7; fill: none; stroke-width: 2; }
  .median_error { stroke: #b58407; fill: none; stroke-width: 2; }
  circle.error { fill: #2f81c7; } circle.median_error { fill: #b58407; }
  @media (prefers-color-scheme: dark) {
    .page { fill: #0d1117; } text { fill: #e6edf3; } .axis { stroke: #8b949e; } .grid { stroke: #21262d; }
  }
"""


Curve = dict[str, dict[str, float]]
"""Figures by strength."""


def draw(curves: dict[str, Curve], clips: int) -> str:
    """Return the picture as SVG."""
    highest = max(point["error"] for curve in curves.values() for point in curve.values())
    top = max(5.0, 5.0 * -(-highest // 5))
    width, height = LEFT + len(curves) * (WIDTH + GAP), TOP + HEIGHT + 52
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" '
        f'height="{height:.0f}" font-family="system-ui, sans-serif" font-size="11" role="img">',
        f"<title>Errors on disturbed trajectories of {clips} sequences</title><style>{STYLE}</style>",
        f'<rect class="page" width="{width:.0f}" height="{height:.0f}" rx="8"/>',
        f'<text x="{LEFT}" y="20" font-size="13" font-weight="600">misclassified trajectories, %</text>',
    ]
    for index, (key, label) in enumerate(LINES.items()):
        x = LEFT + 260 + 90 * index
        parts.append(f'<path class="{key}" d="M{x} 16h22"/><text x="{x + 28}" y="20">{label}</text>')
    for index, (name, curve) in enumerate(curves.items()):
        parts.extend(_diagram(name, curve, LEFT + index * (WIDTH + GAP), top, has_labels=index == 0))
    return "\n".join([*parts, "</svg>\n"])


def _diagram(name: str, curve: Curve, left: float, top: float, has_labels: bool) -> list[str]:
    title, factor = TITLES[name]
    bottom, last = TOP + HEIGHT, max(map(float, curve))

    def place(strength: str, key: str) -> str:
        return f"{left + WIDTH * float(strength) / last:.1f} {bottom - HEIGHT * curve[strength][key] / top:.1f}"

    parts = []
    for step in range(6):
        y, value = bottom - HEIGHT * step / 5, top * step / 5
        parts.append(f'<path class="grid" d="M{left} {y:.1f}h{WIDTH}"/>')
        if has_labels:
            parts.append(f'<text x="{left - 6}" y="{y + 4:.1f}" text-anchor="end">{value:g}</text>')
    for strength in curve:
        x = left + WIDTH * float(strength) / last
        parts.append(f'<text x="{x:.1f}" y="{bottom + 16}" text-anchor="middle">{factor * float(strength):g}</text>')
    for key in LINES:
        parts.append(f'<path class="{key}" d="M{" L".join(place(strength, key) for strength in curve)}"/>')
        for strength in curve:
            x, y = place(strength, key).split()
            parts.append(f'<circle class="{key}" cx="{x}" cy="{y}" r="2.5"/>')
    parts.append(f'<path class="axis" d="M{left} {TOP}v{HEIGHT}h{WIDTH}"/>')
    parts.append(f'<text x="{left + WIDTH / 2}" y="{bottom + 36}" text-anchor="middle">{title}</text>')
    return parts


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=IMAGE)
    options = parser.parse_args()
    result = json.loads(RESULT.read_text(encoding="utf-8"))["result"]
    options.out.write_text(draw(result["curves"], result["clips"]), encoding="utf-8")
    print(options.out)


if __name__ == "__main__":
    main()
