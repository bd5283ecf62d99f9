"""The verbs.  Each parses its options, calls one job, prints its answer."""

import json
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pipeline.cli.console import listed, response_lines, summary_lines, tradeoff_lines
from pipeline.cli.deciding import decide
from pipeline.cli.event import event
from pipeline.cli.explaining import print_explanation
from pipeline.cli.importing import import_
from pipeline.cli.motions import motions
from pipeline.cli.planning import plan
from pipeline.cli.scanning import scan
from pipeline.cli.serving import serve
from pipeline.cli.shared import Options, as_json, dry_run, say_dry
from pipeline.cli.surveying import survey
from pipeline.cli.validating import validate
from pipeline.quantities import counted

if TYPE_CHECKING:
    from pipeline.operations.run_summary import Summary


FIDELITIES = ("screen", "bound", "chart", "history", "reference")
"""What `respond` offers; named here too, so that --help does not wait for the models to load."""


def _print_summary(summary: "Summary", wanted: bool) -> None:
    from pipeline.operations.run_summary import summary_document

    if wanted:
        click.echo(json.dumps(summary_document(summary), indent=2, allow_nan=False))
    else:
        click.echo("\n".join(summary_lines(summary)))


@click.command()
@click.argument("place", metavar="[FOLDER]", required=False, type=click.Path(file_okay=False, path_type=Path))
@click.option("--folder", type=click.Path(file_okay=False, path_type=Path), help="The same; default: kouros-demo.")
@dry_run("Assess what the folder has; say what would be made where it has nothing")
@as_json
@click.pass_obj
def demo(options: Options, place: Path | None, folder: Path | None, dry_run: bool, as_json: bool) -> None:
    """Run the whole job on the bundled collection and site, and print the report's path.

    FOLDER is where it keeps its settings, database and reports; kouros-demo if none is given.

    Example: kouros demo
    """
    if place is not None and folder is not None:
        raise click.UsageError("name the folder once: FOLDER or --folder")
    folder = place or folder or Path("kouros-demo")
    from pipeline.night.run import run as job
    from pipeline.operations.job_monitor import watched
    from pipeline.operations.secrets import hider
    from pipeline.tools.initialise import demonstration

    settings = demonstration(folder, dry_run=dry_run)
    with options.console() as console:
        summary = watched(settings, lambda: job(settings, console, dry_run=dry_run), hider(settings), whole=not dry_run)
    _print_summary(summary, as_json)
    if dry_run:
        say_dry(as_json)


@click.command()
@click.argument("folder", default=".", type=click.Path(file_okay=False, path_type=Path))
@click.option("--systemd", is_flag=True, help="Also write a service and a timer of systemd, for every night.")
@dry_run("Say what would be made")
def init(folder: Path, systemd: bool, dry_run: bool) -> None:
    """Make a commented kouros.toml, an empty site folder and the database.

    With --systemd, kouros.service and kouros.timer are written into the folder too, with the paths of this machine;
    where a kouros.toml is there already, only they are.

    \b
    Example: kouros init museum
    Example: kouros init museum --systemd
    """
    from pipeline.tools.initialise import initialise, write_units

    units = write_units(folder, dry_run=dry_run) if systemd else []
    begun = [] if systemd and (folder / "kouros.toml").exists() else initialise(folder, dry_run=dry_run)
    for made in [*begun, *units]:
        click.echo(f"{'would make' if dry_run else 'made'} {made}")
    if units:
        click.echo("Read them, then, as root: cp them into /etc/systemd/system and systemctl enable --now kouros.timer")
    if dry_run:
        say_dry(wanted_json=False)


