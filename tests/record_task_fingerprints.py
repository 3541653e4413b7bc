"""Record the fingerprints of the tasks' code: ``python tests/record_task_fingerprints.py [--force]``.

Run it after a task's version was raised, or a task was added. It does not record code that changed under an unchanged
version, because existing stores would still return the old code's results under the same keys. ``--force`` records it
anyway: use it only if the results are the same byte for byte, or if nothing was released under that version.
"""

import argparse
import json
import sys
from pathlib import Path

from task_fingerprints import RECORD, Fingerprint, current_fingerprints, moved_unnoticed, recorded_fingerprints


def main(arguments: list[str] | None = None) -> int:
    """Update the record and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--force", action="store_true", help="record code that changed under an unchanged version")
    return record(current_fingerprints(), RECORD, parser.parse_args(arguments).force)


def record(current: dict[str, Fingerprint], path: Path, is_forced: bool = False) -> int:
    """Write the record at `path`; return 1 and write nothing if code changed under an unchanged version."""
    moved = moved_unnoticed(recorded_fingerprints(path), current)
    if moved and not is_forced:
        print(f"not recorded: raise the version of {', '.join(moved)} first, or --force", file=sys.stderr)
        return 1
    content = {name: entry._asdict() for name, entry in sorted(current.items())}
    path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
