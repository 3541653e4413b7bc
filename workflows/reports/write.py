"""A report written to a file."""

from pathlib import Path

from moseg.workflows.exports import write_text
from moseg.workflows.reports.content import ReportPage
from moseg.workflows.reports.page import render_page
from moseg.workflows.runlog.events import as_unicode


def write_report(path: Path, page: ReportPage) -> str:
    """Write the page, whole or not at all, and return a line that says where it is and how large.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_text(path, as_unicode(render_page(page)))
    return f"report: {path} ({Path(path).stat().st_size / 1e6:.1f} MB)"
