"""``vaso cache``: the verdicts that are kept on this machine."""

from __future__ import annotations

import typer

from vaso.cli.common import JsonOption, console, emit

app = typer.Typer(
    help="The verdicts that are kept, so that no plan is verified twice. "
    "VASO_CACHE names another folder, or turns it off (VASO_CACHE=off)."
)

_OFF = "No verdicts are kept: VASO_CACHE turns it off, or there is no home folder."


@app.callback(invoke_without_command=True)
def default(context: typer.Context) -> None:
    """Show what there is when no command is named."""
    if context.invoked_subcommand is None:
        info()


@app.command()
def info(as_json: JsonOption = False) -> None:
    """Where the verdicts are, how many, and how large."""
    from vaso.memo import default_memo

    memo = default_memo()
    if memo is None:
        if as_json:
            emit({"folder": None, "entries": 0, "bytes": 0, "max_bytes": 0})
        else:
            console().print(_OFF)
        return
    found = memo.info()
    if as_json:
        emit(
            {
                "folder": str(found.folder),
                "entries": found.entries,
                "bytes": found.bytes,
                "max_bytes": found.max_bytes,
            }
        )
        return
    out = console()
    out.print(f"{found.folder}", soft_wrap=True)
    size = f"{found.bytes / 1e6:.1f} of at most {found.max_bytes / 1e6:,.0f} MB"
    out.print(f"{found.entries:,} entries, {size}")


@app.command()
def clear(as_json: JsonOption = False) -> None:
    """Remove all of them; every plan is verified again when it is asked for."""
    from vaso.memo import default_memo

    memo = default_memo()
    removed = memo.clear() if memo else 0
    if as_json:
        emit({"removed": removed})
    else:
        console().print(f"{removed:,} entries removed" if memo else _OFF)
