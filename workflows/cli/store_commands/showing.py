"""`moseg store show`: one artifact, where it lies, what it was made from and what was made from it."""

import json
from collections.abc import Iterable, Iterator, Sequence
from typing import Annotated

import typer
from pydantic import JsonValue

from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import split_ref
from moseg.workflows.cli.options import DEFAULT_STORE, QuietOption, StoreOption
from moseg.workflows.cli.store_commands.finding import KeyArgument, find_artifact, open_existing
from moseg.workflows.process.amounts import size
from moseg.workflows.process.progress import StageProgress

LONG_PASS = 5_000
"""Manifests from which a pass over them takes seconds behind a network, and is worth a bar."""


def show(
    key: KeyArgument,
    summary: Annotated[
        bool, typer.Option("--summary", help="For reading: relatives by task with the parameters they share, no JSON.")
    ] = False,
    no_downstream: Annotated[
        bool, typer.Option("--no-downstream", help="Leave out what was made from it: spares a pass over all manifests.")
    ] = False,
    quiet: QuietOption = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Print an artifact's manifest (recipe, arrays, seconds, versions), its place and its lineage as JSON.

    Upstream is all that it was made from, downstream all stored artifacts that were made from it, each directly or in
    turn, with the number of steps between. Downstream reads the manifest of every artifact in the store once.

    Examples
    --------
    moseg store show score/1a2b --summary
    moseg store show 1a2b --no-downstream
    """
    from moseg.store.lineage import State, ancestry, descendants

    opened = open_existing(store)
    ref = find_artifact(opened, key)
    manifest = opened.manifest(ref)
    where = opened.place(ref)
    upstream = list(ancestry(opened, [ref]))[1:]
    downstream = []
    if not no_downstream:
        refs = list(opened.refs())
        with StageProgress({"manifests": len(refs)}, quiet or len(refs) < LONG_PASS) as progress:
            downstream = list(descendants(opened, ref, refs, lambda: progress.advance("manifests")))
    if not summary:
        lineage = {"upstream": upstream} if no_downstream else {"upstream": upstream, "downstream": downstream}
        print(_document(manifest, where, {side: list(map(_entry, found)) for side, found in lineage.items()}))
        return
    lost = sum(relative.state != State.STORED for relative in upstream)
    print(*_head(manifest, where), sep="\n")
    print(f"upstream: {len(upstream)} artifacts{f', {lost} of them not in this store or damaged' if lost else ''}")
    for line in _by_task(upstream):
        print(line)
    if not no_downstream:
        print(f"downstream: {len(downstream)} artifacts")
        for line in _by_task(downstream):
            print(line)


def _entry(relative) -> dict[str, JsonValue]:
    return {"ref": relative.ref, "depth": relative.depth, "state": relative.state.value}


def _document(manifest: Manifest, place: str, lineage: dict[str, list[dict[str, JsonValue]]]) -> str:
    """Return all as JSON, with a relative on each line: a score has hundreds of them."""
    head = json.dumps({"place": place} | manifest.model_dump(mode="json"), indent=2, ensure_ascii=False)
    sides = []
    for side, entries in lineage.items():
        lines = ",\n    ".join(json.dumps(entry) for entry in entries)
        sides.append(f'  "{side}": [\n    {lines}\n  ]' if entries else f'  "{side}": []')
    return ",\n".join([head.removesuffix("\n}"), *sides]) + "\n}"


def _head(manifest: Manifest, place: str) -> Iterator[str]:
    recipe = manifest.recipe
    yield recipe.ref
    yield f"  place    {place}"
    yield f"  made     {manifest.created} on {manifest.host} in {manifest.seconds:.3g} s; {size(manifest.nbytes)}"
    for entry in manifest.arrays:
        axes = ", ".join(f"{axis}={length}" for axis, length in zip(entry.dims, entry.shape, strict=True))
        yield f"  array    {entry.name}: {entry.dtype} ({axes})"
    for name, value in manifest.attributes.items():
        yield f"  result   {name}: {short(value)}"
    yield f"  recipe   version {recipe.version}"
    for name, value in _flat(recipe.params):
        yield f"    {name} = {short(value)}"
    for role, value in recipe.inputs.items():
        yield f"    {role} from {value if isinstance(value, str) else _count(value)}"


def _count(refs: Sequence[str]) -> str:
    tasks = ", ".join(dict.fromkeys(split_ref(ref)[0] for ref in refs))
    return f"{len(refs)} of {tasks}" if refs else "nothing"


def _by_task(relatives: Iterable) -> Iterator[str]:
    """Yield a line for each task, the nearest first, and the parameters that its artifacts share."""
    tasks: dict[str, list] = {}
    for relative in relatives:
        tasks.setdefault(split_ref(relative.ref)[0], []).append(relative)
    for task, found in tasks.items():
        recipes = [relative.recipe for relative in found if relative.recipe is not None]
        versions = "/".join(map(str, sorted({recipe.version for recipe in recipes}))) or "?"
        yield f"  {len(found):>6}  {task}  (version {versions}, {size(sum(each.nbytes for each in found))})"
        values: dict[str, dict[str, None]] = {}
        for recipe in recipes:
            for name, value in _flat(recipe.params):
                values.setdefault(name, {})[short(value)] = None
        for name, texts in values.items():
            yield f"            {name} = {next(iter(texts)) if len(texts) == 1 else f'{len(texts)} values'}"


def _flat(params: dict[str, JsonValue], prefix: str = "") -> Iterator[tuple[str, JsonValue]]:
    for name, value in params.items():
        if isinstance(value, dict) and value:
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def short(value: object) -> str:
    """Return a value as JSON, cut where it is long."""
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 90 else f"{text[:87]}..."
