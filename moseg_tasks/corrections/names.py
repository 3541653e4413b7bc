"""Names that edits give to objects."""

from collections.abc import Iterable

from moseg.schemas.corrections import Edit, Merge, Rename


def names_of(edits: Iterable[Edit]) -> dict[int, str]:
    """Return the name of each object that has one, by identity; one that others were merged into may have theirs."""
    names: dict[int, str] = {}
    for edit in edits:
        if isinstance(edit, Rename):
            names[edit.rename.object] = edit.rename.name
        elif isinstance(edit, Merge):
            found = [names.pop(each) for each in edit.merge if each in names]
            if found:
                names[edit.merge[0]] = found[0]
    return names
