"""The plug-in in which an error occurred."""

import traceback

from moseg.workflows.plugins.code import MAIN, OWN_PACKAGE
from moseg.workflows.plugins.registered import entries


def failing_plugin(error: BaseException) -> str | None:
    """Return the package of a plug-in whose code was running when an error occurred, here or in a worker; else None."""
    packages = {package for entry in entries for package in entry.package.split()} - {OWN_PACKAGE, MAIN}
    modules = (frame.f_globals.get("__name__", "") for frame, _ in traceback.walk_tb(error.__traceback__))
    running = [module.partition(".")[0] for module in modules]
    return next((package for package in reversed(running) if package in packages), None)
