"""The Python API: load, check, build, simulate; every name of it is also one of `somo_cli`."""
