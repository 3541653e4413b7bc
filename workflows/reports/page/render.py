"""A report rendered as one HTML file that contains its style, script and pictures."""

import base64
import functools
import hashlib
from importlib.resources import files

import jinja2

from moseg.workflows.reports.content import ReportPage, SequencePanel
from moseg.workflows.reports.page.eigenvalue_plots import gather_plot
from moseg.workflows.reports.page.heat_maps import colour_map_style, gather_heat_map
from moseg.workflows.reports.page.numbers import byte_count, duration
from moseg.workflows.reports.page.pairs import read_pair
from moseg.workflows.reports.page.table_layout import lay_out_tables
from moseg.workflows.reports.page.timeline_layout import lay_out_timelines
from moseg.workflows.reports.page.viewer import data_url, describe_reach, encode_base64, gather_viewer


def render_page(page: ReportPage) -> str:
    """Return a report as the text of one HTML page.

    The page requests nothing: style, script, pictures and videos are part of it, and its content security policy
    forbids everything else. Every text is escaped, as are the names of sequences. Without scripts it still shows the
    tables, the matrices and one frame of each sequence.

    Parameters
    ----------
    page : ReportPage

    Returns
    -------
    str
        HTML, to be written as UTF-8.
    """
    style, script = f"{_read('colours.css')}\n{_read('page.css')}\n{colour_map_style()}", _read("page.js")
    text = _template().render(
        page=page,
        tables=lay_out_tables(page.scores),
        viewers=tuple(map(gather_viewer, page.sequences)),
        missing=_list_missing(page.sequences),
        style=style,
        script=script,
        style_source=_policy_source(style),
        script_source=_policy_source(script),
    )
    # Names of files may hold bytes that are no text.
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


@functools.cache
def _template() -> jinja2.Template:
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters.update(
        data_url=data_url,
        base64=encode_base64,
        bytes=byte_count,
        duration=duration,
        heat_map=gather_heat_map,
        plot=gather_plot,
        tracks=lay_out_timelines,
        reach=describe_reach,
        pair=read_pair,
    )
    return environment.from_string(_read("page.html"))


def _read(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def _policy_source(text: str) -> str:
    """Return the hash by which a content security policy names an inline style or script."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _list_missing(panels: tuple[SequencePanel, ...]) -> tuple[tuple[int, str, tuple[str, ...]], ...]:
    """List the number and name of each sequence that lacks something, and what is missing and why."""
    rows = []
    for number, panel in enumerate(panels):
        of_variants = (f"{variant.title}: {text}" for variant in panel.variants for text in variant.missing)
        texts = tuple(dict.fromkeys([*panel.missing, *of_variants]))
        if texts:
            rows.append((number, panel.name, texts))
    return tuple(rows)
