"""Write the measured figures of the documents from ``benchmarks/results``: ``python docs/tools/write_results.py``.

``--rerun all``, or names and patterns separated by commas (``--rerun 'exact-*,davis-default'``), repeats measurements
first, in a store of their own, and writes their files. Data sets are given by options such as ``--davis``;
measurements of a data set that is not given are left as they are, and named. At the end each measurement
is listed with its command and the seconds that it took after those before it.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from figures import MEASURED_APART, PAGES, Figures, written
from measured_data import DATA
from measurements import CATALOGUE, Measurement, chosen
from rerun import rerun, write


def main() -> int:
    """Repeat the chosen measurements, write the pages, list the measurements; exit with code 1 if a command failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rerun", default="", metavar="NAMES", help="measurements to repeat, or all")
    for name, data in DATA.items():
        parser.add_argument(f"--{name}", default="", metavar="ROOT", help=data.about)
    parser.add_argument("--store", type=Path, help="artifact store to use and keep; by default a temporary one")
    options = parser.parse_args()
    roots = {data: str(Path(vars(options)[data]).resolve()) for data in DATA if vars(options)[data]}
    try:
        wanted = chosen(options.rerun) if options.rerun else []
    except LookupError as error:
        print(error.args[0], file=sys.stderr)
        return 2
    failed = _rerun(wanted, roots, options.store)
    figures = Figures()
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        new = written(text, figures)
        if new != text:
            page.write_text(new, encoding="utf-8")
            print(f"{page.name}: written")
    _list(figures)
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


def _rerun(wanted: list[Measurement], roots: dict[str, str], store: Path | None) -> list[str]:
    """Repeat measurements in one store for each data set, and return the names of those that failed."""
    failed = []
    started = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="moseg-results-") as folder:
        own, before = Path(folder, "store"), None
        for number, measurement in enumerate(wanted, start=1):
            head = f"{number}/{len(wanted)} {measurement.name}"
            if measurement.data is not None and measurement.data not in roots:
                print(f"{head}: left as it is, {DATA[measurement.data].root} is not given", flush=True)
                continue
            if measurement.data != before:
                # Data sets share no cues.
                shutil.rmtree(own, ignore_errors=True)
                before = measurement.data
            try:
                said = rerun(measurement, roots, store or own, Path(folder))
            except subprocess.CalledProcessError as error:
                print(f"{head}: failed, exit code {error.returncode}", flush=True)
                failed.append(measurement.name)
                continue
            write(said)
            print(f"{head}: {said['seconds']:.0f} s", flush=True)
    if wanted:
        print(f"{time.perf_counter() - started:.0f} s in all\n")
    return failed


def _list(figures: Figures) -> None:
    total = 0.0
    for measurement in CATALOGUE:
        seconds = figures.seconds(measurement.name)
        total += seconds or 0.0
        took = "not measured" if seconds is None else f"{seconds:.0f} s"
        print(f"{measurement.name:36} {took:>12}  {measurement.command}")
    print(f"{'all of them, in this order':36} {total:10.0f} s")
    apart = sorted(path.stem for path in MEASURED_APART.glob("*.json"))
    print(f"measured apart, not repeated here: {', '.join(apart)}")


if __name__ == "__main__":
    sys.exit(main())
