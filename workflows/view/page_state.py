"""State of a session as JSON for the page."""

import shlex
from typing import Any

import numpy as np

from moseg.schemas.digests import hash_array
from moseg.schemas.errors import StoreError
from moseg.workflows.api.given_corrections import CORRECTIONS
from moseg.workflows.config.strict_yaml import spell_value
from moseg.workflows.exports.formats.reconstruction_sets import SETS
from moseg.workflows.exports.formats.registry import FORMATS
from moseg.workflows.exports.overlay_style import OverlayMode
from moseg.workflows.reports.content import Matrix
from moseg.workflows.reports.layers import all_colours, as_hex
from moseg.workflows.reports.matrices import object_matrices
from moseg.workflows.reports.missing import Missing, WhyAbsent, format_missing
from moseg.workflows.reports.timelines import choose_thumbnails
from moseg.workflows.results.scenes import scene_rows, spell_scenes
from moseg.workflows.view.edit_words import describe_edit, next_identity, verdicts
from moseg.workflows.view.object_areas import ObjectAreas
from moseg.workflows.view.shown_result import ShownResult
from moseg.workflows.view.slider_settings import list_settings
from moseg.workflows.view.view_session import Moment, ViewSession

MAX_AREAS = 900
"""Points of an object's area over time: more than a screen is wide are not seen."""


def describe_moment(session: ViewSession, runs: list[dict]) -> dict[str, Any]:
    """Return the state of a session; `runs` are those that can be opened."""
    moment = session.moment
    result = None if moment.shown is None else _describe_result(session, moment)
    return {
        "revision": moment.revision,
        "phase": moment.phase,
        "name": moment.name,
        "message": moment.message,
        "runs": runs,
        "result": result,
    }


def describe_grid(areas: ObjectAreas, shown: ShownResult) -> dict[str, Any]:
    """Return areas over time, and the frames of which pictures are cut out, of all objects and rejected proposals."""
    num_pixels = shown.analysed_shape[0] * shown.analysed_shape[1]
    step = -(-shown.num_frames // MAX_AREAS)

    def describe(area: np.ndarray) -> dict[str, Any]:
        seen, percent = np.flatnonzero(area), 100 * area / num_pixels
        return {
            "areas": percent[::step].round(3).tolist(),
            "largest": float(percent.max()),
            "mean": float(percent[seen].mean()),
            "first": int(seen[0]),
            "last": int(seen[-1]),
            "best": int(area.argmax()),
            "thumbnails": list(choose_thumbnails(area)),
            "tag": _tag(area),
        }

    result = areas.of_labels(shown)
    rejected = {identity: area for identity, area in areas.of_proposals(shown).items() if identity not in result}
    return {
        "key": shown.key,
        "step": step,
        "objects": {identity: describe(area) for identity, area in result.items()},
        "rejected": {identity: describe(area) for identity, area in rejected.items()},
    }


def find_tag(areas: ObjectAreas, shown: ShownResult, identity: int) -> str | None:
    """Return the tag of an object's pictures, as in `describe_grid`; None if no frame shows it."""
    area = areas.of_labels(shown).get(identity)
    if area is None:
        area = areas.of_proposals(shown).get(identity)
    return None if area is None else _tag(area)


def _tag(area: np.ndarray) -> str:
    return hash_array(area)[-12:]


def describe_matrices(shown: ShownResult) -> dict[str, Any]:
    """Return the affinities of objects, and sentences on what cannot be shown."""
    missing: list[Missing] = []
    if shown.graph.clustering(shown.variant) is None:
        return {"matrices": [], "missing": []}
    called = shown.found.called
    labels = [f"{identity} {called.get(identity, '')}".strip() for identity in shown.proposed]
    made: list[tuple[str, Matrix]] = []
    try:
        scenes = zip(spell_scenes(shown.graph), shown.graph.scenes, scene_rows(shown.store, shown.graph), strict=True)
        for scene, graph, rows in scenes:
            own = ("background", *(labels[row - 1] for row in rows))
            found = object_matrices(shown.store, graph, shown.config, shown.variant, own, missing)
            made += [(scene, matrix) for matrix in found]
    except StoreError as error:
        return {"matrices": [], "missing": [str(error)]}
    matrices = [
        {
            "title": f"{matrix.title}, {scene}" if scene else matrix.title,
            "description": matrix.description,
            "labels": list(matrix.labels),
            "values": [[float(value) if np.isfinite(value) else None for value in row] for row in matrix.values],
        }
        for scene, matrix in made
        if not matrix.unit
    ]
    return {"matrices": matrices, "missing": list(format_missing(missing, WhyAbsent.GONE))}


def _describe_result(session: ViewSession, moment: Moment) -> dict[str, Any]:
    opened, shown = moment.opened, moment.shown
    said, names = verdicts(moment.corrections), shown.found.called

    def describe(identity: int) -> dict[str, Any]:
        return {
            "identity": identity,
            "name": names.get(identity),
            "motion": shown.found.motions[identity],
            "colour": as_hex(all_colours()[identity]),
            "verdict": said.get(identity),
        }

    height, width = shown.shape
    rows, columns = shown.analysed_shape
    rejected = [identity for identity in shown.found.motions if identity not in shown.identities]
    known = {*shown.found.motions, *shown.proposed}
    return {
        "source": opened.first.key,
        "key": shown.key,
        "name": shown.name,
        "numFrames": shown.num_frames,
        "fps": shown.fps,
        "width": width,
        "height": height,
        "grid": {"width": columns, "height": rows},
        "numMotions": shown.found.num_motions,
        "objects": list(map(describe, shown.identities)),
        "rejected": list(map(describe, rejected)),
        "nextIdentity": next_identity(known, moment.corrections),
        "growing": list(opened.growing),
        "cues": list(moment.cues),
        "lookAt": list(moment.look_at),
        "settings": list_settings(opened.first.config, moment.corrections),
        "corrections": {
            "edits": list(map(describe_edit, moment.corrections.edits)),
            "settings": [f"{name}: {spell_value(value)}" for name, value in moment.corrections.settings.items()],
            "canUndo": moment.can_undo,
            "canRedo": moment.can_redo,
            "file": str(session.out / CORRECTIONS),
        },
        "command": _spell_command(session, moment),
        "out": str(session.out),
        "exports": _list_exports(),
        "hasVideo": opened.has_video,
        "exportCommand": shlex.join(["moseg", "export", str(session.out), "--to", "FORMAT", "--video", "VIDEO"]),
        "viewCommand": shlex.join(["moseg", "view", "VIDEO", "--out", str(session.out)]),
    }


def _spell_command(session: ViewSession, moment: Moment) -> str:
    """Return the command that writes the same result without the page."""
    out = str(session.out)
    file = ["--corrections", str(session.out / CORRECTIONS)] if moment.corrections else []
    return shlex.join(["moseg", *moment.opened.words, *file, "--out", out])


def _list_exports() -> dict[str, Any]:
    def describe(entry) -> dict[str, Any]:
        return {"name": entry.name, "about": entry.description, "needsFrames": entry.needs_frames}

    return {
        "overlays": [*OverlayMode, "none"],
        "formats": list(map(describe, FORMATS.values())),
        "sets": list(map(describe, SETS.values())),
    }
