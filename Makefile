# Each target makes the virtual environment it needs. Wanted on the machine: Python 3.11, make, a PyPI index.

PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV ?= .venv
LOWEST ?= .venv-lowest
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet --no-input
PACKAGES := files inputs superelement results preprocess solver view study cli

.DEFAULT_GOAL := help
.PHONY: help demo test test-lowest lint validation benchmark docs constraints clean
.DELETE_ON_ERROR:

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /  make \1	/p' $(MAKEFILE_LIST)

demo: $(VENV)/.installed ## a mesh of a beam, its superelement, the paper's Case 1, and a picture of the motion
	@mkdir -p out
	$(BIN)/duhamel preprocess meshes/beam/beam.toml
	$(BIN)/duhamel run examples/case1.toml -o out/case1-results.h5
	$(BIN)/duhamel plot out/case1-results.h5 angular_velocity:hub:z displacement:beam.tip:hub.rim:y \
	  --title "Case 1: a beam on a hub that a torque turns and stops" -o out/case1.png
	@echo "hub speed and tip deflection: $(CURDIR)/out/case1.png"

test: $(VENV)/.installed ## the tests
	$(BIN)/python -m pytest

test-lowest: $(LOWEST)/.installed ## the wheel, installed with the oldest numba and numpy, and the tests of compiled code
	$(LOWEST)/bin/python .ci/check_wheel.py build/wheel/*.whl
	cd tests && ../$(LOWEST)/bin/python -m pytest -c ../pyproject.toml solver/compiler solver/test_rigid.py

lint: $(VENV)/.installed build/types/.linked ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	MYPYPATH=build/types $(BIN)/mypy $(PACKAGES:%=-p duhamel.%)

validation: $(VENV)/.validation ## published problems and peer codes; takes minutes
	$(BIN)/python -m pytest -m validation

benchmark: $(VENV)/.validation ## timed work; where there is a peer, as ratios measured in the same run
	@set -e; for program in benchmarks/*.py; do echo "$$program"; $(BIN)/python "$$program"; done

docs: $(VENV)/.docs build/types/.linked ## the map of the code, and its reference in build/docs
	$(BIN)/python tools/draw_architecture.py
	PYTHONPATH=build/types $(BIN)/python tools/make_reference.py build/docs
	@echo "reference of the code: $(CURDIR)/build/docs/index.html"

constraints: ## the newest versions that pyproject.toml allows, written to constraints.txt
	rm -rf build/constraints
	$(PYTHON) -m venv build/constraints
	build/constraints/bin/python -m pip --disable-pip-version-check --quiet install ".[test,validation,docs]"
	{ sed -n '/^#/p' constraints.txt; \
	  build/constraints/bin/python -m pip freeze --exclude duhamel; } > build/constraints.txt
	mv build/constraints.txt constraints.txt
	rm -rf build/constraints

clean: ## remove what the targets above made
	rm -rf $(VENV) $(LOWEST) build out

# The stamps stand for a finished installation: a second make finds them and installs nothing.
$(VENV)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(PIP) install -c constraints.txt -e ".[test]"
	@touch $@

$(VENV)/.validation: $(VENV)/.installed
	$(PIP) install -c constraints.txt -e ".[test,validation]"
	@touch $@

# Not editable: what is tested is the wheel.
$(LOWEST)/.installed: pyproject.toml constraints.txt constraints-lowest.txt $(shell find $(PACKAGES) -name '*.py')
	rm -rf $(LOWEST) build/wheel build/lib
	$(PYTHON) -m venv $(LOWEST)
	$(LOWEST)/bin/python -m pip --disable-pip-version-check --quiet --no-input wheel --no-deps -w build/wheel .
	{ grep -vE '^(numba|llvmlite|numpy)==' constraints.txt; cat constraints-lowest.txt; } \
	  > build/constraints-lowest.txt
	$(LOWEST)/bin/python -m pip --disable-pip-version-check --quiet --no-input install \
	  -c build/constraints-lowest.txt build/wheel/*.whl pytest
	@touch $@

$(VENV)/.docs: $(VENV)/.installed
	$(PIP) install -c constraints.txt -e ".[test,docs]"
	@touch $@

# An editable install hides the namespace from mypy, so it is shown a tree of links with the same shape.
build/types/.linked: Makefile
	mkdir -p build/types/duhamel
	for package in $(PACKAGES); do ln -sfn ../../../$$package build/types/duhamel/$$package; done
	@touch $@
