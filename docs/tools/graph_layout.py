"""Layered drawing of a directed acyclic graph: the rows of the nodes, and the routes of the edges between them.

References
----------
K. Sugiyama, S. Tagawa and M. Toda, "Methods for visual understanding of hierarchical system structures", IEEE
Transactions on Systems, Man, and Cybernetics, 1981.
"""

from collections.abc import Mapping
from itertools import pairwise
from typing import NamedTuple

Edge = tuple[str, str]

NUM_SWEEPS = 40
STIFFNESS = 8
"""Weight of the alignment of the parts of one edge, relative to other alignments."""


class Layout(NamedTuple):
    """Positions of nodes and edges in the drawing.

    Attributes
    ----------
    rows : dict of str to int
        Row of each node, 0 at the top.
    x : dict of str to float
        Horizontal centre of each node, px.
    routes : dict of edge to list of (float, int)
        The (x, row) of each edge in every row from its source to its target.
    """

    rows: dict[str, int]
    x: dict[str, float]
    routes: dict[Edge, list[tuple[float, int]]]


def lay_out(edges: list[Edge], widths: Mapping[str, float], gap: float, lane: float) -> Layout:
    """Lay out a graph: rows by longest path, order by barycentres, positions by relaxation.

    Parameters
    ----------
    edges : list of (source, target)
        The graph has no cycles.
    widths : mapping of str to float
        Width of each node, px.
    gap : float
        Minimum space between two neighbours, px.
    lane : float
        Width of an edge that passes a row, px.
    """
    rows = _rows(edges)
    links, chains, width = [], {}, dict(widths)
    levels: list[list[str]] = [[] for _ in range(max(rows.values()) + 1)]
    for node in sorted(rows, key=lambda node: (rows[node], node)):
        levels[rows[node]].append(node)
    for source, target in sorted(edges):
        chain = [source]
        for row in range(rows[source] + 1, rows[target]):
            bend = f"{source}>{target}@{row}"
            width[bend] = lane
            levels[row].append(bend)
            chain.append(bend)
        chain.append(target)
        chains[source, target] = chain
        links += pairwise(chain)
    near = {node: ([], []) for level in levels for node in level}
    for upper, lower in links:
        near[lower][0].append(upper)
        near[upper][1].append(lower)
    _order(levels, near)
    x = _place(levels, near, width, gap)
    row_of = {node: row for row, level in enumerate(levels) for node in level}
    routes = {edge: [(x[node], row_of[node]) for node in chain] for edge, chain in chains.items()}
    return Layout(rows, {node: x[node] for node in rows}, routes)


def _rows(edges: list[Edge]) -> dict[str, int]:
    """Place each node below all that it reads, and a node that reads nothing right above its first reader."""
    above: dict[str, list[str]] = {node: [] for edge in edges for node in edge}
    for source, target in edges:
        above[target].append(source)
    rows: dict[str, int] = {}

    def row(node: str) -> int:
        if node not in rows:
            rows[node] = 1 + max((row(source) for source in above[node]), default=-1)
        return rows[node]

    for node in above:
        row(node)
    for node in above:
        if not above[node]:
            rows[node] = min(rows[target] for source, target in edges if source == node) - 1
    return rows


def _order(levels: list[list[str]], near: Mapping[str, tuple[list[str], list[str]]]) -> None:
    """Sort each row by its neighbours' mean place, sweeping down and up; return the order with fewest crossings."""
    best, fewest = [list(level) for level in levels], _crossings(levels, near)
    for sweep in range(NUM_SWEEPS):
        side = sweep % 2
        for level in levels[1:] if side == 0 else levels[-2::-1]:
            place = {node: index for other in levels for index, node in enumerate(other)}
            here = {node: index for index, node in enumerate(level)}
            means = {
                node: sum(place[n] for n in near[node][side]) / len(near[node][side])
                if near[node][side]
                else here[node]
                for node in level
            }
            level.sort(key=lambda node, means=means, here=here: (means[node], here[node]))
        crossings = _crossings(levels, near)
        if crossings < fewest:
            best, fewest = [list(level) for level in levels], crossings
    for level, order in zip(levels, best, strict=True):
        level[:] = order


def _crossings(levels: list[list[str]], near: Mapping[str, tuple[list[str], list[str]]]) -> int:
    place = {node: index for level in levels for index, node in enumerate(level)}
    count = 0
    for level in levels[:-1]:
        ends = [(place[node], place[lower]) for node in level for lower in near[node][1]]
        count += sum(a0 < b0 and a1 > b1 for a0, a1 in ends for b0, b1 in ends)
    return count


def _place(levels, near, width, gap: float) -> dict[str, float]:
    """Move each node towards its neighbours as far as the order of its row allows."""
    x: dict[str, float] = {}
    for level in levels:
        at = 0.0
        for node in level:
            x[node] = at + width[node] / 2
            at += width[node] + gap
        for node in level:
            x[node] -= at / 2
    for _ in range(300):
        for level in levels:
            wanted = {}
            for node in level:
                pulls = [(STIFFNESS if ">" in node and ">" in n else 1, x[n]) for n in near[node][0] + near[node][1]]
                # A weak pull to the middle keeps the drawing upright.
                pulls += [] if ">" in node else [(1, 0.0)]
                wanted[node] = sum(pull * place for pull, place in pulls) / sum(pull for pull, _ in pulls)
            _spread(level, wanted, x, width, gap)
    left = min(x[node] - width[node] / 2 for node in x)
    return {node: place - left for node, place in x.items()}


def _spread(level, wanted, x, width, gap: float) -> None:
    """Return the places nearest to the wanted ones, in least squares, that keep order and distance, by pooling."""
    blocks: list[tuple[float, int]] = []
    offset, offsets = 0.0, []
    for index, node in enumerate(level):
        if index:
            offset += (width[level[index - 1]] + width[node]) / 2 + gap
        offsets.append(offset)
        blocks.append((wanted[node] - offset, 1))
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            (mean1, count1), (mean0, count0) = blocks.pop(), blocks.pop()
            blocks.append(((mean0 * count0 + mean1 * count1) / (count0 + count1), count0 + count1))
    places = [mean for mean, count in blocks for _ in range(count)]
    for node, place, shift in zip(level, places, offsets, strict=True):
        x[node] = place + shift
