"""Share of true moving objects that get a prompt point from motion inside, and none outside; contact sheets of prompts.

    python benchmarks/prompts/motion_prompts.py --davis /data/DAVIS --kt3dmoseg /data/KT3DMoSeg \
        --store /data/store --sheets prompts --json benchmarks/results/apart/motion-prompts.json

Prompts are those of ``--proposals motion-prompts`` in the first frame of every section; no network with downloaded
weights runs. An object is counted in each of these frames in which it is annotated. Where a clip has labelled points
and no masks, a prompt point belongs to the object of the nearest labelled point. By default, the synthetic scenes are
read.
"""

import argparse
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from hits import Hits, PromptedFrame, count_hits, is_clean, is_hit, owners_by_nearest, owners_in_masks
from PIL import Image
from sheets import draw_sheet

from moseg.schemas.configs import PipelineConfig
from moseg.tasks.instances.motion_prompts import MotionPrompts
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.datasets import SequenceSource, open_dataset
from moseg.workflows.engine.session import Session, open_session
from moseg.workflows.graph import SequenceGraph
from moseg.workflows.pipelines.leaves import ingest_sequences
from moseg.workflows.results.shown_frames import annotated_frames, read_labelled_points
from moseg.workflows.sources.resize import resize_labels


def main() -> None:
    """Measure, draw and report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--davis", help="root of DAVIS-2016")
    parser.add_argument("--kt3dmoseg", help="root of KT3DMoSeg's clips with frames")
    parser.add_argument("--sequences", help="names of sequences, separated by commas; all by default")
    parser.add_argument("--set", action="append", default=[], metavar="STAGE.NAME=VALUE", help="parameter")
    parser.add_argument("--store", help="artifact store; a temporary one by default")
    parser.add_argument("--sheets", type=Path, help="folder for a picture of every sequence")
    parser.add_argument("--json", type=Path, help="file for the figures")
    options = parser.parse_args()
    roots = {"davis16": options.davis, "kt3dinsmoseg": options.kt3dmoseg}
    roots = {name: root for name, root in roots.items() if root} or {"synthetic": None}
    settings = tuple(tuple(each.split("=", 1)) for each in options.set)
    config = PipelineChoices(settings=(("proposal_source", "motion-prompts"), *settings)).read()
    result = {}
    with (
        tempfile.TemporaryDirectory() as folder,
        open_session(options.store or f"{folder}/store", quiet=True) as session,
    ):
        for name, root in roots.items():
            dataset = open_dataset(name, root, max_side=config.max_side)
            chosen = options.sequences.split(",") if options.sequences else dataset.names
            found = {}
            for sequence in (each for each in dataset.names if each in chosen):
                found[sequence] = prompted_frames(session, dataset.sequence(sequence), config)
                print(f"{sequence:18} {describe(count_hits(found[sequence]))}", flush=True)
                if options.sheets:
                    options.sheets.mkdir(parents=True, exist_ok=True)
                    Image.fromarray(draw_sheet(sequence, found[sequence])).save(options.sheets / f"{sequence}.png")
            result[name] = summarise(found)
            print(f"{name:18} {describe(count_hits([frame for frames in found.values() for frame in frames]))}")
    if options.json:
        how = f"benchmarks/prompts/motion_prompts.py on {' and '.join(roots)}"
        content = {"name": "motion-prompts", "provenance": "measured apart", "how": how, "result": result}
        options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def prompted_frames(session: Session, source: SequenceSource, config: PipelineConfig) -> list[PromptedFrame]:
    """Return the annotated first frames of the sections of a sequence, with their prompts."""
    graphs: list[SequenceGraph] = []

    def build():
        (leaves,) = ingest_sequences(session, [source], config, annotated=True)
        graphs[:] = [SequenceGraph(leaves, config)]
        return graphs[0].recipes, prompt_refs(graphs[0])

    return session.compute(build, lambda: list(_read_frames(session, graphs[0])))


def prompt_refs(graph: SequenceGraph) -> list[str]:
    """Return the references of the prompts of all sections."""
    return [graph.objects.motion_prompts(index) for index in range(len(graph.sections))]


def _read_frames(session: Session, graph: SequenceGraph) -> Iterator[PromptedFrame]:
    store, leaves = session.store, graph.leaves
    annotated = annotated_frames(store, leaves.annotation) if leaves.annotation is not None else None
    labelled = read_labelled_points(store, leaves.labelled_points) if annotated is None else None
    for section, ref in zip(graph.sections, prompt_refs(graph), strict=True):
        frame = section.start
        arrays = [store.read(ref, name) for name in ("labels", "boxes", "points")]
        prompts = MotionPrompts(*arrays, np.array(store.attributes(ref)["regions"], int))
        image, truth = store.read(leaves.frames[frame], "image"), None
        if annotated is not None:
            if frame not in annotated:
                continue
            row = annotated.index(frame)
            truth = resize_labels(store.read_rows(leaves.annotation, "masks", row, row + 1)[0], image.shape[:2])
            owners, labels = owners_in_masks(prompts.points, truth, leaves.void), np.unique(truth)
        else:
            is_seen = labelled.visible[:, frame]
            if not is_seen.any():
                continue
            scale = np.array(image.shape[1::-1]) / labelled.size[::-1]
            known, labels = (labelled.points[is_seen, frame] + 0.5) * scale - 0.5, labelled.labels[is_seen]
            owners = owners_by_nearest(prompts.points, known, labels)
        objects = tuple(int(label) for label in np.unique(labels) if label not in (0, leaves.void))
        yield PromptedFrame(frame, image, prompts, objects, owners, truth)


def summarise(found: dict[str, list[PromptedFrame]]) -> dict:
    """Return counts and shares, percent, of a data set and of each of its sequences.

    ``identities`` are objects of a sequence: one is hit, or clean, if it is so in the first frame of any section.
    """
    frames = [frame for each in found.values() for frame in each]
    identities = {(name, label) for name, each in found.items() for frame in each for label in frame.objects}
    counts = {"identities": len(identities)}
    for kind, holds in (("hit", is_hit), ("clean", is_clean)):
        once = {pair for pair in identities if any(_holds(holds, frame, pair[1]) for frame in found[pair[0]])}
        counts[f"identities_{kind}"] = len(once)
    hits = count_hits(frames)
    shares = {
        "hit_share": 100 * hits.hit / hits.objects,
        "clean_share": 100 * hits.clean / hits.objects,
        "stray_share": 100 * hits.stray / max(hits.prompts, 1),
    }
    sequences = {name: count_hits(each)._asdict() for name, each in found.items()}
    return {**hits._asdict(), **counts, **shares, "sequences": sequences}


def _holds(holds, frame: PromptedFrame, label: int) -> bool:
    return label in frame.objects and holds(frame, label)


def describe(hits: Hits) -> str:
    """Return the counts in words."""
    return (
        f"objects {hits.objects:3}, hit {hits.hit:3}, clean {hits.clean:3}; "
        f"prompts {hits.prompts:3}, mixed {hits.mixed:3}, stray {hits.stray:3}"
    )


if __name__ == "__main__":
    main()
