"""`moseg store`: what lies in the artifact store, whether it is sound, how to make room, and how to copy it."""

import typer

from moseg.workflows.cli.store_commands import explaining, listing, showing, transferring, upkeep

store_app = typer.Typer(
    help="""The artifact store: list, trace, explain, check, collect, copy.

    Examples
    --------
    moseg store ls --runs
    moseg store du
    moseg store gc --delete
    """,
    no_args_is_help=False,
)

store_app.command("ls")(listing.list_artifacts)
store_app.command("show")(showing.show)
store_app.command("why")(explaining.why)
store_app.command("verify")(upkeep.verify)
store_app.command("gc")(upkeep.collect)
store_app.command("du")(listing.disk_use)
store_app.command("push")(transferring.push)
store_app.command("pull")(transferring.pull)
