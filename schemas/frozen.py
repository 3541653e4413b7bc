"""The base of every model in this room: frozen, closed to unknown fields, finite."""

from pydantic import BaseModel, ConfigDict


class Frozen(BaseModel):
    """An immutable value that refuses unknown fields, NaN and infinity.

    NaN and infinity would be written to JSON as ``null`` and so collide under one digest.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
