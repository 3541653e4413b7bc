"""Identities of objects that return after a gap, found by colour, size and path over the whole sequence."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import ndimage

from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.proposals.rejoining import Sight, agreement, look, rename, renumber
from moseg.tasks.saliency.consistency import NEXT

BEGIN, END = 0, 1


class Sightings(NamedTuple):
    """Look of the objects 1.. of a section where they begin and where they end; rows of unseen objects are zeros.

    Attributes
    ----------
    frames : int32 (object, end, 2)
        First or last frame of the object, and the frame nearest to it in which the object is fully visible; -1 unseen.
    places : float32 (object, end, 5)
        Centre xy in that frame, velocity xy relative to the background, and area; px, px/frame of the working grid.
    colours : float16 (object, end, 8, 32, 32)
        Shares of CIELAB colours.
    camera : float32 (frame, 2)
        Median motion of the background to the next frame, px/frame.
    """

    frames: np.ndarray
    places: np.ndarray
    colours: np.ndarray
    camera: np.ndarray


def see_objects(
    labels: np.ndarray, images: np.ndarray, flows: np.ndarray, residual_flows: np.ndarray, params: IdentityParams
) -> Sightings:
    """Describe a section's objects at both of their ends.

    Parameters
    ----------
    labels : uint16 (T, h, w)
        Objects 1.. of the working grid; 0 = background.
    images : uint8 (T, h, w, 3)
        RGB.
    flows, residual_flows : float32 (T, 2, h, w, 2)
        To the previous and the next frame, and the same less the background's, px/frame.
    params : IdentityParams
    """
    boxes = ndimage.find_objects(labels.astype(np.int32))
    count = len(boxes)
    frames, places = np.full((count, 2, 2), -1, np.int32), np.zeros((count, 2, 5), np.float32)
    colours = np.zeros((count, 2, 8, 32, 32), np.float16)
    for index, box in enumerate(boxes):
        if box is None:
            continue
        for end in (BEGIN, END):
            sight = look(labels, images, residual_flows, index + 1, box, end == END, params)
            frames[index, end] = (sight.first, sight.last)[end], sight.frame
            places[index, end] = *sight.centre, *sight.velocity, sight.area
            colours[index, end] = sight.histogram
    some = (NEXT, slice(None, None, 4), slice(None, None, 4))
    background = [np.median(flows[t, *some] - residual_flows[t, *some], axis=(0, 1)) for t in range(len(labels))]
    return Sightings(frames, places, colours, np.array(background, np.float32))


def find_returns(
    identity: np.ndarray,
    starts: Sequence[int],
    seen: Sequence[Sightings | None],
    frame_area: int,
    params: IdentityParams,
) -> np.ndarray:
    """Give an identity that begins where an earlier one's path leads it the earlier identity.

    Position, velocity, area and colours must agree, as for a component that is rejoined within a section; here the gap
    may be up to `return_gap` frames. Its place is predicted from its velocity and the background's median motion.

    Parameters
    ----------
    identity : uint16 (section, maximal number of objects + 1)
        Of `link_sections`.
    starts : sequence of int
        First frame of each section.
    seen : sequence of Sightings or None
        Of each section; None where there are none.
    frame_area : int
        Pixels of the working grid.
    params : IdentityParams

    Returns
    -------
    identity : as `identity`
        Identities that returned have the earliest number; numbers stay without gaps.
    """
    begins, ends = {}, {}
    for section, (start, sightings) in enumerate(zip(starts, seen, strict=True)):
        if sightings is None:
            # Objects of other sources have no sightings: an identity with one is left alone.
            for name in identity[section, 1:]:
                begins[int(name)] = ends[int(name)] = None
            continue
        for index, frames in enumerate(sightings.frames):
            name = int(identity[section, index + 1])
            if frames[BEGIN, 0] < 0:
                continue
            first, last = (_sight(sightings, index, end, start) for end in (BEGIN, END))
            if name not in begins:
                begins[name], ends[name] = first, last
            elif begins[name] is not None:
                # Of the parts of an object in one section, any may be the first.
                begins[name] = min(begins[name], first, key=lambda sight: sight.first)
                ends[name] = max(last, ends[name], key=lambda sight: sight.last)
    camera = _path_of_camera(starts, seen)
    names = [name for name in begins if name and begins[name] is not None and ends[name] is not None]
    gains = np.zeros((int(identity.max(initial=0)) + 1,) * 2)
    spans = {name: (begins[name].first, ends[name].last) for name in names}
    for i in names:
        for j in names:
            before, after = ends[i], begins[j]
            if 0 < spans[j][0] - spans[i][1] <= params.return_gap + 1 and after.frame < len(camera):
                moved = camera[after.frame] - camera[before.frame]
                own = (before.velocity + after.velocity) / 2 * (after.frame - before.frame)
                gains[i, j] = agreement(before, after, before.centre + moved + own, frame_area, params)
    return renumber(identity, rename(gains, spans))


def _sight(sightings: Sightings, index: int, end: int, start: int) -> Sight:
    """Return one end of an object's sighting, with frames counted from the sequence's first."""
    (first, _), (last, _) = sightings.frames[index]
    x, y, u, v, area = sightings.places[index, end].astype(np.float64)
    return Sight(
        first=start + int(first),
        last=start + int(last),
        frame=start + int(sightings.frames[index, end, 1]),
        centre=np.array([x, y]),
        velocity=np.array([u, v]),
        area=float(area),
        histogram=sightings.colours[index, end].astype(np.float32),
    )


def _path_of_camera(starts: Sequence[int], seen: Sequence[Sightings | None]) -> np.ndarray:
    """Return the summed motion of the background from the first frame to each, float64 (frame, 2), px."""
    steps = np.zeros((0, 2))
    for start, sightings in zip(starts, seen, strict=True):
        missing = np.zeros((max(start - len(steps), 0), 2))
        # The frames that a section shares with the next are the next one's.
        steps = np.concatenate([steps[:start], missing, np.zeros((0, 2)) if sightings is None else sightings.camera])
    return np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
