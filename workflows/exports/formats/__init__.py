"""Formats of other programs that a segmentation is exported in: one file each, and one line in the registry."""

from moseg.workflows.exports.formats.export_format import ExportFormat
from moseg.workflows.exports.formats.registry import FORMATS, check_exports, choose_formats, export

__all__ = ["FORMATS", "ExportFormat", "check_exports", "choose_formats", "export"]