@click.command()
@click.option("--numerics", is_flag=True, help="Run the models at their extremes instead, against exact limits.")
@click.option("--deep", is_flag=True, help="Compare all that is kept with what was written instead; nothing changes.")
@click.option("--migrate", is_flag=True, help="First bring the database's tables to this version; keep a copy of it.")
@as_json
@click.pass_obj
def check(options: Options, numerics: bool, deep: bool, migrate: bool, as_json: bool) -> None:
    """Look at settings, database, mapping, motions, house rules, clock and disk, and say what to mend.

    Nothing is written, but with --migrate; every verb that writes brings the tables up to date by itself.

    With --numerics: whether this machine's compiled code is right at the extremes; exit code 1 if not.  Beside a
    kouros.toml the result is kept, and the next report shows it.

    With --deep: whether database, cache and last report are what was written; exit code 1 if not.

    Example: kouros check
    """
    if numerics + deep + migrate > 1:
        raise click.UsageError("--numerics, --deep or --migrate, one at a time")
    if deep:
        _check_deep(options, as_json)
        return
    if numerics:
        _check_numerics(options, as_json)
        return
    from pipeline.tools.doctor import diagnose

    found = diagnose(Path(options.config), migrate=migrate)
    if as_json:
        click.echo(json.dumps([asdict(d) for d in found], indent=2))
    else:
        for d in found:
            click.echo(f"{d.state:<8} {d.what:<11} {d.message}")
    if any(d.state == "wrong" for d in found):
        raise click.exceptions.Exit(2)


def _check_deep(options: Options, as_json: bool) -> None:
    from pipeline.tools.doctor_checks import examine

    with options.console() as console:
        found = list(examine(options.settings(), console))
    if as_json:
        click.echo(json.dumps([asdict(one) for one in found], indent=2))
    else:
        for one in found:
            click.echo(f"{'damaged':<8} {one.where}{': ' if one.why else ''}{one.why}; {one.remedy}")
        if not found:
            click.echo("database, cache and last report are what was written")
    if found:
        raise click.exceptions.Exit(1)


def _check_numerics(options: Options, as_json: bool) -> None:
    from pipeline.verification.selftest import self_test

    settings = options.settings() if Path(options.config).exists() else None
    done = []
    for o in self_test(settings):
        done.append(o)
        if not as_json:
            result = "no number" if o.result is None else f"{o.result:.1e}"
            says = f"{result}, limit {o.limit:.0e}" + (f": {o.problem}" if o.problem else "")
            click.echo(f"{'ok' if o.ok else 'failed':<8} {o.what}; {o.truth}: {says}")
    wrong = sum(not o.ok for o in done)
    if as_json:
        click.echo(json.dumps([asdict(o) for o in done], indent=2))
    else:
        click.echo(f"{counted(len(done), 'case')}, {wrong} failed, {sum(o.seconds for o in done):.0f} s")
    if wrong:
        raise click.exceptions.Exit(1)


@click.command()
@click.option("--gallery", "galleries", multiple=True, help="Only this gallery; may be repeated.")
@click.option("--object", "objects", multiple=True, help="Only this object number; may be repeated.")
@click.option("--site", help="Another site's folder, or 'demo'.")
@click.option("--fidelity", type=click.Choice(["auto", "chart", "history", "reference"]), help="How finely to look.")
@dry_run("Assess the inventory as it is, and summarise")
@click.option("--strict", is_flag=True, help="End with 3 where some objects could not be assessed; else that is 0.")
@click.option(
    "--resume", is_flag=True, help="Go on where a run was cut off, with the inventory as it is: the source is not read."
)
@click.option(
    "--explain",
    metavar="OBJECT",
    help="Print the chain of reasoning for one object instead; with -v each of its steps.",
)
@as_json
@click.pass_obj
def run(
    options: Options,
    galleries: tuple[str, ...],
    objects: tuple[str, ...],
    site: str | None,
    fidelity: str | None,
    dry_run: bool,
    strict: bool,
    resume: bool,
    explain: str | None,
    as_json: bool,
) -> None:
    """Run the nightly job: read, assess, recommend, store, publish the report.

    A run of a part of the collection is stored and has its report, but does not become the latest one.

    What has not changed since an earlier run is not found again, and what a run that was cut off had found is taken up.

    With --explain nothing is stored: it prints class, numbers, every step of each model and the advice for an object.

    \b
    Example: kouros run --gallery "Hall of Sculpture"
    Example: kouros run --resume
    Example: kouros run --explain 1922.9
    """
    from pipeline.night.run import Selection
    from pipeline.night.run import run as job
    from pipeline.operations.dry_run import rehearsed
    from pipeline.operations.event_log import journal
    from pipeline.operations.job_monitor import watched
    from pipeline.operations.secrets import hider
    from pipeline.tools.inbox import take_inbox

    settings = options.settings()
    if site is not None:
        settings = settings.model_copy(update={"site": settings.site.model_copy(update={"folder": site})})
    if fidelity is not None:
        settings = settings.model_copy(update={"analysis": settings.analysis.model_copy(update={"fidelity": fidelity})})
    if explain is not None:
        if galleries or objects:
            raise click.UsageError("--explain is about one object: leave out --gallery and --object")
        with rehearsed(settings, dry_run) as quietly:
            print_explanation(quietly, explain, options, as_json)
        if dry_run:
            say_dry(as_json)
        return
    chosen = Selection(galleries, objects)
    hide = hider(settings)
    with journal(None if dry_run else settings, hide), options.console() as console:
        # Before the night, which then finds its measurements, decisions and rules as if they had always been there.
        taken = take_inbox(settings, Path(options.config), dry_run=dry_run)
        if taken and not dry_run:
            settings = settings.model_copy(update={"house": options.settings().house})
        summary = watched(
            settings,
            lambda: job(settings, console, chosen, dry_run=dry_run, resume=resume, strict=strict),
            hide,
            whole=not (chosen or dry_run),
        )
    _print_summary(summary, as_json)
    if not as_json:
        listed("survey", [f"{one.name}: {one.words}" for one in taken])
    if dry_run:
        say_dry(as_json)
    if summary.exit_code:
        raise click.exceptions.Exit(summary.exit_code)


