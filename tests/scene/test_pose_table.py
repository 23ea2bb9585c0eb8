"""Rows of poses from a table: what they are, and how rotations are read."""

from __future__ import annotations

import math

import pytest

from somo_cli.document.table import read_table
from somo_cli.scene.pose_table import read_pose_rows


def test_positions_and_angles_have_their_time() -> None:
    header = "yaw_rad,time_s,x_m,y_m,z_m,roll_rad,pitch_rad"
    text = f"{header}\n0.3,0,1,2,3,0.1,0.2\n0.6,1.5,4,5,6,0.4,0.5\n"
    rows = read_pose_rows(read_table(text, "a.csv"))
    assert rows.translation == ((0, 1, 2, 3), (1.5, 4, 5, 6))
    assert rows.rotation == ((0, 0.1, 0.2, 0.3), (1.5, 0.4, 0.5, 0.6))
    assert rows.quaternions == ()


def test_a_position_or_a_rotation_alone_is_enough() -> None:
    rows = read_pose_rows(read_table("time_s,x_m,y_m,z_m\n0,1,2,3\n", "a.csv"))
    assert (rows.translation, rows.rotation, rows.quaternions) == (((0, 1, 2, 3),), (), ())


def test_quaternions_have_length_one_and_never_turn_the_long_way() -> None:
    text = "time_s,qx,qy,qz,qw\n0,0,0,0,-2\n1,0,0,-0.6,-0.8\n2,0,0,0.8,0.6\n3,0,0,-1,0.1\n"
    rows = read_pose_rows(read_table(text, "a.csv")).quaternions
    assert rows[:3] == ((0, 0, 0, 0, 1), (1, 0, 0, 0.6, 0.8), (2, 0, 0, 0.8, 0.6))
    assert rows[3] == pytest.approx((3, 0, 0, 1 / math.hypot(1, 0.1), -0.1 / math.hypot(1, 0.1)))
