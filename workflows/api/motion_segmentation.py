"""The moving objects of one video, read from the store when they are asked for."""

import operator
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np
from PIL import Image

from moseg.schemas.corrections import Corrections
from moseg.schemas.errors import InputError
from moseg.schemas.scores import StoreUse
from moseg.schemas.stretch_choice import StretchChoice
from moseg.store import ArtifactStore
from moseg.workflows.api.arguments import (
    Kind,
    check_kinds,
    check_min,
    check_style,
    named_as_arguments,
    read_names,
)
from moseg.workflows.api.given_corrections import NO_CORRECTIONS, GivenCorrections
from moseg.workflows.api.moving_object import MovingObject
from moseg.workflows.api.notebook import draw_html
from moseg.workflows.api.segmentation import Outputs
from moseg.workflows.api.strip import draw_strip, spread_frames
from moseg.workflows.exports import OverlayStyle
from moseg.workflows.exports.draw_overlay import draw_overlay
from moseg.workflows.exports.frame_origin import FrameOrigin
from moseg.workflows.exports.overlay_style import DEFAULT_STYLE
from moseg.workflows.pipelines.segment import StoredSegmentation


@dataclass(frozen=True, eq=False, repr=False)
class MotionSegmentation:
    """The moving objects of one video.

    It is light: labels, frames, affinities and residuals lie in the artifact store and are read when they are asked
    for. What it was made from is pinned there, so `moseg store gc` keeps it. Made by `segment_video`.

    Attributes
    ----------
    name : str
    shape : (int, int)
        Height and width of the video's frames and of the labels, px.
    analysed_shape : (int, int)
        Height and width of the frames as analysed, at most ``config.max_side``, px.
    fps : float
        Frames per second.
    num_frames : int
    num_motions : int
        Motion groups found, the background's included.
    objects : tuple of MovingObject
        By identity; empty where nothing moves.
    store_use : StoreUse
        Artifacts that the call computed, and those that it found in the store.
    notes : tuple of str
        What must be known to read the result rightly; mostly empty.
    look_at : tuple of str
        Objects that are worth a look, in words: they shrink at once, rest, or are doubtful or incomplete.
    """

    name: str
    shape: tuple[int, int]
    analysed_shape: tuple[int, int]
    fps: float
    num_frames: int
    num_motions: int
    objects: tuple[MovingObject, ...]
    store_use: StoreUse
    _store: ArtifactStore
    _stored: StoredSegmentation
    _origin: FrameOrigin
    _given: GivenCorrections = NO_CORRECTIONS
    notes: tuple[str, ...] = ()
    look_at: tuple[str, ...] = ()

    @cached_property
    def labels(self) -> np.ndarray:
        """uint16 (frame, y, x) at the video's size: 0 static, else a moving object's identity.

        Read once and kept: 2 bytes a pixel, for a minute of 1280x720 px at 24 frames per second 2.7 GB. `iter_labels`
        has one frame in memory at a time.
        """
        labels = np.empty((self.num_frames, *self.shape), np.uint16)
        for index, frame in enumerate(self.iter_labels()):
            labels[index] = frame
        return labels

    @property
    def moving(self) -> np.ndarray:
        """bool (frame, y, x): what moves on its own."""
        return self.labels > 0

    def iter_labels(self) -> Iterator[np.ndarray]:
        """Yield uint16 (y, x) of every frame at the video's size."""
        return self._stored.labels(self._store)

    def frames(self) -> Iterator[np.ndarray]:
        """Yield every frame as analysed, uint8 (y, x, 3) RGB of `analysed_shape`."""
        return self._stored.frames(self._store)

    @property
    def cues(self) -> tuple[str, ...]:
        """Names of the cues of frames that the result was computed from, which `cue` reads."""
        return tuple(self._stored.cues)

    def cue(self, name: str, frame: int) -> np.ndarray:
        """Read a cue of one frame. The run must have kept its cues: ``segment_video(..., keep_cues=True)``.

        Parameters
        ----------
        name : str
            One of `cues`.
        frame : int
            Counted from 0; from -1 backwards. ``flow`` and ``residual_flow`` lead to the next frame, or to the next one
            that does not repeat this frame: the last frame of a scene has neither. In slow motion they are the share of
            one frame in the motion to a frame farther away, which the last few frames of a scene do not have.

        Returns
        -------
        ``flow`` : float32 (y, x, 2) of `analysed_shape`
            Motion of every pixel to the next frame, (x, y), px of that size; NaN where flow from files is unknown.
        ``residual_flow`` : float32 (y, x, 2) on the grid of the saliency
            The flow minus that of the background, in the same unit.
        ``saliency`` : float32 (y, x) on its grid
            Confidence that a pixel moves differently from the background, 0..1.
        ``inverse_depth`` : float32 (y, x) of `analysed_shape`
            Relative: larger is nearer.

        Raises
        ------
        InputError
            There is no such cue, or it was not kept.
        IndexError
            There is no such frame, or it does not have the cue.
        """
        cue = self._stored.cues.get(name)
        if cue is None:
            raise InputError("no such cue", where="name", got=repr(name), expected=", ".join(self.cues) or "no cue")
        index = _place_frame(frame, self.num_frames)
        if index not in cue.frames:
            reason = f"frame {index} is the last one of its scene, repeated up to it, or near it in slow motion"
            raise IndexError(f"{name} leads to the next frame, and {reason}")
        refs = cue.refs(index)
        if not self._store.present(set(refs)).issuperset(refs):
            got, expected = "a run that did not keep its cues", "segment_video(…, keep_cues=True)"
            raise InputError(f"{name} of frame {index} is missing", where="the store", got=got, expected=expected)
        return cue.read(self._store, *refs)

    @property
    def corrections(self) -> Corrections:
        """The corrections in force, with the digest of the video that they are for."""
        return self._given.of_video(self._origin)

    @property
    def choices(self) -> tuple[StretchChoice, ...]:
        """Source of the proposals of each stretch, with its figures; empty if the configuration names the source."""
        return self._stored.choices

    def overlay(self, frame: int, style: OverlayStyle | None = None) -> np.ndarray:
        """Draw the moving objects of one frame into it.

        Parameters
        ----------
        frame : int
            Counted from 0; from -1 backwards.
        style : OverlayStyle, optional
            By default tinted and outlined.

        Returns
        -------
        uint8 (y, x, 3) RGB
            Of `analysed_shape`; twice as wide where the style is side by side.

        Raises
        ------
        IndexError
            There is no such frame.
        """
        check_style(style)
        index = _place_frame(frame, self.num_frames)
        image = self._store.read(self._stored.frame_refs[index], "image")
        labels = self._stored.frame_labels(self._store, index, self.analysed_shape)
        return draw_overlay(image, labels, style or DEFAULT_STYLE, self._stored.called)

    def figure(self, num_frames: int = 6, *, style: OverlayStyle | None = None, side: int = 320) -> Image.Image:
        """Draw frames spread over the video with their moving objects, three in a row.

        Parameters
        ----------
        num_frames : int
            1 or more; no more are drawn than there are.
        style : OverlayStyle, optional
        side : int
            Longer side of each frame in the figure, px.

        Returns
        -------
        PIL.Image.Image
            RGB; a notebook shows it where it is the last line of a cell, ``save`` writes it.

        Raises
        ------
        InputError
            A number is below 1, or the style is not an OverlayStyle.
        """
        check_min(1, num_frames=num_frames, side=side)
        indices = spread_frames(self.num_frames, num_frames)
        return draw_strip({index: self.overlay(index, style) for index in indices}, side)

    @property
    def row_identities(self) -> tuple[int, ...]:
        """What the rows and columns of `affinities` and `residuals` stand for: 0 the background, else an identity.

        Objects that were found static are among them.
        """
        return self._stored.rows

    @cached_property
    def affinities(self) -> dict[str, np.ndarray]:
        """Affinity between objects under each motion model, float64 (k, k), 0..1; NaN where two share no frame pair,
        as objects of different scenes do.

        Row 0 is the background's, the others `row_identities` names. Empty for the variant ``base``.
        """
        return self._stored.evidence.affinities(self._store)

    @cached_property
    def residuals(self) -> dict[str, np.ndarray]:
        """Residuals under each motion model, float64 (frame pair, k, k), px².

        Entry [m, i, j] is the error of object j's data under object i's model in pair m; NaN where that model is
        invalid or the object absent. Rows as those of `affinities`. Empty for the variant ``base``, and where
        affinities come from hypotheses alone.
        """
        return self._stored.evidence.residuals(self._store)

    @named_as_arguments()
    def save(
        self,
        folder: str | os.PathLike,
        *,
        style: OverlayStyle | None = DEFAULT_STYLE,
        overlay_size: Literal["analysed", "video"] = "analysed",
        exports: str | Iterable[str] = (),
        dilation: int | None = None,
    ) -> tuple[Path, ...]:
        """Write what `moseg segment` writes: ``masks/00000.png`` …, ``overlay.mp4`` and ``motion.json``.

        Parameters
        ----------
        folder : path
            Made where it is absent.
        style : OverlayStyle, optional
            Of the overlay; None for no overlay.
        overlay_size : 'analysed' or 'video'
            Size of the overlay: that of the frames as analysed; or the video's own, for which the file or the folder of
            frames is read again.
        exports : str or iterable of str
            Formats to write beside it, as those of `moseg export`: ``coco``, ``colmap``, ``npz`` …
        dilation : int, optional
            How far masks of what moves are widened in the formats that ignore it, px; by default as each format has it.

        Returns
        -------
        tuple of Path
            The files and folders that were written.

        Raises
        ------
        InputError
            The folder cannot be written; a file would be replaced that is not ours, or the video itself; there is no
            such format, or one that cannot hold these frames.
        """
        check_kinds(Kind.PATH, folder=folder)
        check_style(style)
        if overlay_size not in ("analysed", "video"):
            raise InputError("no such size", where="overlay_size", got=repr(overlay_size), expected="analysed or video")
        if dilation is not None:
            check_min(0, dilation=dilation)
        outputs = Outputs(
            os.fsdecode(folder),
            self._origin,
            style,
            self.name,
            overlay_size == "video",
            read_names("exports", exports),
            dilation,
            "folder",
            self.num_frames,
            corrections=self._given,
        )
        with outputs:
            outputs.write(self._store, self._stored, self.fps)
            return (*outputs.paths, *outputs.export())

    def __repr__(self) -> str:
        return f"<MotionSegmentation {self.name!r}: {self._summary}>"

    def _repr_html_(self) -> str:
        return draw_html(self.name, self._summary, self.objects, self.figure(3, side=300), self.notes)

    @property
    def _summary(self) -> str:
        count, (height, width) = len(self.objects), self.shape
        objects = f"{count} moving object{'' if count == 1 else 's'}"
        return f"{objects} in {self.num_frames} frames of {width}x{height} px"


def _place_frame(frame: int, num_frames: int) -> int:
    """Return a frame's place, counted from 0, where -1 is the last one."""
    frame = operator.index(frame)
    if not -num_frames <= frame < num_frames:
        raise IndexError(f"no frame {frame}: the video has {num_frames}")
    return frame % num_frames