@click.command()
@click.option(
    "--ahead",
    is_flag=True,
    help="Remove the runs that are dated later than now too: the clock was wrong when they were made.",
)
@dry_run("Say what would be removed")
@as_json
@click.pass_obj
def prune(options: Options, ahead: bool, dry_run: bool, as_json: bool) -> None:
    """Remove the runs and report folders beyond [retention]; the last good ones always stay.

    `kouros run` does so after every good night.

    Example: kouros prune --dry-run
    """
    from pipeline.operations.retention import prune as job

    done = job(options.settings(), dry_run=dry_run, ahead=ahead)
    if as_json:
        click.echo(json.dumps(asdict(done), indent=2))
    else:
        what = "would be removed" if dry_run else "removed"
        click.echo(f"{counted(len(done.runs), 'run')} and {counted(len(done.reports), 'report folder')} {what}")
        listed("run", done.runs)
        listed("report", done.reports)
        listed("stays", done.kept)
    if dry_run:
        say_dry(as_json)


@click.command()
@click.argument("run_id", required=False)
@click.pass_obj
def report(options: Options, run_id: str | None) -> None:
    """Render a run's report again from the store; nothing is computed.  Without RUN: the newest.

    Example: kouros report
    """
    from pipeline.tools.rerender import render_again

    click.echo(f"Report: {render_again(options.settings(), run_id)}")


@click.command()
@click.argument("old", required=False)
@click.argument("new", required=False)
@as_json
@click.pass_obj
def diff(options: Options, old: str | None, new: str | None, as_json: bool) -> None:
    """Say what changed between two runs, and why each verdict did.  Without RUNs: the last two.

    Example: kouros diff
    """
    from pipeline.cli.differing import print_changes
    from pipeline.tools.rerender import compare

    print_changes(compare(options.settings(), old, new), as_json)


@click.command()
@as_json
def models(as_json: bool) -> None:
    """List the generic models: what each needs and gives, and its source.

    Example: kouros models --json
    """
    from pipeline.models import MODELS

    rows = [
        {
            "name": m.name,
            "title": m.title,
            "kind": m.kind,
            "equation": m.equation,
            "source": m.source,
            "needs": [
                {"name": q.name, "unit": q.unit, "meaning": q.meaning, "allowed": q.allowed(), "optional": q.optional}
                for q in m.needs
            ],
            "gives": [{"name": q.name, "unit": q.unit, "meaning": q.meaning} for q in m.gives],
        }
        for m in MODELS
    ]
    if as_json:
        click.echo(json.dumps(rows, indent=2))
        return
    for m in MODELS:
        click.echo(f"{m.name}  ({m.kind})  {m.title}")
        click.echo(f"    {m.equation}")
        click.echo("    needs  " + ", ".join(f"{q.name} [{q.unit}]{'?' if q.optional else ''}" for q in m.needs))
        click.echo("    gives  " + ", ".join(f"{q.name} [{q.unit}]" for q in m.gives))
        click.echo(f"    source {m.source}")


