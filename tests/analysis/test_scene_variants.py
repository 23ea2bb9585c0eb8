"""The scene that a study runs: whole quantities, to the end of the study's time."""

from __future__ import annotations

import json

from somo_cli.analysis.scene_variants import study_variant
from tests.builders.scenes import scene_from_file


def test_a_study_records_what_it_compares_and_what_the_scene_picks() -> None:
    record = json.dumps({"only": ["finger.*.curvature_per_m", "finger.tip.z_m", "cube.*"]})
    scene = scene_from_file(
        "push_scene.yaml", f"record={record}", "stop=[{time: 1}, {at_rest: {}}]"
    )
    found = study_variant(scene)
    assert set(found.columns) == {
        "tip_position",
        "joint_angles",
        "energy",
        "curvatures",
        "contact_pairs",
    }
    assert found.object_quantities[:2] == ("pose", "contact_pairs")
    assert (found.only, found.stop_conditions) == ((), ())


def test_a_study_of_a_scene_without_patterns() -> None:
    scene = scene_from_file("scene.yaml", "record.columns=[curvatures, tip_position]")
    assert study_variant(scene).columns == ("tip_position", "joint_angles", "energy", "curvatures")
