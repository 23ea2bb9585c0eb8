# `make test` and `make demo` work from a fresh clone: they set up $(VENV) first, and again only when
# pyproject.toml has changed. PYTHON=... chooses the interpreter.

VENV := .venv
PYTHON ?=
PYTHONS := python3.11 python3.10 python3.12 python3.13 python3
VERSIONS := 3.10 3.11 3.12 3.13

RUN := $(VENV)/bin/python -m
READY := $(VENV)/.ready

# A sourced ROS or conda workspace would otherwise put its own packages and pytest plugins before ours.
unexport PYTHONPATH PYTHONHOME

# Where another interpreter than last time is asked for, the environment is made anew.
ifneq ($(PYTHON),)
ifneq ($(PYTHON),$(shell cat $(READY) 2>/dev/null))
.PHONY: $(READY)
endif
endif

.PHONY: all film help sync demo test test-fast test-all check format map golden bench truth contact grasp sliding free-bodies objects predict trust faults fuzz signals extreme studies build clean
.DELETE_ON_ERROR:

all: help

help: ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-10s %s\n", $$1, $$2 }' Makefile

sync: $(READY) ## set up .venv with everything for work on somo

$(READY): pyproject.toml
	@python=$$(.ci/find-python $(if $(PYTHON),"$(PYTHON)",$(PYTHONS))) || exit 1; \
	echo "setting up $(VENV) with $$python (a minute or two, once)"; \
	"$$python" -m venv --clear $(VENV) && \
	$(RUN) pip install --quiet --disable-pip-version-check --editable '.[dev]' && \
	echo "$(PYTHON)" > $@

demo: sync ## compile the finger, simulate it for 2000 steps, show where its tip went
	@mkdir -p build
	$(VENV)/bin/somo build definitions/finger.yaml -o build/finger.urdf
	$(VENV)/bin/somo run definitions/scene.yaml --steps 2000 -o build/finger.csv
	@echo "build/finger.csv, first and last row:"
	@awk -F , ' \
	  NR == 1 { for (i = 1; i <= NF; i++) if ($$i ~ /^time|tip/) shown[++n] = i } \
	  { row = ""; for (j = 1; j <= n; j++) row = row sprintf("  %20s", $$shown[j]) } \
	  NR <= 2 { print row } END { print row }' build/finger.csv

# as many processes as there are cores, unless PROCESSES says otherwise
PROCESSES ?= auto

test: sync ## run the tests
	$(RUN) pytest -n $(PROCESSES) --maxprocesses 8

test-fast: sync ## run the tests that take little, in about a minute; every module is touched
	$(RUN) pytest -q -n $(PROCESSES) --maxprocesses 8 -m "not slow and not moderate and not bench"

# what test-all leaves out, as a marker expression of pytest
LEFT_OUT ?= slow or bench

test-all: ## run the tests, but for the slow ones, on every Python from 3.10 to 3.13 that is found
	@for version in $(VERSIONS); do \
	  .ci/find-python -q python$$version >/dev/null || echo "Python $$version: not found, not tested"; \
	done
	@failed=; tested=; \
	for version in $(VERSIONS); do \
	  python=$$(.ci/find-python -q python$$version) || continue; \
	  echo "Python $$version:"; tested=yes; \
	  PYTEST_ADDOPTS="-q -m 'not ($(LEFT_OUT))'" $(MAKE) --no-print-directory VENV=.venv-$$version PYTHON="$$python" test \
	    || failed="$$failed $$version"; \
	done; \
	if [ -z "$$tested" ]; then echo "no Python was found to test on" >&2; exit 1; fi; \
	if [ -n "$$failed" ]; then echo "the tests failed on:$$failed" >&2; exit 1; fi

check: sync ## lint, formatting, cognitive complexity, types
	$(RUN) ruff check
	$(RUN) ruff format --check
	$(VENV)/bin/complexipy somo_cli --max-complexity-allowed 15 --failed --plain
	$(RUN) mypy

format: sync ## format, and mend what the linter can mend
	$(RUN) ruff check --fix
	$(RUN) ruff format

map: sync ## draw the rooms of the code and what each imports
	$(RUN) tests.architecture.map

golden: sync ## write the golden URDFs and messages anew: the diff is the review
	$(RUN) pytest tests/manipulator/test_golden.py tests/test_cases.py --rewrite-golden

bench: sync ## measure speed, start-up, error against run time, stability, physics
	$(RUN) tests.bench.stepping
	$(RUN) tests.bench.parts
	$(RUN) tests.bench.loads
	$(RUN) tests.bench.engine
	$(RUN) tests.bench.recording
	$(RUN) tests.bench.rendering
	$(RUN) tests.bench.calls
	$(RUN) tests.bench.hand
	$(RUN) tests.bench.stacking
	$(RUN) tests.bench.accuracy
	$(RUN) tests.bench.stability
	$(RUN) tests.bench.physics
	$(RUN) tests.bench.startup

truth: sync ## hold results against theory and MuJoCo, all in one table
	$(RUN) tests.truth

contact: sync ## hold contact against converged references, over laws, cases and steps (minutes)
	$(RUN) tests.contact

sliding: sync ## slide bodies in every direction, and lay them on soft ground (minutes)
	$(RUN) tests.sliding

grasp: sync ## hold grasps against converged ones, over masses, damping, shapes and steps (minutes)
	$(RUN) tests.grasp

extreme: sync ## run stiff and extreme cases (minutes), and compare with the matrix of before
	$(RUN) tests.extreme

predict: sync ## hold errors, tolerances and contact steps against the truth (minutes)
	$(RUN) tests.predict

trust: sync ## run random extreme contact scenes: what is unphysical must be found (minutes)
	$(RUN) tests.trust

faults: sync ## have every system call of every command fail that writes (minutes; needs strace)
	$(RUN) tests.robustness.faults

fuzz: sync ## mutate the shipped files 50,000 times, and have check, build and run read them (an hour)
	$(RUN) tests.robustness.fuzz

signals: sync ## send signals at random moments to every command (minutes)
	$(RUN) tests.robustness.signals

free-bodies: sync ## let bodies spin freely, against closed forms and MuJoCo (minutes)
	$(RUN) tests.free_bodies

objects: sync ## load the objects that come with PyBullet, and compare with its own loader (minutes)
	$(RUN) tests.public_objects

studies: sync ## run the studies of the manual at full length (minutes)
	$(RUN) tests.studies

film: sync ## draw the film of the README
	$(VENV)/bin/somo render definitions/in_hand_scene.yaml --duration 6 --every 0.12 --speed 2 --size 400x300 \
	  -o tests/studies/pictures/in_hand_film.gif

build: sync ## make sdist and wheel in dist/, and use the wheel in an empty environment
	rm -rf dist
	$(RUN) build --outdir dist
	.ci/try-wheel $(VENV)/bin/python dist/*.whl

clean: ## remove everything that make made
	rm -rf .venv .venv-3.* build dist .complexipy_cache .mypy_cache .pytest_cache .ruff_cache
	find somo_cli tests -name __pycache__ -type d -prune -exec rm -rf {} +
