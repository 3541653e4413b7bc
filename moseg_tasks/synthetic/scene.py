"""The description of a scene: a backdrop, objects made of parts, and a moving camera, declared as data."""

from pydantic import Field, field_validator

from moseg.schemas.frozen import Frozen
from moseg.tasks.synthetic.paths import STILL, Path, Vector
from moseg.tasks.synthetic.shapes import Billboard, Shape
from moseg.tasks.synthetic.texture import Texture


class Part(Frozen):
    """A textured shape. It turns by ``angles`` about ``position`` and lies at ``offset`` from that pivot."""

    shape: Shape
    texture: Texture
    position: Path = STILL
    angles: Path = Field(STILL, description="pitch, yaw, roll, degrees")
    offset: Vector = (0.0, 0.0, 0.0)

    @property
    def is_moving(self) -> bool:
        """Whether the part moves, turns or bends within its object."""
        bends = isinstance(self.shape, Billboard) and not self.shape.bend.is_constant
        return bends or not (self.position.is_constant and self.angles.is_constant)


class Thing(Frozen):
    """A prominent object, static or moving: parts that share an identity and a path."""

    parts: tuple[Part, ...] = Field(min_length=1)
    position: Path = STILL
    angles: Path = Field(STILL, description="pitch, yaw, roll, degrees")

    @property
    def is_moving(self) -> bool:
        """Whether the object, or any part of it, moves in the world."""
        return not (self.position.is_constant and self.angles.is_constant) or any(p.is_moving for p in self.parts)


class CameraPath(Frozen):
    """A pinhole camera with square pixels and its principal point in the middle of the frame."""

    position: Path = Path(start=(0.0, -1.5, 0.0))
    angles: Path = Field(STILL, description="pitch, yaw, roll, degrees")
    focal: float = Field(0.95, gt=0, description="focal length at frame 0, in widths of the frame")
    zoom: float = Field(0.0, description="growth of the focal length per frame, relative to frame 0")


class Scene(Frozen):
    """A sequence to render.

    Attributes
    ----------
    description : str
        Difficulty of the sequence, one line.
    num_motions : int
        Distinct motions in the world, the background's included; a non-rigid object counts as one.
    backdrop : tuple of Part
        Static surfaces that together fill the frame; they are object 0.
    things : tuple of Thing
        Prominent objects; the first has identity 1.
    gain, bias : Path
        Factor and offset (grey levels) of the red, green and blue channels over time.
    noise : float
        Standard deviation of the sensor's noise, grey levels.
    """

    description: str
    num_motions: int = Field(ge=1)
    backdrop: tuple[Part, ...] = Field(min_length=1)
    things: tuple[Thing, ...]
    camera: CameraPath
    gain: Path = Path(start=(1.0, 1.0, 1.0))
    bias: Path = STILL
    noise: float = Field(1.0, ge=0)
    height: int = Field(240, ge=16, description="px")
    width: int = Field(426, ge=16, description="px")
    num_frames: int = Field(24, ge=2)
    seed: int = Field(0, ge=0, description="seed of the sensor's noise and of the tracked points")
    points_per_object: int = Field(60, ge=1, description="visible tracked points wanted on each object at a seeding")
    points_on_backdrop: int = Field(300, ge=1, description="visible tracked points wanted on the backdrop at a seeding")
    seed_every: int = Field(6, ge=1, description="frames between seedings, so that late objects are tracked too")

    @field_validator("backdrop")
    @classmethod
    def _backdrop_is_static(cls, backdrop: tuple[Part, ...]) -> tuple[Part, ...]:
        if any(part.is_moving for part in backdrop):
            raise ValueError("the backdrop moves: what moves is a thing")
        return backdrop
