"""A segmentation as a notebook shows it: a few frames, and a table of what moves in them."""

import base64
import io
from collections.abc import Sequence
from html import escape

import numpy as np
from PIL import Image

from moseg.workflows.api.moving_object import MovingObject
from moseg.workflows.exports import identity_colours

MAX_ROWS = 20
"""Objects in the table before the rest is only counted."""
WEBP_QUALITY = 80


def draw_html(
    name: str, summary: str, objects: Sequence[MovingObject], picture: Image.Image, notes: Sequence[str] = ()
) -> str:
    """Return self-contained HTML: the picture is in it, and the notebook gives the colours of text and background."""
    rows = "".join(_row(each) for each in objects[:MAX_ROWS])
    if len(objects) > MAX_ROWS:
        rows += f'<tr><td colspan="6">and {len(objects) - MAX_ROWS} more</td></tr>'
    head = "".join(f"<th>{title}</th>" for title in ("object", "motion", "frames", "area", "score", "name"))
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>" if objects else ""
    image = f'<img alt="frames with their moving objects" style="max-width:100%" src="{_data_uri(picture)}">'
    lines = "".join(f"<p>note: {escape(note)}</p>" for note in notes)
    return f"<div><p><strong>{escape(name)}</strong>: {escape(summary)}</p>{lines}{image}{table}</div>"


def _row(each: MovingObject) -> str:
    red, green, blue = identity_colours(np.array([each.identity], np.uint16))[0]
    style = f"display:inline-block;width:0.8em;height:0.8em;background:#{red:02x}{green:02x}{blue:02x}"
    swatch = f'<span style="{style}"></span> {each.identity}'
    frames = f"{each.first_frame} to {each.last_frame}"
    if each.num_frames <= each.last_frame - each.first_frame:
        frames += f" ({each.num_frames} of them)"
    score = "" if each.score is None else f"{each.score:.2f}"
    called = each.name or each.tag or ""
    cells = (swatch, each.motion, frames, f"{100 * each.mean_area_fraction:.2g} %", score, escape(called))
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def _data_uri(picture: Image.Image) -> str:
    content = io.BytesIO()
    picture.save(content, "WEBP", quality=WEBP_QUALITY)
    return f"data:image/webp;base64,{base64.b64encode(content.getvalue()).decode('ascii')}"
