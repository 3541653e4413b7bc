"""The option that names export formats, as `segment` takes it."""

from typing import Annotated

import typer

EXPORT_FORMATS = "davis, coco, ytvis, colmap, nerfstudio, instant-ngp, dynaslam or npz"

ExportsOption = Annotated[
    list[str] | None,
    typer.Option("--export", help=f"Also write for another program: {EXPORT_FORMATS}; may be repeated."),
]
