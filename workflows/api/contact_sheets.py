"""Contact sheets of a data set, from choices to pictures."""

from pathlib import Path
from typing import NamedTuple

from moseg.schemas.configs import Variant
from moseg.schemas.scores import StoreUse
from moseg.workflows.api.evaluation import DataChoice, open_sequences
from moseg.workflows.api.run_settings import RunSettings
from moseg.workflows.config.notes import motions_note
from moseg.workflows.config.pipeline_choices import PipelineChoices
from moseg.workflows.exports import check_folder
from moseg.workflows.pipelines.contact_sheets import write_contact_sheets


class Drawn(NamedTuple):
    """The sheets, the use of the store, the seconds that they took, and what a reader of them must know."""

    paths: tuple[Path, ...]
    use: StoreUse
    seconds: float
    notes: tuple[str, ...]


def run_contact_sheets(
    data: DataChoice, choices: PipelineChoices, run: RunSettings, variant: Variant, folder: str, num_frames: int
) -> Drawn:
    """Write a sheet of `num_frames` frames for every sequence into `folder`; see `write_contact_sheets`."""
    config = choices.read()
    check_folder(Path(folder))
    dataset = data.open(config.max_side)
    sources = open_sequences(dataset, config, choices)
    with run.open() as session:
        paths = write_contact_sheets(session, sources, config, variant, Path(folder), num_frames)
    absent = (f"{name} is not on disk" for name in dataset.absent)
    return Drawn(paths, session.use(), session.seconds, (*motions_note(config), *absent))
