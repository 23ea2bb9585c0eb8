"""somo check: report the problems of files, the numerics of a scene, the plan of a run."""

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import terminal
from somo_cli.cli.application import (
    OutsideOption,
    PackageOption,
    access_of,
    app,
    examples_of,
    report_errors,
    require,
)
from somo_cli.cli.tables import read_table_file
from somo_cli.problems import (
    InvalidFile,
    Problem,
    has_errors,
    has_warnings,
    in_reading_order,
)

if TYPE_CHECKING:
    from somo_cli.arrays import Array
    from somo_cli.document.parse import Document
    from somo_cli.manipulator.kinematics import Pose
    from somo_cli.packages import Access
    from somo_cli.scene.model import Scene
    from somo_cli.simulation.plan.model import Plan


@app.command(
    short_help="Report every problem of files, before a run.",
    epilog=examples_of("somo check finger.yaml scene.yaml", "somo check scene.yaml --numerics"),
)
@report_errors
def check(
    paths: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...", help="Definitions, assemblies, scenes, trajectories, studies."
        ),
    ],
    numerics: Annotated[
        bool,
        typer.Option(
            "--numerics",
            help="Also report the numerics of one scene: natural frequencies, the largest stable "
            "explicit step, the recommended step, conditioning.",
        ),
    ] = False,
    trajectory: Annotated[
        str | None,
        typer.Option(
            "--trajectory",
            metavar="CSV",
            help="With --numerics: also examine the worst pose of a recorded run.",
        ),
    ] = None,
    plan: Annotated[
        bool,
        typer.Option(
            "--plan",
            help="Also print what a run of one scene skips, why, and what that saves.",
        ),
    ] = False,
    is_strict: Annotated[
        bool, typer.Option("--strict", help="Also exit with 1 on warnings.")
    ] = False,
    allow_outside: OutsideOption = False,
    package: PackageOption = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the findings as JSON on standard output.")
    ] = False,
) -> None:
    """Validate files: report every problem on which build or run would stop or warn.

    No engine is needed. If there is one, it finds parts that overlap at the start.

    With --numerics, a table of modes and time steps goes to standard output. Findings then have
    codes, such as explicit-step-too-long; an unstable time step is an error.
    """
    has_one = not numerics or len(paths) == 1
    require(has_one, "--numerics", f"it takes one scene, not {len(paths)}")
    require(trajectory is None or numerics, "--trajectory", "it goes with --numerics")
    require(not plan or len(paths) == 1, "--plan", f"it takes one scene, not {len(paths)}")
    require(not (plan and numerics), "--plan", "it does not go with --numerics")
    access = access_of(allow_outside, package)
    if plan:
        _check_plan(paths[0], access, is_strict, as_json)
    elif numerics:
        _check_numerics(paths[0], trajectory, access, is_strict, as_json)
    else:
        _check_files(paths, access, is_strict, as_json)


def _check_files(paths: Sequence[str], access: "Access", is_strict: bool, as_json: bool) -> None:
    from somo_cli import loading

    found: list[Problem] = []
    texts: dict[str, str] = {}
    is_unreadable = False
    for path in paths:
        try:
            document = loading.load(path, (), *access)
        except InvalidFile as error:
            found.extend(error.problems)
            texts.update(error.texts)
        except OSError as error:
            is_unreadable = True
            terminal.print_message(f"somo: {error.filename or path}: {error.strerror or error}")
        else:
            problems, read = _problems_of(document, path, access)
            found.extend(problems)
            texts.update(read)
    found = list(in_reading_order(found, texts))
    if as_json:
        typer.echo(json.dumps(_plain(found), indent=2))
    else:
        terminal.print_problems(found, texts)
    raise typer.Exit(5 if is_unreadable else int(_is_found(found, is_strict)))


def _problems_of(
    document: "Document", path: str, access: "Access"
) -> "tuple[Sequence[Problem], Mapping[str, str]]":
    """Return the problems of a file, and the texts that they lie in."""
    from somo_cli import document_kinds, loading

    if not document_kinds.is_study(document):
        return loading.check_with_overlaps(document), document.texts
    from somo_cli.sweep import sweep

    try:
        loaded = sweep.load(path, (), access)
        return loaded.warnings, loaded.texts
    except InvalidFile as error:
        return error.problems, error.texts


def _scene_of(document: "Document", as_json: bool) -> "tuple[Scene, Sequence[Problem]]":
    """Return the scene of a document and its warnings; print its errors and exit if it has any."""
    from somo_cli import loading

    try:
        return loading.scene_of(document)
    except InvalidFile as error:
        # for check the errors of a file are findings, so the exit code is 1
        _print_findings(error.problems, error.texts, {}, as_json)
        raise typer.Exit(1) from error


def _check_plan(path: str, access: "Access", is_strict: bool, as_json: bool) -> None:
    from somo_cli import loading

    document = loading.load(path, (), *access)
    scene, problems = _scene_of(document, as_json)
    from somo_cli.simulation import plan_report
    from somo_cli.simulation.plan.build import make_plan

    plan = make_plan(scene)
    found = in_reading_order([*problems, *loading.overlaps(document, scene)], document.texts)
    _print_findings(found, document.texts, {"plan": plan_report.plain_data(plan)}, as_json)
    if not as_json:
        for decision in plan_report.explain(plan):
            typer.echo(str(decision))
    raise typer.Exit(int(_is_found(found, is_strict)))


def _check_numerics(
    path: str, trajectory: str | None, access: "Access", is_strict: bool, as_json: bool
) -> None:
    from somo_cli import loading

    document = loading.load(path, (), *access)
    scene, problems = _scene_of(document, as_json)
    from somo_cli.analysis import stability_report
    from somo_cli.analysis.numerics import assess
    from somo_cli.simulation.plan.build import make_plan

    plan = make_plan(scene)
    known = assess(plan, loading.as_scene(document), _recorded_poses(trajectory, plan))
    overlaps = loading.overlaps(document, scene)
    found = in_reading_order([*problems, *overlaps, *known.findings], document.texts)
    _print_findings(found, document.texts, stability_report.plain_data(known), as_json)
    if not as_json:
        for line in stability_report.table(known):
            typer.echo(line)
    raise typer.Exit(int(_is_found(found, is_strict)))


def _recorded_poses(
    trajectory: str | None, plan: "Plan"
) -> "Mapping[str, Sequence[tuple[Pose, Array]]]":
    from somo_cli.analysis.trajectory import visited_poses

    if trajectory is None:
        return {}
    return visited_poses(read_table_file(trajectory), plan)


def _print_findings(
    found: Sequence[Problem],
    texts: Mapping[str, str],
    known: Mapping[str, object],
    as_json: bool,
) -> None:
    if not as_json:
        terminal.print_problems(found, texts)
        return
    typer.echo(json.dumps({"findings": _plain(found), **known}, indent=2))


def _is_found(problems: Iterable[Problem], is_strict: bool) -> bool:
    known = tuple(problems)
    return has_errors(known) or (is_strict and has_warnings(known))


def _plain(found: Iterable[Problem]) -> list[dict[str, object]]:
    return [
        {
            "code": problem.code or "document",
            "path": problem.span.source,
            "line": problem.span.line,
            "column": problem.span.column,
            "severity": problem.severity,
            "message": problem.message,
            "hint": problem.hint,
        }
        for problem in found
    ]
