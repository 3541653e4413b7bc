"""Corrections of a segmentation: settings in place of the run's, and edits of its objects in their order.

Objects are the identities of ``motion.json`` and of the masks. Frames are counted from 0 among the frames that the run
reads. Coordinates are xy, px of the video's own frames, pixel centres at integers.
"""

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, JsonValue, StringConstraints, Tag, model_validator

from moseg.schemas.frozen import Frozen

MAX_IDENTITY = (1 << 16) - 1
"""Largest identity that masks can hold."""


def _refuse_bool(value: object) -> object:
    if isinstance(value, bool):
        raise ValueError("a number")
    return value


Identity = Annotated[int, BeforeValidator(_refuse_bool), Field(ge=1, le=MAX_IDENTITY)]
FrameIndex = Annotated[int, BeforeValidator(_refuse_bool), Field(ge=0)]
Coordinate = Annotated[float, Field(ge=-100_000, le=100_000)]
Point = tuple[Coordinate, Coordinate]
Name = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=100, pattern=r"^[^\x00-\x1f\x7f-\x9f]*$")
]


class Drop(Frozen):
    """An object is no object of the result; its motion still counts."""

    drop: Identity


class Keep(Frozen):
    """An object stays in the result whatever the settings say; one that was found static is promoted."""

    keep: Identity


class Static(Frozen):
    """An object belongs to the background's motion."""

    static: Identity


class Moving(Frozen):
    """An object moves on its own: it has a motion group for itself."""

    moving: Identity


class Merge(Frozen):
    """Several objects are one, with the identity of the first, and the motion of the first that is in the result."""

    merge: tuple[Identity, ...] = Field(min_length=2)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if len(set(self.merge)) < len(self.merge):
            raise ValueError("objects that differ")
        return self


class SplitAt(Frozen):
    """From a frame on, an object is another one, whose number is not in use; None for the next free number."""

    object: Identity
    frame: FrameIndex = Field(ge=1)
    into: Identity | None = None


class Split(Frozen):
    """An object is two, one after the other."""

    split: SplitAt


class Naming(Frozen):
    """Name of an object."""

    object: Identity
    name: Name


class Rename(Frozen):
    """An object has a name."""

    rename: Naming


class Stroke(Frozen):
    """Line of a round brush.

    Attributes
    ----------
    radius : float
        px of the video's own frames.
    points : tuple of (float, float)
        xy, px; one point is a disc.
    """

    radius: float = Field(gt=0, le=10_000)
    points: tuple[Point, ...] = Field(min_length=1)


class Painting(Frozen):
    """Strokes that make an object larger in a frame; an object of a new number is new."""

    object: Identity
    frame: FrameIndex
    strokes: tuple[Stroke, ...] = Field(min_length=1)


class Paint(Frozen):
    """Strokes are an object, and are carried along the flow to `carrying.reach` frames beyond their section."""

    paint: Painting


class Erasing(Frozen):
    """Strokes that remove an object, or whatever is there, in a frame."""

    object: Identity | None = None
    frame: FrameIndex
    strokes: tuple[Stroke, ...] = Field(min_length=1)


class Erase(Frozen):
    """Strokes are no object, and are carried along the flow as far as those of `Paint`."""

    erase: Erasing


class Growing(Frozen):
    """Points of an object in a frame.

    Attributes
    ----------
    points, not_points : tuple of (float, float)
        xy, px: points on the object, and beside it.
    by : 'region' or 'sam2'
        Whether it grows from motion and colour, or is outlined by SAM 2.1.
    """

    object: Identity
    frame: FrameIndex
    points: tuple[Point, ...] = Field(min_length=1)
    not_points: tuple[Point, ...] = ()
    by: Literal["region", "sam2"] = "region"


class Add(Frozen):
    """An object grows from points; one of a new number is new."""

    add: Growing


KINDS = {
    kind: model
    for model in (Drop, Keep, Static, Moving, Merge, Split, Rename, Paint, Erase, Add)
    for kind in model.model_fields
}
"""Kinds of edits by their names."""


def kind_of(value: Any) -> str | None:
    """Return the name of the kind of an edit, as in the file, whether it is read or not yet; None if there is none."""
    if isinstance(value, tuple(KINDS.values())):
        return next(iter(type(value).model_fields))
    if isinstance(value, Mapping) and len(value) == 1:
        (kind,) = value
        return kind if kind in KINDS else None
    return None


Edit = Annotated[
    Annotated[Drop, Tag("drop")]
    | Annotated[Keep, Tag("keep")]
    | Annotated[Static, Tag("static")]
    | Annotated[Moving, Tag("moving")]
    | Annotated[Merge, Tag("merge")]
    | Annotated[Split, Tag("split")]
    | Annotated[Rename, Tag("rename")]
    | Annotated[Paint, Tag("paint")]
    | Annotated[Erase, Tag("erase")]
    | Annotated[Add, Tag("add")],
    Discriminator(kind_of),
]
"""One edit; as JSON or YAML a mapping from its kind to its values, such as ``{"drop": 2}``."""


def _read_version(value: object) -> object:
    return 1 if value == "1" else value


class Corrections(Frozen):
    """Corrections of the segmentation of one video by its user; empty without settings and edits.

    ``model_validate`` reads mappings, ``model_dump(exclude_defaults=True)`` returns them.

    Attributes
    ----------
    version : int
        Version of the format.
    video : str or None
        Digest of the video as in ``motion.json``; corrections of another video are refused.
    part : str or None
        The frames of the video that were read, in words, if they were not all of them.
    settings : dict of str to JSON value
        Parameters as ``stage.name``, in place of the run's.
    edits : tuple of Edit
        In the order in which they apply.
    """

    version: Annotated[Literal[1], BeforeValidator(_read_version)] = 1
    video: str | None = Field(None, pattern=r"^[0-9a-f]+$")
    part: str | None = Field(None, max_length=1000)
    settings: dict[str, JsonValue] = {}
    edits: tuple[Edit, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.settings or self.edits)

    def extended(self, edits: Iterable[Edit]) -> Self:
        """Return the corrections with more edits after their own."""
        return self.model_copy(update={"edits": (*self.edits, *edits)})
