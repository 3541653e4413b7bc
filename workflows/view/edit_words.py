"""Edits in words, and the options of the command line that stand for corrections."""

from moseg.schemas.corrections import (
    Add,
    Corrections,
    Drop,
    Edit,
    Erase,
    Keep,
    Merge,
    Moving,
    Paint,
    Rename,
    Split,
    Static,
)


def describe_edit(edit: Edit) -> str:
    """Return an edit as a short sentence."""
    match edit:
        case Drop(drop=identity):
            return f"drop {identity}"
        case Keep(keep=identity):
            return f"keep {identity}"
        case Static(static=identity):
            return f"{identity} is static"
        case Moving(moving=identity):
            return f"{identity} moves"
        case Merge(merge=(first, *others)):
            return f"{', '.join(map(str, others))} belong{'s' if len(others) == 1 else ''} to {first}"
        case Split(split=at):
            new = "another object" if at.into is None else at.into
            return f"{at.object} is {new} from frame {at.frame} on"
        case Rename(rename=naming):
            return f"{naming.object} is called {naming.name}"
        case Paint(paint=painting):
            return f"paint {painting.object} in frame {painting.frame}"
        case Erase(erase=erasing):
            return f"erase {'all' if erasing.object is None else erasing.object} in frame {erasing.frame}"
        case Add(add=growing):
            return f"add {growing.object} in frame {growing.frame} by {growing.by}"
    raise TypeError(type(edit).__name__)


def verdicts(corrections: Corrections) -> dict[int, str]:
    """Return what the user said last about each object: drop, keep, static or moving."""
    found = {}
    for edit in corrections.edits:
        for kind in ("drop", "keep", "static", "moving"):
            if hasattr(edit, kind):
                found[getattr(edit, kind)] = kind
    return found


def next_identity(known: set[int], corrections: Corrections) -> int:
    """Return a number that no object has, nor had before an edit that made it another."""
    used = set(known)
    for edit in corrections.edits:
        match edit:
            case Merge(merge=identities):
                used.update(identities)
            case Split(split=at) if at.into is not None:
                used.add(at.into)
            case Paint(paint=made) | Add(add=made):
                used.add(made.object)
            case Drop(drop=identity) | Keep(keep=identity) | Static(static=identity) | Moving(moving=identity):
                used.add(identity)
    return max(used, default=0) + 1
