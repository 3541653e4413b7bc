"""`moseg store why`: which field of its recipe made an artifact a miss."""

from moseg.workflows.cli.options import DEFAULT_STORE, StoreOption
from moseg.workflows.cli.store_commands.finding import KeyArgument, find_artifact, open_existing
from moseg.workflows.cli.store_commands.showing import short


def why(key: KeyArgument, store: StoreOption = DEFAULT_STORE) -> None:
    """Show which fields of an artifact's recipe differ from the nearest other artifact of its task.

    That is why it was computed rather than reused.

    Examples
    --------
    moseg store why clustering/1a2b
    """
    from moseg.store import differences, nearest

    opened = open_existing(store)
    ref = find_artifact(opened, key)
    recipe = opened.manifest(ref).recipe
    found = nearest(opened, recipe, besides=ref)
    if found is None:
        print(f"{ref}: the only artifact of its task; nothing could have been reused")
        return
    print(f"{ref}\ndiffers from the nearest stored artifact {found.ref} in")
    fields = found.differences
    while fields:
        for field in fields:
            print(f"  {field.field}: {short(field.wanted)} here, {short(field.stored)} there")
        first = fields[0]
        # Where nothing but inputs differs, the reason lies with the first of them.
        if not all(field.field.startswith("inputs") for field in fields):
            break
        if not (_is_stored(opened, first.wanted) and _is_stored(opened, first.stored)):
            break
        fields = differences(opened.manifest(first.stored).recipe, opened.manifest(first.wanted).recipe)
        print(f"and {short(first.wanted)} differs from {short(first.stored)} in")


def _is_stored(store, ref: object) -> bool:
    return isinstance(ref, str) and "/" in ref and store.has(ref)