@click.command()
@click.argument("model")
@click.argument("parameters", nargs=-1, metavar="NAME=VALUE[,VALUE...]...")
@click.option(
    "--site", default="demo", show_default=True, help="Site folder whose motions shake it, 'demo' or 'demo_suite'."
)
@click.option(
    "--through",
    multiple=True,
    metavar="SUPPORT:NAME=VALUE,...",
    help="A support that the motion passes first (floor, plinth, friction_isolator, horizontal_isolator, "
    "rotational_isolator); repeat it for a chain, from the ground up.",
)
@click.option("--angle", default="0", show_default=True, help="Degrees from x towards y, or 'worst' (RotD100).")
@click.option("--fidelity", default="history", type=click.Choice(FIDELITIES), show_default=True)
@click.option("--tail", type=click.FloatRange(min=0.0), help="Seconds after the record; default: until rest.")
@as_json
@click.pass_obj
def respond(
    options: Options,
    model: str,
    parameters: tuple[str, ...],
    site: str,
    through: tuple[str, ...],
    angle: str,
    fidelity: str,
    tail: float | None,
    as_json: bool,
) -> None:
    """Run one model on a site's motions, ad hoc.  Parameters in SI; several values make several rows.

    With a site made by `kouros motions synthesise` it is a virtual shake table.  Charts (--fidelity chart) are kept
    beside kouros.toml where there is one.

    \b
    Example: kouros respond sliding friction_static=0.05,0.1,0.2
    Example: kouros respond rocking half_width=0.1 cg_height=0.5 --through plinth:frequency=8,damping=0.05
    """
    from pipeline.tools.adhoc import respond_on_site

    # Only charts are kept anywhere.
    settings = options.settings() if fidelity == "chart" and Path(options.config).exists() else None
    rows = respond_on_site(
        model, parameters, site, through=through, angle=angle, fidelity=fidelity, tail=tail, settings=settings
    )
    if as_json:
        # JSON has no word for what is not a number.
        plain = [{k: None if isinstance(v, float) and not isfinite(v) else v for k, v in r.items()} for r in rows]
        click.echo(json.dumps(plain, indent=2))
        return
    click.echo("\n".join(response_lines(rows)))


@click.command()
@click.option("--site", help="Site folder whose motions are used, or 'demo'; else the settings'.")
@click.option("--model", "models", multiple=True, help="Only this model; may be repeated.")
@click.option("--objects", default=128, show_default=True, type=click.IntRange(1, 100_000), help="Objects a model.")
@click.option(
    "--probabilities",
    type=click.IntRange(0, 10_000),
    help="Objects whose probabilities of harm are measured; default: 100, and none with --model.",
)
@click.option("--error", "wanted", default=1e-3, show_default=True, type=click.FloatRange(0.0), help="Error to keep.")
@as_json
@click.pass_obj
def tradeoff(
    options: Options,
    site: str | None,
    models: tuple[str, ...],
    objects: int,
    probabilities: int | None,
    wanted: float,
    as_json: bool,
) -> None:
    """Measure error against cost for each model, on your motions and on objects of your collection.

    And for probabilities of harm: of each number of samples, and of the rule that stops when a word is sure.

    It takes a minute or two.  The next report of `kouros run` shows the result as a picture.

    Example: kouros tradeoff --site demo --model sliding --error 1e-4
    """
    from pipeline.verification.tradeoff import tradeoff_on

    settings = options.settings() if Path(options.config).exists() else None
    with options.console() as console:
        drawn = (0 if models else 100) if probabilities is None else probabilities
        found = tradeoff_on(settings, site, console, models=models, objects=objects, probabilities=drawn)
    cheapest = found.cheapest(wanted)
    if as_json:
        best = {name: None if setting is None else asdict(setting) for name, setting in cheapest.items()}
        click.echo(json.dumps({**asdict(found), "wanted": wanted, "cheapest": best}, indent=2))
        return
    click.echo("\n".join(tradeoff_lines(found, wanted)))


ALL = (
    demo,
    init,
    import_,
    survey,
    scan,
    check,
    run,
    prune,
    report,
    decide,
    diff,
    plan,
    serve,
    event,
    motions,
    models,
    respond,
    tradeoff,
    validate,
)
