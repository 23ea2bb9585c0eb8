"""somo sweep: run a scene for many sets of parameters, and write one table of results."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import terminal
from somo_cli.cli.application import (
    OutsideOption,
    PackageOption,
    QuietOption,
    SetOption,
    access_of,
    app,
    examples_of,
    report_errors,
    require,
)
from somo_cli.cli.outputs import refuse_unsafe
from somo_cli.problems import ClusterFailed, counted

if TYPE_CHECKING:
    from somo_cli.sweep.results import Results
    from somo_cli.sweep.sweep import LoadedStudy


@app.command(
    short_help="Run a scene for many sets of parameters.",
    epilog=examples_of(
        "somo sweep study.yaml --dry-run",
        "somo sweep study.yaml --jobs 4 --resume",
        "somo sweep study.yaml --resume --best lifted",
    ),
)
@report_errors
def sweep(
    study: Annotated[str, typer.Argument(help="A study: a scene, parameters and labels.")],
    jobs: Annotated[
        int | None,
        typer.Option("--jobs", "-j", min=1, help="Worker processes. [default: one for each core]"),
    ] = None,
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FOLDER",
            help="Folder for results.csv, study.json, logs and trajectories. [default: the name of "
            "the study with _results, in the current directory]",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            metavar="ADDRESS",
            help="Run on the Dask cluster of this scheduler, such as tcp://10.0.0.1:8786, in place "
            "of processes of this machine. Its workers need the same somo.",
        ),
    ] = None,
    resumes: Annotated[
        bool, typer.Option("--resume", help="Go on in a folder with results: do what is missing.")
    ] = False,
    retries: Annotated[
        bool, typer.Option("--retry-failed", help="With --resume: do runs that failed again.")
    ] = False,
    only_checks: Annotated[
        bool,
        typer.Option(
            "--dry-run",
            help="Compile and check every set, print the number of runs and the invalid sets, and "
            "run nothing.",
        ),
    ] = False,
    shard: Annotated[
        str | None,
        typer.Option(
            "--shard",
            metavar="I/N",
            help="Do every N-th run alone, from the I-th of the first N on, as in 1/4 to 4/4.",
        ),
    ] = None,
    merge: Annotated[
        list[str] | None,
        typer.Option(
            "--merge",
            metavar="FOLDER",
            help="Take the results of another folder of the same study; runs nothing. Repeatable.",
        ),
    ] = None,
    best: Annotated[
        str | None,
        typer.Option(
            "--best",
            metavar="LABEL",
            help="Print the ten runs in which a label is largest; -LABEL for the smallest.",
        ),
    ] = None,
    where: Annotated[
        str | None,
        typer.Option(
            "--where",
            metavar="EXPRESSION",
            help="Of --best: only runs for which an expression over labels and parameters is true.",
        ),
    ] = None,
    sets: SetOption = None,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
    quiet: QuietOption = False,
) -> None:
    """Run a scene for many sets of parameters, and write one table of results.

    The table, results.csv, has a row for each set: parameters, labels, and how the run ended. A run
    that fails is a row as well; the sweep goes on, and exits with 1 in the end. An interrupted
    sweep goes on with --resume.
    """
    require(resumes or not retries, "--retry-failed", "it is for --resume")
    require(best is not None or where is None, "--where", "it is for --best")
    part = _shard(shard)
    from somo_cli.sweep import sweep as sweeps
    from somo_cli.sweep.pool import available_cores
    from somo_cli.sweep.results import FILES, Results

    loaded = sweeps.load(study, sets or [], access_of(allow_outside, package))
    terminal.print_problems(loaded.warnings, loaded.texts)
    if scheduler is not None:
        _require_for_cluster(loaded, jobs)
    workers = jobs or available_cores()
    if only_checks:
        raise typer.Exit(_checked(loaded, workers))
    folder = output or f"{Path(study).stem}_results"
    refuse_unsafe(loaded.texts, [(str(Path(folder) / name), "--output") for name in FILES])
    numbers = range(len(loaded.study.points))[part[0] - 1 :: part[1]]
    results = Results(folder, loaded.study, loaded.about, resumes or merge is not None)
    if retries:
        results.forget_failures()
    with results.taking(merge or ()):
        if merge is None:
            _run_missing(loaded, results, numbers, workers, scheduler)
    if not quiet:
        terminal.print_message(_summary(folder, results, len(loaded.study.points)))
    if best is not None:
        _print_best(loaded, results, best, where)
    if results.failures:
        raise typer.Exit(1)


def _require_for_cluster(loaded: "LoadedStudy", jobs: int | None) -> None:
    """Exit with a usage error for what works on this machine alone."""
    require(jobs is None, "--jobs", "it is for this machine, not a cluster")
    hint = "the study has a time_out, which works on this machine alone"
    require(loaded.study.time_out is None, "--scheduler", hint)


def _run_missing(
    loaded: "LoadedStudy",
    results: "Results",
    numbers: Sequence[int],
    workers: int,
    scheduler: str | None,
) -> None:
    """Run what has no outcome; say how an interrupted sweep goes on."""
    from somo_cli.sweep import sweep as sweeps

    before = len(results.outcomes)
    total = sum(number not in results.outcomes for number in numbers)
    try:
        with _progress(total, before) as advance:
            sweeps.run(loaded, results, numbers, workers, advance, scheduler)
    except (KeyboardInterrupt, ClusterFailed):
        done = counted(len(results.outcomes), "run")
        terminal.print_message(f"somo: {results.folder} has {done}; go on with --resume")
        raise


def _shard(text: str | None) -> tuple[int, int]:
    if text is None:
        return 1, 1
    first, slash, count = text.partition("/")
    is_right = slash == "/" and first.isdigit() and count.isdigit() and first.isascii()
    require(is_right and 1 <= int(first) <= int(count), "--shard", f"{text!r} is not like 1/4")
    return int(first), int(count)


@contextmanager
def _progress(total: int, before: int) -> Iterator[Callable[["Results"], None]]:
    """Yield what shows progress."""
    failures = 0
    with terminal.progress(total, "running", remark=lambda: f", {failures} failed") as show:

        def advance(results: "Results") -> None:
            nonlocal failures
            failures = results.failures
            show(len(results.outcomes) - before)

        yield advance


def _summary(folder: str, results: "Results", total: int) -> str:
    statuses = [one.status for one in results.outcomes.values()]
    counts = {status: statuses.count(status) for status in dict.fromkeys(sorted(statuses))}
    found = sum(bool(one.findings) for one in results.outcomes.values())
    parts = [f"{count} {status}" for status, count in counts.items()]
    parts += [f"{found} with findings"] * (found > 0)
    parts += [f"{total - len(statuses)} missing"] * (len(statuses) < total)
    return f"{folder}/results.csv: {counted(len(statuses), 'run')}: {', '.join(parts)}"


def _checked(loaded: "LoadedStudy", workers: int) -> int:
    """Print what a check of all sets finds; return the exit code."""
    from somo_cli.sweep import sweep as sweeps

    points = loaded.study.points
    with terminal.progress(len(points), "checking") as advance:
        outcomes = sweeps.check(loaded, workers, advance)
    wrong = {number: one for number, one in sorted(outcomes.items()) if not one.is_good}
    for number, one in wrong.items():
        given = ", ".join(f"{name}={value}" for name, value in points[number].items())
        typer.echo(f"{number}: {given}: {one.reason}")
    typer.echo(f"{counted(len(points), 'run')}, {len(wrong)} of them invalid")
    return int(bool(wrong))


def _print_best(loaded: "LoadedStudy", results: "Results", text: str, where: str | None) -> None:
    from somo_cli.sweep.best import best_table

    is_smallest, label = text.startswith("-"), text.removeprefix("-")
    try:
        lines: Sequence[str] = best_table(loaded.study, results.outcomes, label, is_smallest, where)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="'--best'") from None
    for line in lines:
        typer.echo(line)
