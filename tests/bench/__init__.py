"""Measurements, run by `make bench`; numpy has one thread in them, as under the command."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
