"""Sequences in which nothing moves: rendered scenes, the user's recordings, and sequences made from pictures."""

import os
from dataclasses import dataclass

from moseg.schemas.errors import InputError, MissingInputError
from moseg.tasks.synthetic import STILL_SCENES
from moseg.workflows import sources
from moseg.workflows.datasets.dataset import SequenceSource
from moseg.workflows.datasets.folder import FOLDER
from moseg.workflows.datasets.sequence_folders import holds_images, list_sequences
from moseg.workflows.datasets.two_trees import DAVIS16, DAVIS_MOVING
from moseg.workflows.sources.files import IMAGE_SUFFIXES, list_files, stem

PICTURES = "stills"
"""Folder of pictures below the root."""
_DAVIS_PLACES = (".", *(os.path.join("..", name) for name in (DAVIS16.name, DAVIS_MOVING.name, "davis")))
"""Places of DAVIS relative to the root, of which the first that has its tree of frames is used. The default root lies
beside the other data sets of ``$MOSEG_DATA``."""


@dataclass(frozen=True)
class StillSequences:
    """Rendered scenes, which need no root, and below a root recordings, pictures and DAVIS.

    A picture, or the first frame of a DAVIS sequence, becomes a sequence as `WarpedPicture` makes it. Every pixel that
    is labelled as moving is wrong, so that no ground truth is needed.
    """

    name: str = "still"
    needs_root: bool = False
    official: None = None
    list_name: None = None
    ground_truth: str = "none needed: nothing moves, so every pixel that is labelled as moving is wrong"
    tree: str = (
        f"<sequence>/frames/*, recordings in which nothing moves; or {PICTURES}/<name>.jpg, pictures of which each "
        f"becomes a sequence; or {DAVIS16.frames}/<sequence>/*.jpg, DAVIS, of which each first frame becomes a sequence"
        f" (here, in ../{DAVIS16.name}, ../{DAVIS_MOVING.name} or ../davis)"
    )
    source: str = "rendered, no download; below a root your own recordings and pictures, and DAVIS"

    def on_disk(self, root: str | None) -> tuple[str, ...]:
        """Return the rendered scenes, then recordings, pictures and DAVIS.

        Raises
        ------
        InputError
            Two sequences have one name.
        MissingInputError
            There is a folder `root` with none of them, nor DAVIS beside it.
        """
        found = self._below(root)
        names = (*STILL_SCENES, *(name for group in found.values() for name in group))
        if len(set(names)) < len(names):
            double = next(name for name in names if names.count(name) > 1)
            raise InputError("two sequences of one name", where=root, got=double, expected="one of them")
        if root is not None and os.path.isdir(root) and not any(found.values()):
            raise MissingInputError("no sequence", where=root, expected=self.tree)
        return names

    def missing(self, root: str | None) -> tuple[str, ...]:
        """Return the kinds of sequences that are not below the root."""
        return tuple(kind for kind, group in self._below(root).items() if not group)

    def open_sequence(self, root: str | None, name: str, max_side: int) -> SequenceSource:
        """Return the sources of one sequence."""
        if name in STILL_SCENES:
            return _open_scene(name)
        recorded, *others = self._below(root).values()
        if name in recorded:
            return SequenceSource(name, FOLDER.open_sequence(root, name, max_side).frames, nothing_moves=True)
        path = next(group[name] for group in others if name in group)
        return SequenceSource(name, sources.WarpedPicture(path, max_side), nothing_moves=True)

    def _below(self, root: str | None) -> dict[str, dict[str, str]]:
        """Return the path of each sequence by kind and name: recordings, pictures and DAVIS."""
        places = ([], [], []) if root is None else (_recordings(root), _pictures(root), _davis(root))
        kinds = ("a recording (<sequence>/frames)", f"a picture ({PICTURES}/*.jpg)", f"DAVIS ({DAVIS16.frames})")
        return {kind: dict(found) for kind, found in zip(kinds, places, strict=True)}


def _open_scene(name: str) -> SequenceSource:
    return SequenceSource(
        name,
        frames=sources.SceneFrames(name),
        nothing_moves=True,
        objects=sources.SceneMasks(name, "objects"),
        depth=sources.SceneDepth(name),
        flow_forward=sources.SceneFlow(name, "forward"),
        flow_backward=sources.SceneFlow(name, "backward"),
        tracks=sources.SceneTracks(name),
    )


def _recordings(root: str) -> list[tuple[str, str]]:
    if not os.path.isdir(root):
        return []
    try:
        return [(name, root) for name in FOLDER.on_disk(root)]
    except MissingInputError:
        return []


def _pictures(root: str) -> list[tuple[str, str]]:
    folder = os.path.join(root, PICTURES)
    if not holds_images(folder):
        return []
    return [(f"picture-{stem(path)}", path) for path in list_files(folder, IMAGE_SUFFIXES)]


def _davis(root: str) -> list[tuple[str, str]]:
    trees = (os.path.normpath(os.path.join(root, place, DAVIS16.frames)) for place in _DAVIS_PLACES)
    tree = next(filter(os.path.isdir, trees), None)
    if tree is None:
        return []
    firsts = ((name, list_files(os.path.join(tree, name), IMAGE_SUFFIXES)[0]) for name in list_sequences(tree, ("",)))
    return [(f"davis-{name}", first) for name, first in firsts]


STILL = StillSequences()
