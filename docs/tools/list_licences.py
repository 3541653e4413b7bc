"""List the licences of packages installed with the project: ``python docs/tools/list_licences.py [--extra models]``.

They are read from the metadata of the packages that `pyproject.toml` names and of their dependencies.
"""

import argparse
import re
from importlib.metadata import Distribution, PackageNotFoundError, distribution

COPYLEFT = re.compile(r"\b[AL]?GPL", re.IGNORECASE)
_NAME = re.compile(r"[A-Za-z0-9][\w.-]*")
_EXTRA = re.compile(r"""extra\s*==\s*["']([\w-]+)["']""")
_LONGEST_NAME = 60


def main() -> None:
    """Print a table, one package per row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--extra", action="append", default=[], choices=["models", "test"], help="also those of an extra"
    )
    found = needed_packages("moseg", parser.parse_args().extra)
    print("| package | version | licence | |\n|---|---|---|---|")
    for name, package in sorted(found.items()):
        licence = licence_of(package)
        print(f"| {name} | {package.version} | {licence} | {'copyleft' if COPYLEFT.search(licence) else ''} |")


def needed_packages(name: str, extras: list[str]) -> dict[str, Distribution]:
    """Return all installed dependencies of a package."""
    found: dict[str, Distribution] = {}
    waiting = [(name, tuple(extras))]
    while waiting:
        package, wanted = waiting.pop()
        for requirement in distribution(package).requires or ():
            extra = _EXTRA.search(requirement)
            needed = _NAME.match(requirement).group().lower()
            if (extra and extra[1] not in wanted) or needed in found:
                continue
            try:
                found[needed] = distribution(needed)
            except PackageNotFoundError:
                # Only needed on other systems or versions of Python.
                continue
            waiting.append((needed, ()))
    return found


def licence_of(package: Distribution) -> str:
    """Return the licence from the metadata field that the package uses."""
    metadata = package.metadata
    classifiers = [
        entry.split(" :: ")[-1] for entry in metadata.get_all("Classifier", []) if entry.startswith("License")
    ]
    text = (metadata.get("License") or "").strip()
    text = text.partition("\n")[0].strip()
    named = metadata.get("License-Expression") or (text if 0 < len(text) <= _LONGEST_NAME else "")
    return named or ", ".join(classifiers) or text[:_LONGEST_NAME] or "not stated"


if __name__ == "__main__":
    main()
