"""Ways to damage an artifact's files, and choosing artifacts whose damage a run will meet."""

import json
import random
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import split_ref


def _flip(content: bytes, dice: random.Random) -> bytes:
    position = dice.randrange(len(content))
    changed = content[position] ^ dice.randrange(1, 256)
    return content[:position] + bytes([changed]) + content[position + 1 :]


DAMAGES: dict[str, Callable[[bytes, random.Random], bytes | None]] = {
    "flipped byte": _flip,
    "truncation": lambda content, dice: content[: dice.randrange(1, len(content))],
    "deletion": lambda content, dice: None,
    "emptied": lambda content, dice: b"",
    "extra byte": lambda content, dice: content + bytes([dice.randrange(256)]),
}
"""A file's content afterwards; None where the file is deleted."""
KINDS: dict[str, Callable[[str], bool]] = {
    "manifest": lambda path: path == "manifest.json",
    "group metadata": lambda path: path == "zarr.json",
    "array metadata": lambda path: path.endswith("/zarr.json"),
    "chunk": lambda path: not path.endswith(".json"),
}
"""Kinds of an artifact's files, by path inside the artifact."""


class Damaged(NamedTuple):
    """A damaged file: its path inside the artifact, and its content now, None where it is deleted."""

    path: str
    content: bytes | None


def folder_of(root: Path, ref: str) -> Path:
    """Folder of an artifact in a store of files."""
    task, key = split_ref(ref)
    return root / "objects" / task / key[:2] / key


def inflict(folder: Path, kind: str, damage: str, dice: random.Random) -> Damaged | None:
    """Damage one file of a kind in an artifact's folder; None where it has no such file."""
    files = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if path.is_file()}
    names = [name for name in files if KINDS[kind](name)]
    if not names:
        return None
    name = dice.choice(names)
    content = DAMAGES[damage](files[name].read_bytes(), dice)
    if content is None:
        files[name].unlink()
    else:
        files[name].write_bytes(content)
    return Damaged(name, content)


def choose_artifacts(manifests: Mapping[str, Manifest], dice: random.Random) -> list[str]:
    """One artifact of each task, where possible one from which another of them was made.

    So a run that misses the last one goes on to miss the others.
    """
    refs = sorted(manifests)
    dice.shuffle(refs)
    chosen = [ref for ref in refs if ref.startswith("score/")][:1]
    tasks = {split_ref(ref)[0] for ref in chosen}
    for ref in chosen:
        inputs = list(manifests[ref].recipe.input_refs())
        dice.shuffle(inputs)
        for parent in inputs:
            if split_ref(parent)[0] not in tasks and parent in manifests:
                tasks.add(split_ref(parent)[0])
                chosen.append(parent)
    for ref in refs:
        if split_ref(ref)[0] not in tasks:
            tasks.add(split_ref(ref)[0])
            chosen.append(ref)
    return chosen


def descendants(manifests: Mapping[str, Manifest], refs: Iterable[str]) -> set[str]:
    """References of all that was made from any of `refs`."""
    refs = set(refs)
    reached = set(refs)
    while True:
        new = {ref for ref, manifest in manifests.items() if reached.intersection(manifest.recipe.input_refs())}
        if new <= reached:
            return reached - refs
        reached |= new


def read_quarantine(root: Path) -> dict[str, Path]:
    """Folders of the artifacts in quarantine, by reference."""
    slots = [reason.parent for reason in (root / "quarantine").glob("*/reason.json")]
    return {json.loads((slot / "reason.json").read_text())["ref"]: slot / "artifact" for slot in slots}
