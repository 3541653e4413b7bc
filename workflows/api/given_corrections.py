"""Corrections as the command line and Python give them, each edit with the place where it was written."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from moseg.schemas.corrections import Corrections, Edit, kind_of
from moseg.schemas.errors import InputError
from moseg.workflows.config.corrections_file import CorrectionsLike, name_source, read_corrections
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.pipelines.placed_edits import PlacedEdits

CORRECTIONS = "corrections.yaml"
"""Name of the file beside a result that holds the corrections in force."""


class GivenCorrections(NamedTuple):
    """Corrections, and where they come from.

    Attributes
    ----------
    corrections : Corrections
    source : str
        What they were given by: a file, an option or an argument.
    places : tuple of str
        Where each edit was written.
    """

    corrections: Corrections = Corrections()
    source: str = "corrections"
    places: tuple[str, ...] = ()

    @property
    def edits(self) -> PlacedEdits:
        """The edits with their places."""
        return PlacedEdits(self.corrections.edits, self.places)

    def notes(self, origin: FrameOrigin) -> tuple[str, ...]:
        """Return notes on a result: that it is corrected, and that the corrections are of another part of the video.

        They are empty without corrections.
        """
        found = {"setting": len(self.corrections.settings), "edit": len(self.corrections.edits)}
        told = [f"{count} {name}{'' if count == 1 else 's'}" for name, count in found.items() if count]
        notes = [f"corrected by {' and '.join(told)}"] if told else []
        meant, part = self.corrections.part or "all frames", origin.part or "all frames"
        # A file without a video was written by hand, and need not say which part it is of.
        if told and self.corrections.video is not None and meant != part:
            notes.append(
                f"{self.source} was written for {meant}, and this run reads {part}: numbers of frames and objects in it"
                " may mean others here"
            )
        return tuple(notes)

    def is_from(self, path: Path) -> bool:
        """Return whether the corrections were read from an existing file."""
        return os.path.exists(self.source) and os.path.samefile(self.source, path)

    def check_video(self, origin: FrameOrigin) -> None:
        """Raise InputError if the corrections are those of another video."""
        meant = self.corrections.video
        if meant is not None and origin.identity is not None and meant != origin.identity:
            got, expected = f"those of video {meant[:12]}…", f"video {origin.identity[:12]}…, {origin.path}"
            raise InputError("corrections of another video", where=self.source, got=got, expected=expected)

    def of_video(self, origin: FrameOrigin) -> Corrections:
        """Return the corrections with the digest of their video and its part."""
        return self.corrections.model_copy(update={"video": origin.identity, "part": origin.part})


NO_CORRECTIONS = GivenCorrections()


def give_corrections(
    corrections: CorrectionsLike | None, argument: str = "corrections", more: Sequence[tuple[str, Edit]] = ()
) -> GivenCorrections:
    """Return corrections with the places of their edits.

    Parameters
    ----------
    corrections : Corrections, mapping, list of edits or path, optional
    argument : str
        What they were given by, where not by a file.
    more : sequence of (str, Edit)
        Edits that follow, each with the option that it was given by.

    Raises
    ------
    InputError
        They are not corrections.
    """
    source = name_source(corrections, argument)
    found = Corrections() if corrections is None else read_corrections(corrections, argument)
    places = [f"{source}: edit {number} ({kind_of(edit)})" for number, edit in enumerate(found.edits, start=1)]
    places += [option for option, _ in more]
    return GivenCorrections(found.extended(edit for _, edit in more), source, tuple(places))


def check_kept(path: Path, given: GivenCorrections, argument: str) -> None:
    """Check that no corrections are lost if others are written to a file.

    Raises
    ------
    InputError
        The file has settings or edits that are not among those in force, or is no file of corrections.
    """
    if not path.exists():
        return
    earlier, later = read_corrections(path), given.corrections
    if earlier.settings.keys() <= later.settings.keys() and all(edit in later.edits for edit in earlier.edits):
        return
    if given.is_from(path):
        return
    got = "edits or settings that this run does not have"
    expected = f"--corrections {path} first, another {argument}, or the file moved away"
    raise InputError("corrections would be lost", where=path, got=got, expected=expected)
