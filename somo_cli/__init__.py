"""Soft manipulators described in YAML, compiled to URDF and brought to life without a display.

The map of the house. Five pipelines, each on one screen:

- `somo build` is `manipulator/compile.py`: text ─parse─▶ Document ─validate─▶ Document ─read─▶
  Definition (SI) ─build─▶ Chain ─scaled─▶ Chain ─render─▶ URDF text.
- `somo run` is `simulation/run.py`: the scene takes the same way to a Scene, each definition it
  names is compiled, `make_plan` settles the rest, then World and recorder go step by step.
- `somo report` is `analysis/study.py`: the Scene in many variants, each run by `analysis/trial.py`,
  errors against a reference, and a choice.
- `somo render` is `picture/draw.py`: rows of a run, simulated or read, to moments, to where every
  solid is, to what the renderer of the engine sees, to pixels.
- `somo calibrate` is one file of `calibration/` for each rule: measured numbers to those of joints,
  which `document/patch.py` puts into the text they came from.

The rooms, each of which knows only those before it: `problems` says what a fault is; `document/`
is a file as it was written; `manipulator/` is what it means, and its URDF; `simulation/` brings it
to life; `analysis/` says what a run costs and how far off it is, before and after; `calibration/`
leads from what a lab measures to what it needs; `picture/` draws; `loading` leads from a path to a
judged document, by `files`; `cli/` is the front door and has the one voice, `terminal`.
`document/` and `manipulator/` are pure: text in, values out, every fault with its place in the
text. Each library has one home; `tests/test_architecture.py` is the law that says which.
"""

__version__ = "0.1.0"
