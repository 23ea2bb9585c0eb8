"""The topics of the manual, in the order in which a new user meets them, and their pages."""

from __future__ import annotations

from pathlib import Path

from somo_cli import files

TOPICS = {
    "tour": "from an empty folder to a film, in five minutes",
    "design": "from a modulus and a section to a gripper that lifts a ball",
    "commands": "what each command reads and writes; exit codes, errors, bytes",
    "definitions": "manipulators and assemblies in YAML",
    "scenes": "what is in a scene: actuation, objects, ground, loads, records, stops",
    "contact": "what a run finds of its contact; how to choose step, scale, friction, stiffness",
    "pictures": "stills, films and plots",
    "accuracy": "error against run time: report, --error, --tolerance, --numerics",
    "calibrate": "from measurements to stiffness, torque and damping",
    "sweeps": "many runs: parameters, labels, one table",
    "scripts": "exit codes, findings as data, GitHub Actions, SLURM",
    "studies": "the shipped studies: what they show, with pictures",
    "python": "the API: load, check, build, simulate, Simulation",
    "models": "URDF, SDF and MJCF for other programs; a scene that opens in MuJoCo",
    "from-somo": "what changes for a user of SoMo",
    "troubleshooting": "every finding and the usual errors: what they mean, what to do",
    "columns": "what can be recorded, with units",
    "fields": "every field of every kind of file, with units",
    "glossary": "the words of the manual",
    "method": "the spring-damper law, and the prediction of contact",
    "benchmarks": "the law against theory, MuJoCo and the loop that users write",
}
"""Each topic and what its page is about."""

GENERATED = ("columns", "fields")
"""The topics without a file: they are written from the schemas and the registry of quantities."""

_FOLDER = Path(__file__).parent / "pages"


def page(topic: str) -> str:
    """Return the page of a topic as Markdown; raises KeyError for one that is unknown."""
    if topic not in TOPICS:
        raise KeyError(topic)
    if topic in GENERATED:
        return _generated(topic)
    return files.read_text(str(_FOLDER / f"{topic}.md"))


def _generated(topic: str) -> str:
    # imported here: other pages need neither schemas nor quantities
    from somo_cli.document.schemas import schema_names
    from somo_cli.manual.column_reference import column_reference
    from somo_cli.manual.schema_reference import schema_reference

    if topic == "columns":
        return column_reference()
    return "# Fields\n\n" + "\n".join(map(schema_reference, schema_names()))


def contents() -> str:
    """Return the list of topics as Markdown."""
    rows = "\n".join(f"- `somo help {topic}`: {about}" for topic, about in TOPICS.items())
    return (
        f"# The manual\n\n{rows}\n\n"
        "`somo help WORD` searches all pages; `somo COMMAND --help` lists its options.\n"
    )
