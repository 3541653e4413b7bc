"""Renders what a report shows as one HTML file, in which style, script and pictures lie inline."""

import base64
import functools
import hashlib
from importlib.resources import files

import jinja2

from moseg.workflows.reports.content import ReportPage
from moseg.workflows.reports.page.colour_map import colour_map_style
from moseg.workflows.reports.page.score_tables import gather_score_tables
from moseg.workflows.reports.page.sequence_views import data_url, gather_sequence, list_missing
from moseg.workflows.reports.page.stage_bars import gather_stages

STYLES = ("page.css", "tables.css", "viewer.css", "figures.css")
SCRIPTS = ("theme.js", "sections.js", "viewer.js", "tabs.js", "matrices.js")


def _read(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


@functools.cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_read),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["data_url"] = data_url
    return environment


def _policy_source(text: str) -> str:
    """How a content security policy names an inline style or script: by its hash."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def render_page(page: ReportPage) -> str:
    """A report as the text of one HTML page.

    The page asks nothing of a network: style, script, pictures and videos lie in it, and its content security policy
    lets nothing else run. Every text is escaped, whoever named the sequence. Without a script it still shows the
    tables, the matrices and one frame of each sequence.

    Parameters
    ----------
    page : ReportPage

    Returns
    -------
    str
        HTML, to be written as UTF-8.
    """
    style = "\n".join([*map(_read, STYLES), colour_map_style()])
    script = "\n".join(map(_read, SCRIPTS))
    sequences = tuple(gather_sequence(number, panel) for number, panel in enumerate(page.sequences))
    template = _environment().get_template("page.html")
    text = template.render(
        page=page,
        tables=gather_score_tables(page.scores),
        sequences=sequences,
        stages=gather_stages(page.stages),
        missing=list_missing(page.sequences),
        style=style,
        script=script,
        style_source=_policy_source(style),
        script_source=_policy_source(script),
    )
    # Names of files may hold bytes that are no text.
    return text.encode("utf-8", "backslashreplace").decode("utf-8")
