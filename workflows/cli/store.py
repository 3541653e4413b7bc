"""`moseg store`: what lies in the artifact store, whether it is sound, and how to make room."""

import json as json_text
from datetime import UTC, datetime
from typing import Annotated

import typer

from schemas.errors import InputError
from workflows.cli.options import DEFAULT_STORE, StoreOption

store_app = typer.Typer(help="The artifact store: list, explain, check, collect.", no_args_is_help=False)

KeyArgument = Annotated[str, typer.Argument(help="<task>/<key>, or the first letters of a key.")]


@store_app.command("ls")
def list_artifacts(
    task: Annotated[str | None, typer.Option("--task", help="Only this task's artifacts.")] = None,
    runs: Annotated[bool, typer.Option("--runs", help="List the runs whose artifacts gc keeps instead.")] = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """List artifacts, or the runs that keep them. Example: moseg store ls --task flow"""
    opened = _existing(store)
    if runs:
        for run_id, pin in sorted(opened.pinned().items(), key=lambda item: item[1].created):
            created = datetime.fromtimestamp(pin.created, UTC).isoformat(timespec="seconds")
            state = "finished" if pin.expires is None else "running"
            print(f"{run_id}  {created}  {state}  {len(pin.refs)} references")
        return
    for ref in opened.refs(task):
        print(ref)


@store_app.command("show")
def show(key: KeyArgument, store: StoreOption = DEFAULT_STORE) -> None:
    """Print an artifact's manifest: recipe, inputs, arrays, seconds, versions."""
    opened = _existing(store)
    print(opened.manifest(_find(opened, key)).model_dump_json(indent=2))


@store_app.command("why")
def why(key: KeyArgument, store: StoreOption = DEFAULT_STORE) -> None:
    """Say which fields of an artifact's recipe differ from the nearest other artifact of its task.

    That is why it was computed rather than reused.
    """
    from store import differences, nearest

    opened = _existing(store)
    ref = _find(opened, key)
    recipe = opened.manifest(ref).recipe
    found = nearest(opened, recipe, besides=ref)
    if found is None:
        print(f"{ref}: the only artifact of its task; nothing could have been reused")
        return
    print(f"{ref}\ndiffers from the nearest stored artifact {found.ref} in")
    fields = found.differences
    while fields:
        for field in fields:
            print(f"  {field.field}: {_short(field.wanted)} here, {_short(field.stored)} there")
        first = fields[0]
        # Where nothing but inputs differs, the reason lies with the first of them.
        if not all(field.field.startswith("inputs") for field in fields):
            break
        if not (_is_stored(opened, first.wanted) and _is_stored(opened, first.stored)):
            break
        fields = differences(opened.manifest(first.stored).recipe, opened.manifest(first.wanted).recipe)
        print(f"and {_short(first.wanted)} differs from {_short(first.stored)} in")


@store_app.command("verify")
def verify(
    quarantine: Annotated[bool, typer.Option("--quarantine", help="Take bad artifacts out of service.")] = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Compare every artifact's bytes with its manifest; exit code 1 where one is bad."""
    opened = _existing(store)
    count, bad = 0, 0
    for result in opened.verify():
        count += 1
        if not result.is_intact:
            bad += 1
            print(f"{result.ref}: {result.problem}")
            if quarantine:
                opened.quarantine(result.ref, result.problem)
    print(f"{count} artifacts, {bad} bad{' (quarantined)' if quarantine and bad else ''}")
    if bad:
        raise typer.Exit(1)


@store_app.command("gc")
def collect(
    delete: Annotated[bool, typer.Option("--delete", help="Delete; without it only say what would go.")] = False,
    grace_hours: Annotated[float, typer.Option("--grace-hours", min=0, help="Spare what is younger.")] = 24.0,
    forget: Annotated[list[str] | None, typer.Option("--forget", help="Runs no longer to keep; see ls --runs.")] = None,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Collect artifacts that no kept run reaches. Example: moseg store gc --forget 1a2b… --delete"""
    opened = _existing(store)
    for run_id in forget or []:
        if run_id not in opened.pinned():
            raise InputError("no such run", where="--forget", got=run_id, expected="one of `moseg store ls --runs`")
        if delete:
            opened.unpin(run_id)
    report = opened.gc(is_dry=not delete, grace_seconds=grace_hours * 3600)
    for ref in report.removed:
        print(ref)
    verb = "removed" if delete else "would be removed (--delete does it)"
    print(
        f"{len(report.removed)} artifacts and {len(report.leftovers)} leftovers {verb}: {_size(report.nbytes)};"
        f" {report.num_kept} artifacts stay"
    )
    if forget and not delete:
        print("--forget takes effect with --delete only: the artifacts of these runs are counted as staying")


@store_app.command("du")
def disk_use(store: StoreOption = DEFAULT_STORE) -> None:
    """Artifacts and bytes by task."""
    usage = _existing(store).usage()
    for task, (count, nbytes) in sorted(usage.items(), key=lambda item: -item[1].nbytes):
        print(f"{_size(nbytes):>10}  {count:>7}  {task}")
    print(
        f"{_size(sum(u.nbytes for u in usage.values())):>10}  {sum(u.num_artifacts for u in usage.values()):>7}  total"
    )


def _existing(url: str):
    from store import open_store

    return open_store(url, create=False)


def _find(store, key: str) -> str:
    """The one artifact whose reference or key begins with `key`."""
    found = [ref for ref in store.refs() if ref.startswith(key) or ref.partition("/")[2].startswith(key)]
    if not found:
        raise InputError("no such artifact", where=store.url, got=key, expected="<task>/<key> or its start")
    if len(found) > 1:
        raise InputError("ambiguous key", got=key, expected=f"more letters: {len(found)} artifacts begin so")
    return found[0]


def _is_stored(store, ref: object) -> bool:
    return isinstance(ref, str) and "/" in ref and store.has(ref)


def _short(value: object) -> str:
    text = json_text.dumps(value, ensure_ascii=False)
    return text if len(text) <= 90 else f"{text[:87]}..."


def _size(nbytes: int) -> str:
    size = float(nbytes)
    for unit in ("B", "KiB", "MiB", "GiB"):
        if size < 1024:
            return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"
        size /= 1024
    return f"{size:.1f} TiB"
