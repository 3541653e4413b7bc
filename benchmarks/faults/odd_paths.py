"""Stores under odd names: each works like any other, or is refused in one line.

Run ``python benchmarks/faults/odd_paths.py [--root DIR]``; some two minutes. Names have blanks, letters of other
scripts, bytes that are not text, characters with a meaning in URLs and in lists of options, or are relative paths,
links and URLs. A name that works must give the artifacts of a plain path, and each of its spellings must find them
again; some are tried with worker processes too. A name that cannot work (a file of that name, a link to nothing, a name
beyond the system's limit) is one line, exit code 2.
"""

import argparse
import os
import shutil
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

from contents import Contents, read_contents
from ledger import Ledger
from processes import Ended, Run
from workload import Workload, read_counts, write_workload

WORKING = {
    "blanks": "a store with blanks",
    "letters": "übung/видео/映像",
    "no text": os.fsdecode(b"latin-\xfc"),
    "like a URL": "100%25 #1 ?a=b&c",
    "like an option": "-store",
    "two dots": "below/../beside",
    "slashes": "here//there/",
    "link": "link",
    "colon and quotes": "a:b'c\"d",
    "new line": "two\nlines",
}
"""Relative paths; each is also tried as an absolute one."""
WITH_WORKERS = ("blanks", "no text", "link")
REFUSED = {
    "a file": "file",
    "a folder of other files": "others",
    "link to nothing": "dangling",
    "link to itself": "loop",
    "long name": "x" * 300,
    "below a file": "file/store",
    "no scheme of ours": "ftp://host/store",
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=None, help="folder for temporary videos and stores")
    parser.add_argument("--names", nargs="+", choices=[*WORKING, *REFUSED], default=[*WORKING, *REFUSED])
    parser.add_argument("--frames", type=int, default=6, help="length of the video")
    options = parser.parse_args()
    ledger = Ledger("name", "given as", "workers", "exit code", "what it said")
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="moseg-paths-", dir=options.root))
        stack.callback(shutil.rmtree, folder)
        stack.callback(os.chdir, Path.cwd())
        os.chdir(folder)
        workload = write_workload(folder / "data", options.frames, num_samples=50)
        plain = evaluate(workload, "plain", folder)
        if plain.code:
            raise RuntimeError(plain.err)
        whole = read_contents("plain")
        Path("elsewhere").mkdir()
        Path("link").symlink_to("elsewhere")
        Path("dangling").symlink_to("nowhere/at all")
        Path("loop").symlink_to("loop")
        Path("file").write_bytes(b"something")
        Path("others").mkdir()
        Path("others/file").write_bytes(b"something")
        for name in options.names:
            if name in REFUSED:
                refuse(ledger, workload, name, folder)
            else:
                work(ledger, workload, name, folder, whole)
    return ledger.close()


def work(ledger: Ledger, workload: Workload, name: str, folder: Path, whole: Contents) -> None:
    """Evaluate into the store by its relative path, and find all again by its absolute path and by URL."""
    workers = "2" if name in WITH_WORKERS else "0"
    path = WORKING[name]
    forms = {"relative path": path, "absolute path": str(folder / path), "URL": (folder / path).resolve().as_uri()}
    for number, (form, given) in enumerate(forms.items()):
        ended = evaluate(workload, given, folder, "--workers", workers if number == 0 else "0")
        case = f"{name} as {form}"
        is_well = (ended.code, ended.err) == (0, "")
        ledger.require(case, "it succeeds without messages", is_well, (ended.code, ended.err))
        if is_well:
            computed, expected = read_counts(ended.out)[0], whole.num_computed() if number == 0 else 0
            ledger.require(case, "all artifacts are computed once and found again", computed == expected, computed)
            found = read_contents(given)
            is_same = found.results == whole.results and not found.problems
            ledger.require(case, "the artifacts are those of a plain path", is_same)
        ledger.row(ascii(name), form, workers if number == 0 else "0", ended.code, ascii(ended.err.strip())[1:-1])


def refuse(ledger: Ledger, workload: Workload, name: str, folder: Path) -> None:
    """Check that a place that cannot be a store is refused in one line and not changed."""
    before = sorted(os.listdir(folder / "others"))
    ended = evaluate(workload, REFUSED[name], folder)
    is_clear = ended.code == 2 and ended.is_one_line()
    ledger.require(name, "one line, exit code 2", is_clear, (ended.code, ended.err))
    is_kept = Path("file").read_bytes() == b"something" and sorted(os.listdir(folder / "others")) == before
    ledger.require(name, "existing files stay", is_kept)
    ledger.row(name, "relative path", 0, ended.code, ended.err.strip().replace(str(folder), "…"))


def evaluate(workload: Workload, store: str, folder: Path, *options: str) -> Ended:
    """Run the evaluation on a store of this name."""
    command = workload.command("eval", store, folder / "report.json", *options)
    return Run(command, folder / "logs").wait()


if __name__ == "__main__":
    sys.exit(main())
