"""Ways to damage an artifact's files, and the choice of artifacts whose damage a run will meet."""

import json
import random
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import split_ref


def _flip(content: bytes, rng: random.Random) -> bytes:
    position = rng.randrange(len(content))
    changed = content[position] ^ rng.randrange(1, 256)
    return content[:position] + bytes([changed]) + content[position + 1 :]


DAMAGES: dict[str, Callable[[bytes, random.Random], bytes | None]] = {
    "flipped byte": _flip,
    "truncation": lambda content, rng: content[: rng.randrange(1, len(content))],
    "deletion": lambda content, rng: None,
    "emptied": lambda content, rng: b"",
    "extra byte": lambda content, rng: content + bytes([rng.randrange(256)]),
}
"""A file's new content; None if the file is deleted."""
KINDS: dict[str, Callable[[str], bool]] = {
    "manifest": lambda path: path == "manifest.json",
    "pack": lambda path: path == "arrays.zip",
}
"""Kinds of an artifact's files, by path inside the artifact."""


class Damaged(NamedTuple):
    """A damaged file: its path inside the artifact, and its new content, None if it is deleted."""

    path: str
    content: bytes | None


def folder_of(root: Path, ref: str) -> Path:
    """Return the folder of an artifact in a local store."""
    task, key = split_ref(ref)
    return root / "objects" / task / key[:2] / key


def inflict(folder: Path, kind: str, damage: str, rng: random.Random) -> Damaged | None:
    """Damage one file of a kind in an artifact's folder; return None if it has no such file."""
    files = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if path.is_file()}
    names = [name for name in files if KINDS[kind](name)]
    if not names:
        return None
    name = rng.choice(names)
    content = DAMAGES[damage](files[name].read_bytes(), rng)
    if content is None:
        files[name].unlink()
    else:
        files[name].write_bytes(content)
    return Damaged(name, content)


def choose_artifacts(manifests: Mapping[str, Manifest], rng: random.Random) -> list[str]:
    """Choose one artifact of each task, if possible one from which another of them was computed.

    So a run that misses the last one also misses the others.
    """
    refs = sorted(manifests)
    rng.shuffle(refs)
    chosen = [ref for ref in refs if ref.startswith("score/")][:1]
    tasks = {split_ref(ref)[0] for ref in chosen}
    for ref in chosen:
        inputs = list(manifests[ref].recipe.input_refs())
        rng.shuffle(inputs)
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
    """Return the references of all artifacts that were computed from any of `refs`."""
    refs = set(refs)
    reached = set(refs)
    while True:
        new = {ref for ref, manifest in manifests.items() if reached.intersection(manifest.recipe.input_refs())}
        if new <= reached:
            return reached - refs
        reached |= new


def read_quarantine(root: Path) -> dict[str, Path]:
    """Return the folders of the artifacts in quarantine, by reference."""
    slots = [reason.parent for reason in (root / "quarantine").glob("*/reason.json")]
    return {json.loads((slot / "reason.json").read_text())["ref"]: slot / "artifact" for slot in slots}
