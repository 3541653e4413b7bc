"""Options of the overlay video."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from moseg.schemas.errors import InputError

if TYPE_CHECKING:
    from moseg.workflows.exports import OverlayStyle


@dataclass(frozen=True)
class OverlayOptions:
    """How ``overlay.mp4`` is drawn."""

    PANEL: ClassVar[str] = "Overlay video"

    overlay: Annotated[
        Literal["outline", "fill", "contour", "mask", "cutout", "none"],
        typer.Option(
            "--overlay",
            help="Overlay: tint and outline, tint alone (fill), line alone (contour), colours on black (mask), all else"
            " in dim grey (cutout), or no video (none).",
            metavar="NAME",
        ),
    ] = "outline"
    opacity: Annotated[
        float | None,
        typer.Option("--opacity", min=0, max=1, help="Strength of the tint, 0 to 1 (default: 0.45)."),
    ] = None
    outline_width: Annotated[
        int | None, typer.Option("--outline-width", min=1, max=64, help="Width of the outline, px (default: 2).")
    ] = None
    side_by_side: Annotated[
        bool, typer.Option("--side-by-side", help="The untouched frame at the left, the overlay at the right.")
    ] = False
    identities: Annotated[bool, typer.Option("--identities", help="The number of each object on it.")] = False
    overlay_size: Annotated[
        Literal["analysed", "video"],
        typer.Option(
            "--overlay-size",
            help="Size of the overlay: that of the frames as analysed, or the video's own.",
            metavar="NAME",
        ),
    ] = "analysed"

    def read(self) -> "OverlayStyle | None":
        """The style, None where there is to be no overlay; raises InputError on an option without a meaning in it."""
        from moseg.workflows.exports import OverlayMode, OverlayStyle
        from moseg.workflows.exports.overlay_style import LINED, TINTED

        mode = None if self.overlay == "none" else OverlayMode(self.overlay)
        given = (
            ("--opacity", self.opacity is not None, TINTED),
            ("--outline-width", self.outline_width is not None, LINED),
            ("--side-by-side", self.side_by_side, OverlayMode),
            ("--identities", self.identities, OverlayMode),
            ("--overlay-size", self.overlay_size == "video", OverlayMode),
        )
        for option, is_given, modes in given:
            if is_given and mode not in (*modes,):
                expected = f"--overlay {' or '.join(modes)}"
                raise InputError("without a meaning", where=option, got=f"--overlay {self.overlay}", expected=expected)
        if mode is None:
            return None
        chosen = {"opacity": self.opacity, "outline_width": self.outline_width}
        return OverlayStyle(
            mode=mode,
            is_side_by_side=self.side_by_side,
            has_identities=self.identities,
            **{name: value for name, value in chosen.items() if value is not None},
        )
