"""The verb `serve`: the desk for those who work without a command line."""

import os
from importlib.util import find_spec
from pathlib import Path

import click

from pipeline.cli.console import printable
from pipeline.cli.shared import Options
from pipeline.errors import InputError

_NEEDED = {
    "starlette": "starlette",
    "uvicorn": "uvicorn",
    "argon2": "argon2-cffi",
    "python_multipart": "python-multipart",
}


@click.command()
@click.option("--host", help="Address to listen at; default: [serve] host, 127.0.0.1. Others need an identity.")
@click.option("--port", type=click.IntRange(0, 65535), help="Port; default: [serve] port, 8750. 0: any that is free.")
@click.option("--add-user", metavar="NAME", help="Make an account, or give it another password or role; then end.")
@click.option("--role", type=click.Choice(["reader", "editor"]), help="With --add-user; default: reader.")
@click.option("--remove-user", metavar="NAME", help="Remove an account; then end.")
@click.option("--users", "listing", is_flag=True, help="List the accounts; then end.")
@click.pass_obj
def serve(
    options: Options,
    host: str | None,
    port: int | None,
    add_user: str | None,
    role: str | None,
    remove_user: str | None,
    listing: bool,
) -> None:
    """Serve the desk: find objects, decide, enter measurements, answer house rules, take errands, in a browser.

    It listens to this machine alone; [serve] says who may come from elsewhere.  What is said there goes where the
    commands put it, and the next run takes it up.  It needs `pip install 'kouros[serve]'`.  The password of a new
    account is asked for, or taken from KOUROS_NEW_PASSWORD of the environment.

    \b
    Example: kouros serve
    Example: kouros serve --add-user "A. Smith" --role editor
    """
    lost = [package for module, package in _NEEDED.items() if find_spec(module) is None]
    if lost:
        raise InputError(f"the desk needs {', '.join(lost)}: pip install 'kouros[serve]'")
    if (add_user is not None) + (remove_user is not None) + listing > 1:
        raise click.UsageError("give one of --add-user, --remove-user, --users")
    if role is not None and add_user is None:
        raise click.UsageError("--role is for --add-user NAME")
    from pipeline.desk import serving

    if add_user is not None:
        password = os.environ.get(serving.PASSWORD_VARIABLE) or click.prompt(
            "Password", hide_input=True, confirmation_prompt=True
        )
        serving.add_user(options.settings(), add_user, role or "reader", password)
        click.echo(f"{printable(add_user)} may sign in, as {role or 'reader'}")
    elif remove_user is not None:
        serving.remove_user(options.settings(), remove_user)
        click.echo(f"{printable(remove_user)} may not sign in any more")
    elif listing:
        for name, part, made in serving.users(options.settings()):
            click.echo(printable(f"{name}  {part}  {made}"))
    else:
        serving.serve(Path(options.config), host, port, lambda address: click.echo(f"the desk: {address}"))
