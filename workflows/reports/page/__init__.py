"""A report as one HTML page that needs nothing beside itself."""

from moseg.workflows.reports.page.render import render_page

__all__ = ["render_page"]
