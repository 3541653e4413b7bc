"""`moseg store push` and `moseg store pull`: copying finished artifacts from one store to another."""

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import typer

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError, MissingStoreError
from moseg.schemas.recipes import split_ref
from moseg.workflows.cli.options import DEFAULT_STORE, QuietOption, StoreOption
from moseg.workflows.cli.store_commands.finding import find_artifact, find_pins, open_existing
from moseg.workflows.cli.store_commands.listing import print_use
from moseg.workflows.process.amounts import size
from moseg.workflows.process.progress import StageProgress

UrlArgument = Annotated[str, typer.Argument(help="The other store: a folder or URL.", metavar="URL")]
KeysArgument = Annotated[
    list[str] | None,
    typer.Argument(help="Only these artifacts (<task>/<key>, or the first letters of a key) and their inputs."),
]
TaskOption = Annotated[str | None, typer.Option("--task", help="Only this task's artifacts and their inputs.")]
RunOption = Annotated[
    list[str] | None,
    typer.Option("--run", help="Only what this run needs; see ls --runs. May be repeated.", metavar="RUN"),
]
AloneOption = Annotated[
    bool, typer.Option("--no-inputs", help="Only what is named itself (final masks, say), not what it was made from.")
]
DryOption = Annotated[bool, typer.Option("--dry", help="Copy nothing; show what would be copied, by task.")]


def push(
    url: UrlArgument,
    keys: KeysArgument = None,
    task: TaskOption = None,
    run: RunOption = None,
    no_inputs: AloneOption = False,
    dry: DryOption = False,
    quiet: QuietOption = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Copy finished artifacts from --store to URL, which becomes a store if it is new.

    All of them and the pins of all finished runs, or those that are named with all that they were made from. Each byte
    is checked on the way, and what is there already is not copied again: the same command goes on after an
    interruption. Exit code 1 where an artifact was damaged; the others are copied.

    Examples
    --------
    moseg store push s3://bucket/moseg --dry
    moseg store push s3://bucket/moseg --run 1a2b…
    """
    _copy(store, url, Named(keys or (), task, run or (), not no_inputs), dry, quiet)


def pull(
    url: UrlArgument,
    keys: KeysArgument = None,
    task: TaskOption = None,
    run: RunOption = None,
    no_inputs: AloneOption = False,
    dry: DryOption = False,
    quiet: QuietOption = False,
    store: StoreOption = DEFAULT_STORE,
) -> None:
    """Copy finished artifacts from URL to --store, which becomes a store if it is new; otherwise as push.

    Examples
    --------
    moseg store pull s3://bucket/moseg --task segmentation
    moseg store pull s3://bucket/moseg score/1a2b --no-inputs
    """
    _copy(url, store, Named(keys or (), task, run or (), not no_inputs), dry, quiet)


class Named(NamedTuple):
    """What the user named, and whether its inputs go along; all that there is where nothing was named."""

    keys: Sequence[str]
    task: str | None
    runs: Sequence[str]
    with_inputs: bool

    @property
    def is_all(self) -> bool:
        """Whether nothing was named."""
        return not (self.keys or self.task or self.runs)


def _copy(source_url: str, target_url: str, named: Named, dry: bool, quiet: bool) -> None:
    from moseg.store import open_store
    from moseg.store.transfer import is_same_store, keep, kept_meanwhile, plan_transfer, select, transfer

    source = open_existing(source_url)
    pins = _choose_pins(source, named)
    target = _existing_or_none(target_url)
    if target is not None and is_same_store(source, target):
        raise InputError("both ends are the same store", got=target_url, expected="another folder or URL")
    roots = None if named.is_all else [ref for refs in pins.values() for ref in refs]
    selected = select(source, roots, named.with_inputs)
    if dry:
        _print_plan(plan_transfer(source, target, selected))
        return
    target = target or open_store(target_url, create=True)
    # Before it is looked what the target has, so that no collection there takes it in between.
    with kept_meanwhile(target, selected):
        plan = plan_transfer(source, target, selected)
        with StageProgress({"copied": len(plan.inputs)}, quiet) as progress:
            report = transfer(source, target, plan, lambda ref: progress.advance("copied"))
        keep(target, pins, source.pinned())
    for ref, problem in sorted(report.problems.items()):
        print(f"{ref}: not copied: {problem}")
    print(
        f"{report.num_copied} artifacts copied ({size(report.nbytes)}), {report.num_present} were there already,"
        f" {len(report.problems)} damaged"
    )
    if report.problems:
        raise typer.Exit(1)


def _choose_pins(source, named: Named) -> dict[str, tuple[str, ...]]:
    """Return the pins for the target: those of runs, and one for artifacts that were named on their own."""
    finished = {run_id: pin.refs for run_id, pin in source.pinned().items() if pin.expires is None}
    if named.is_all:
        if not named.with_inputs:
            raise InputError("nothing named to copy alone", where="--no-inputs", expected="a KEY, --task or --run")
        return finished
    names = [name for run in named.runs for name in find_pins(source, run)]
    for name in names:
        if name not in finished:
            raise InputError("a run that is not finished", where="--run", got=name, expected="a finished one")
    pins = {name: finished[name] for name in names}
    refs = [find_artifact(source, key) for key in named.keys]
    if named.task:
        found = list(source.refs(named.task))
        if not found:
            raise InputError("no artifacts of this task", where=source.url, got=named.task)
        refs += found
    if refs:
        pins[f"copied-{digest_json('run', sorted(refs))[:16]}"] = tuple(dict.fromkeys(refs))
    return pins


def _existing_or_none(url: str):
    try:
        return open_existing(url)
    except MissingStoreError:
        return None


def _print_plan(plan) -> None:
    from moseg.store import TaskUsage

    usage: dict[str, TaskUsage] = {}
    for ref, nbytes in plan.nbytes.items():
        task, _ = split_ref(ref)
        count, total = usage.get(task, (0, 0))
        usage[task] = TaskUsage(count + 1, total + nbytes)
    print_use(usage)
    for ref, problem in sorted(plan.problems.items()):
        print(f"{ref}: cannot be copied: {problem}")
    print(f"would be copied (without --dry); {plan.num_present} are there already")
