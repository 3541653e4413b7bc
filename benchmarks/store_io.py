"""Time of putting and reading artifacts, beside plain Zarr with the same codecs.

Run ``python benchmarks/store_io.py [--repeat N] [--root DIR]``. The store's and Zarr's calls alternate, so that the
ratio is fair on a busy machine.
"""

import argparse
import itertools
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import zarr
from zarr.codecs import BloscCodec, Crc32cCodec

from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore

TASK = "benchmark"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=40, help="calls of each kind")
    parser.add_argument("--root", type=Path, default=None, help="folder of the file system to measure")
    options = parser.parse_args()
    root = Path(tempfile.mkdtemp(prefix="moseg-bench-", dir=options.root))
    try:
        print(f"{'array':26} {'put':>9} {'zarr':>9} {'ratio':>6} {'read':>9} {'zarr':>9} {'ratio':>6}")
        for name, (array, dims) in cases().items():
            print(f"{name:26} {report(root, name, array, dims, options.repeat)}")
        print("(targets for the flow: 1.5 each)")
        print(f"\n{'array':26} {'files':>6} {'bytes':>10} {'of raw':>7} {'put':>9} {'read':>9}  (processor time)")
        for name, (array, dims) in cases().items():
            print(f"{name:26} {footprint(root, name, array, dims, options.repeat)}")
        print(f"\nhas: {lookup_time(root) * 1e6:.1f} us (target 50 us)")
    finally:
        shutil.rmtree(root)


def cases() -> dict[str, tuple[np.ndarray, tuple[str, ...]]]:
    """Return arrays of the sizes that stages exchange; smooth fields with realistic noise."""
    rng = np.random.default_rng(0)
    y, x = np.mgrid[:480, :854].astype(np.float32)
    flow = np.stack([np.sin(y / 90) + x / 200, np.cos(x / 70)], axis=-1)
    flow += rng.normal(scale=1e-3, size=flow.shape).astype(np.float32)
    image = (127 + 100 * np.sin(y / 40 + x / 60))[..., None] + rng.normal(scale=4, size=(480, 854, 3))
    labels = np.repeat(((np.hypot(y - 240, x - 400) < 90) * np.uint16(1))[None], 20, axis=0).astype(np.uint16)
    return {
        "theta (5, 9) float64": (rng.normal(size=(5, 9)), ("object", "parameter")),
        "flow 480p float32": (flow, ("y", "x", "uv")),
        "image 480p uint8": (image.clip(0, 255).astype(np.uint8), ("y", "x", "rgb")),
        "labels 20 x 480p uint16": (labels, ("frame", "y", "x")),
    }


def report(root: Path, name: str, array: np.ndarray, dims: tuple[str, ...], repeat: int) -> str:
    """Return median times of `repeat` calls of each kind, and the ratios of the store's to Zarr's."""
    store = LocalStore(root / "store")
    counter = itertools.count()
    times: dict[str, list[float]] = {"put": [], "plain put": [], "read": [], "plain read": []}
    for number in itertools.islice(counter, repeat + 1):
        recipe = Recipe(task=TASK, version=1, params={"case": name, "number": number})
        folder = root / "plain" / name.replace(" ", "-") / str(number)
        times["put"].append(seconds(lambda r=recipe: store.put(r, {"x": array}, dims={"x": dims})))
        times["plain put"].append(seconds(lambda f=folder: plain_put(f, array, dims)))
        times["read"].append(seconds(lambda r=recipe: store.read(r.ref, "x")))
        times["plain read"].append(seconds(lambda f=folder: zarr.open_array(f / "x", mode="r")[...]))
        store.remove(recipe.ref)
        shutil.rmtree(folder)
    # the first round includes imports and cold caches
    median = {kind: float(np.median(values[1:])) for kind, values in times.items()}
    columns = []
    for kind in ("put", "read"):
        ours, plain = median[kind], median[f"plain {kind}"]
        columns.append(f"{1e3 * ours:6.2f} ms {1e3 * plain:6.2f} ms {ours / plain:6.2f}")
    return " ".join(columns)


def footprint(root: Path, name: str, array: np.ndarray, dims: tuple[str, ...], repeat: int) -> str:
    """Return the files and bytes of an artifact, and the processor time of a put and a read."""
    store = LocalStore(root / "footprint" / name.replace(" ", "-"))
    recipes = [Recipe(task=TASK, version=1, params={"case": name, "number": number}) for number in range(repeat)]
    start = time.process_time()
    for recipe in recipes:
        store.put(recipe, {"x": array}, dims={"x": dims})
    middle = time.process_time()
    for recipe in recipes:
        store.read(recipe.ref, "x")
    put, read = (middle - start) / repeat, (time.process_time() - middle) / repeat
    files = [path.stat().st_size for path in (store.root / "objects").rglob("*") if path.is_file()]
    nbytes = sum(files) / repeat
    share = nbytes / array.nbytes
    return f"{len(files) / repeat:6.1f} {nbytes:10.0f} {share:7.2f} {1e3 * put:6.2f} ms {1e3 * read:6.2f} ms"


def plain_put(folder: Path, array: np.ndarray, dims: tuple[str, ...]) -> None:
    """Write one array in a group by Zarr's own local store, with the codecs and chunks of the artifact store."""
    group = zarr.create_group(folder)
    chunks = (1, *array.shape[1:]) if dims[0] == "frame" else array.shape
    stored = group.create_array(
        "x",
        shape=array.shape,
        dtype=array.dtype,
        chunks=chunks,
        compressors=[BloscCodec(cname="zstd", clevel=1, shuffle="bitshuffle", typesize=array.itemsize), Crc32cCodec()],
        dimension_names=dims,
        config={"write_empty_chunks": True},
    )
    stored[...] = array


def lookup_time(root: Path) -> float:
    """Return the seconds of one lookup of a stored artifact."""
    store = LocalStore(root / "store")
    recipe = Recipe(task=TASK, version=1)
    store.put(recipe, {}, dims={})
    return seconds(lambda: [store.has(recipe.ref) for _ in range(1000)]) / 1000


def seconds(call: Callable[[], object]) -> float:
    """Return the wall-clock seconds of one call."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
