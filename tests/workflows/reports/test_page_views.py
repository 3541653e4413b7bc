"""Numbers, matrices, plots and tables as a page lays them out."""

import numpy as np
import pytest

from moseg.workflows.reports.content import (
    Better,
    EigenvaluePlot,
    Layer,
    LayerKind,
    Matrix,
    ScoreTable,
)
from moseg.workflows.reports.page.eigenvalue_plots import gather_plot
from moseg.workflows.reports.page.heat_maps import gather_heat_map
from moseg.workflows.reports.page.numbers import duration, short_number
from moseg.workflows.reports.page.table_layout import lay_out_tables
from moseg.workflows.reports.page.viewer import choose_panes


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (1.0, "1"),
        (0.04213, "0.0421"),
        (303.4, "303"),
        (100.0, "100"),
        (-2.5, "−2.5"),
        (1.234e-5, "1.23e−5"),
        (2e7, "2e7"),
        (np.inf, "∞"),
        (np.nan, "–"),
    ],
)
def test_numbers_are_short(value, text):
    assert short_number(value) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.08, "80 ms"),
        (0.9999, "1.0 s"),
        (4.24, "4.2 s"),
        (59.99, "1 min 00 s"),
        (185, "3 min 05 s"),
        (7790, "2 h 10 min"),
    ],
)
def test_durations_have_units_that_suit_their_length(seconds, text):
    assert duration(seconds) == text


def test_colours_of_residuals_follow_their_logarithm():
    values = np.array([[np.nan, 1.0], [10.0, 100.0]])
    linear = gather_heat_map(Matrix("m", values, ("a", "b")))
    log = gather_heat_map(Matrix("m", values, ("a", "b"), is_log=True))
    assert [cell.step for row in log.cells for cell in row] == [-1, 0, 32, 63]
    assert [cell.step for row in linear.cells for cell in row] == [-1, 0, 5, 63]
    assert log.ticks == ("1", "10", "100") and linear.ticks == ("1", "50.5", "100")
    assert log.cells[0][0].text == "–" and log.has_missing


@pytest.mark.parametrize("is_log", [False, True])
@pytest.mark.parametrize("value", [0.0, 3.0, np.nan, np.inf])
def test_a_matrix_of_one_value_is_shown(value, is_log):
    heat_map = gather_heat_map(Matrix("m", np.full((2, 2), value), ("a", "b"), is_log=is_log))
    assert {cell.text for row in heat_map.cells for cell in row} == {short_number(value)}


def test_zeros_and_infinities_lie_at_the_ends_of_a_logarithmic_scale():
    heat_map = gather_heat_map(Matrix("m", np.array([[0.0, 1.0], [10.0, np.inf]]), ("a", "b"), is_log=True))
    assert [cell.step for row in heat_map.cells for cell in row] == [0, 0, 63, 63]


def test_a_matrix_too_large_for_cells_is_a_picture():
    labels = tuple(map(str, range(41)))
    assert gather_heat_map(Matrix("m", np.eye(40), labels[:40])).picture is None
    assert gather_heat_map(Matrix("m", np.eye(41), labels)).picture.startswith("data:image/png;base64,")
    assert gather_heat_map(Matrix("m", np.eye(3), ())).cells == ()
    assert gather_heat_map(Matrix("m", np.zeros((0, 0)), ())).picture is None


def test_eigenvalues_keep_their_order_and_stay_within_the_axes():
    plot = gather_plot(EigenvaluePlot(np.array([0.0, 0.1, np.nan, 0.9]), 2, "how"))
    (points,) = plot.series
    assert [point.is_chosen for point in points] == [True, True, False]
    assert points[1].x < plot.chosen_x < points[2].x
    heights = [point.y for point in points]
    assert heights == sorted(heights, reverse=True)
    assert plot.top <= min(heights) and max(heights) <= plot.bottom


def test_a_long_spectrum_is_cut_and_an_empty_one_not_drawn():
    plot = gather_plot(EigenvaluePlot(np.linspace(1, 0, 300), 3, "how"))
    assert (len(plot.series[0]), plot.num_eigenvalues) == (40, 300)
    assert gather_plot(EigenvaluePlot(np.array([]), 1, "how")) is None
    assert gather_plot(EigenvaluePlot(np.zeros(3), 1, "how")).y_ticks


def _best(table: ScoreTable) -> list[str]:
    return [cell.text for _, row in lay_out_tables((table,))[0].groups[0].rows for cell in row if cell.is_best]


def test_the_best_is_the_smallest_where_less_is_better():
    rows = (("a", (5.0, 1.0, 3.0)), ("b", (4.0, 2.0, 3.0)))
    better = (Better.LESS, None, Better.MORE)
    table = ScoreTable("t", ("variant", "error", "motions", "F"), rows, better=better, decimals=(1, 0, 1))
    assert _best(table) == ["4.0"]


def test_neither_sequences_nor_published_figures_are_compared():
    rows = (("a", (5.0,)), ("b", (4.0,)))
    assert _best(ScoreTable("t", ("sequence", "F"), rows)) == []
    assert _best(ScoreTable("t", ("method", "F"), rows, is_published=True)) == []
    assert _best(ScoreTable("t", ("variant", "F"), rows)) == ["5.0"]


def test_published_figures_over_something_else_have_a_table_of_their_own():
    measured = ScoreTable("m", ("variant", "F"), (("a", (5.0,)),), over="points")
    published = ScoreTable("p", ("method", "F"), (("b", (4.0,)),), is_published=True, over="pixels")
    assert len(lay_out_tables((measured, published))) == 2
    assert len(lay_out_tables((measured._replace(over="pixels"), published))) == 1


def test_many_rows_of_single_scenes_are_folded_after_their_means():
    means = ScoreTable("means", ("variant", "F"), (("a", (5.0,)),))
    scenes = [ScoreTable(name, ("sequence", "F"), tuple((str(n), (5.0,)) for n in range(9))) for name in "ab"]
    published = ScoreTable("p", ("method", "error"), (("b", (4.0,)),), is_published=True)
    views = lay_out_tables((means, *scenes, published))
    assert [(view.groups[0].title, view.is_folded) for view in views] == [
        ("means", False),
        ("p", False),
        ("a", True),
        ("b", True),
    ]
    assert not any(view.is_folded for view in lay_out_tables((means, scenes[0])))


def test_the_second_pane_shows_the_layer_that_lies_beside():
    frame = Layer("frame", LayerKind.BASE, (None,), is_shown=True)
    flow, mask = Layer("flow", LayerKind.BASE, (None,)), Layer("mask", LayerKind.OVER, (None,), is_shown=True)
    truth, errors = Layer("truth", LayerKind.OVER, (None,)), Layer("errors", LayerKind.OVER, (None,), is_beside=True)
    assert choose_panes((frame, mask, truth, errors))[1] == (0, {3})
    assert choose_panes((frame, mask, truth))[1] == (0, {2})
    assert choose_panes((frame, flow, mask))[1] == (1, set())
    assert choose_panes((frame,)) == ((0, set()), (0, set()))
    assert choose_panes(()) == ()


def test_the_diagonal_does_not_set_the_scale_of_a_picture():
    values = np.linspace(0, 0.1, 41 * 41).reshape(41, 41)
    np.fill_diagonal(values, 1)
    heat_map = gather_heat_map(Matrix("m", values, ()))
    assert heat_map.is_cut and 0.09 < float(heat_map.ticks[-1]) < 0.1
    assert not gather_heat_map(Matrix("m", values, (), is_log=True)).is_cut
    assert not gather_heat_map(Matrix("m", values[:3, :3], ("a", "b", "c"))).is_cut
