"""Cues that the user gives as folders: masks as object proposals, maps of inverse depth, optical flow, point tracks."""

import os

from moseg.schemas.errors import MissingInputError
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.sources import FlowFiles, open_depth, open_flow, open_masks, open_tracks


def with_given_folders(source: SequenceSource, folders: dict[str, str], max_side: int) -> SequenceSource:
    """Return the sequence with its `proposals`, `depth`, `flow` and `tracks` read from folders.

    A folder of the sequence's name below the given path is used; if there is none, the path itself. Tracks are one
    file: see `open_tracks`.
    """
    if "proposals" in folders:
        path = _folder_of(source, "proposals", folders["proposals"])
        masks = open_masks(path, source.frames)
        # Together with other ids 255 is void, as in DAVIS and YouTube-VOS; alone it is an object.
        source = source._replace(objects=masks, objects_void=255 if masks.kind == "instance" else None)
    if not folders.keys() & {"depth", "flow", "tracks"}:
        return source
    num_frames = source.frames.num_frames()
    if "depth" in folders:
        path = _folder_of(source, "depth", folders["depth"])
        source = source._replace(depth=open_depth(path, source.frames, num_frames, max_side))
    if "flow" in folders:
        path = _folder_of(source, "flow", folders["flow"])
        forward, backward = _open_both_flows(path, source, num_frames, max_side)
        source = source._replace(flow_forward=forward, flow_backward=backward)
    if "tracks" in folders:
        path = _folder_of(source, "tracks", folders["tracks"], may_be_file=True)
        source = source._replace(tracks=open_tracks(path, source.name, source.frames, num_frames, max_side))
    return source


def _open_both_flows(
    path: str, source: SequenceSource, num_frames: int, max_side: int
) -> tuple[FlowFiles, FlowFiles | None]:
    """Open the flow of the folders ``forward`` and ``backward``; without the first, the files of `path` are forward."""
    forward, backward = (os.path.join(path, direction) for direction in ("forward", "backward"))
    return (
        open_flow(forward if os.path.isdir(forward) else path, source.frames, num_frames, max_side),
        open_flow(backward, source.frames, num_frames, max_side) if os.path.isdir(backward) else None,
    )


def _folder_of(source: SequenceSource, cue: str, path: str, may_be_file: bool = False) -> str:
    below = os.path.join(path, source.name)
    if os.path.isdir(below):
        return below
    if not os.path.isdir(path) and not (may_be_file and os.path.isfile(path)):
        raise MissingInputError("no such folder", where=f"--{cue} folder:{path}")
    return path
