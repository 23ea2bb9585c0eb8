"""The Python API: load, check, build, simulate; `somo_cli` offers all its names."""
