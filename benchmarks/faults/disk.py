"""Full disks and read-only places: the command works or ends with one clear line, and nothing is lost.

Run ``python benchmarks/faults/disk.py [--cases full inodes …] [--root DIR]``; some minutes. The laws are:

- ``full``, ``inodes``: on a file system that fills up during a run the command ends with one line, which names the
  store and contains "No space left on device", and exit code 1. Committed artifacts are complete, and with more room
  the same command computes the rest and nothing else. A disk with less than the run is estimated to take is refused
  in one line, exit code 2, and nothing is computed on it.
- ``file-size``: the same under a limit on the size of files (RLIMIT_FSIZE), for which nothing is mounted.
- ``output``: a full disk under the output of a command is one line, exit code 1; no part of a file stays.
- ``read-only``, ``forbidden``: in a place that cannot be written (a read-only mount, folders of another user), stored
  artifacts are evaluated, listed and verified; missing ones are one line and exit code 1.

All but ``file-size`` and ``forbidden`` need Linux and the right to mount in a separate namespace (root, or unprivileged
user namespaces). A case that the machine does not permit is named and not run.
"""

import argparse
import shutil
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

from contents import read_contents
from full_disks import file_size, full, inodes, output
from ledger import Ledger
from mounts import enter_namespace
from places import Bench
from processes import run_to_end
from read_only import forbidden, read_only
from workload import write_workload

CASES = {
    "full": full,
    "inodes": inodes,
    "output": output,
    "read-only": read_only,
    "file-size": file_size,
    "forbidden": forbidden,
}
NEED_NO_MOUNT = ("file-size", "forbidden")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--root", type=Path, default=None, help="folder for temporary videos and stores")
    parser.add_argument("--frames", type=int, default=12, help="length of the video")
    parser.add_argument("--short", action="store_true", help="one size of disk and one process only")
    options = parser.parse_args()
    refusal = None if set(options.cases) <= set(NEED_NO_MOUNT) else enter_namespace()
    ledger = Ledger("case", "workers", "exit code", "what it said", "stored then", "computed with room")
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="moseg-disk-", dir=options.root))
        stack.callback(shutil.rmtree, folder)
        # Another user must be able to reach the folders in it.
        folder.chmod(0o755)
        workload = write_workload(folder / "data", options.frames, num_samples=200)
        whole = folder / "whole"
        ended = run_to_end(workload.command("eval", str(whole), folder / "whole.json"), folder / "logs")
        if ended.code:
            raise RuntimeError(ended.err)
        bench = Bench(workload, folder, whole, read_contents(str(whole)), ledger, options.short)
        for name in options.cases:
            if refusal is not None and name not in NEED_NO_MOUNT:
                ledger.row(name, "-", "not run", refusal, "-", "-")
                continue
            CASES[name](bench)
    return ledger.close()


if __name__ == "__main__":
    sys.exit(main())
