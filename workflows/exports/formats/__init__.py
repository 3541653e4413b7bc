"""Formats of other programs in which a segmentation is exported; the registry lists them."""

from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.formats.registry import (
    FORMATS,
    check_exports,
    choose_formats,
    earlier_exports,
    export,
)

__all__ = ["FORMATS", "ExportFormat", "check_exports", "choose_formats", "earlier_exports", "export"]
