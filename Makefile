# Each target makes the virtual environment it needs. Wanted on the machine: Python 3.11, make, a PyPI index.

PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV ?= .venv
# Windows keeps the commands of an environment elsewhere.
SCRIPTS := $(if $(filter Windows_NT,$(OS)),Scripts,bin)
BIN := $(VENV)/$(SCRIPTS)
CI := build/ci
# Where lint and docs find their tools.
TOOLS ?= $(VENV)
PACKAGES := files inputs superelement cad results preprocess solver view study robots fmu cli
DATA := $(wildcard cli/starters/*/* fmu/c/* fmu/c/fmi/*) $(wildcard view/report/*.css view/report/*.html view/report/*.js)
SOURCES := pyproject.toml $(shell find $(PACKAGES) top -name '*.py' -o -name py.typed) $(DATA)
EVERY := test gallery cholmod peer notebooks docs
# Each process takes one thread. A file's tests go to one of them, for what they share is made once.
PARALLEL := -n 2 --dist loadfile --no-loadscope-reorder
LOCK := --quiet --upgrade --generate-hashes --python-version 3.11 --custom-compile-command "make constraints"

CORE := $(patsubst %,solver/step/%.py,rotations rows frames history newton equations interfaces \
  second_order) \
  superelement/interface.py preprocess/responses/krylov.py

# Tests of the compiled code; of what versions of Python differ in; of the equations, quick as plain Python.
COMPILED := tests/solver/compiler tests/solver/test_rigid.py
FAST := $(COMPILED) tests/solver/test_restart.py tests/superelement tests/results \
  $(addprefix tests/cli/test_,run.py check.py init.py completion.py preprocess.py schemas.py) \
  tests/preprocess/body
# What each newer Python is for: MPI and PETSc come as wheels from 3.12 on; the compiler, of small functions, and readers on
# the newest. Both run the code of the wheel.
TESTS_OF_3.12 := tests/solver/test_rigid.py tests/preprocess/parallel
TESTS_OF_3.13 := $(addprefix tests/solver/compiler/test_,machine_code.py dual.py typed.py struct.py) \
  tests/solver/test_rigid.py tests/cli/test_run.py tests/cli/test_preprocess.py tests/superelement/test_file.py \
  $(addprefix tests/results/test_,file.py old_files.py netcdf.py)
PLAIN := tests/solver/test_rotations.py tests/solver/test_tangents.py tests/solver/test_blocks.py \
  --hypothesis-profile=faults tests/solver/properties/test_conservation.py

.DEFAULT_GOAL := help
.PHONY: help demo test slow-test lint validation large-validation fuzz benchmark soak mutants docs notebooks constraints clean
.PHONY: wheel wheel-test platform-test plain-test coverage python-test lowest-test audit release
.DELETE_ON_ERROR:
# What a pattern makes on the way is not removed again.
.PRECIOUS: $(CI)/%/.installed $(CI)/%/.wheel

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /  make \1	/p' $(MAKEFILE_LIST)

demo: $(VENV)/.installed ## a mesh of a beam, its superelement, the paper's Case 1, and a picture of the motion
	@mkdir -p out
	$(BIN)/duhamel preprocess meshes/beam/beam.toml
	$(BIN)/duhamel run examples/case1.toml -o out/case1-results.h5
	$(BIN)/duhamel plot out/case1-results.h5 angular_velocity:hub:z displacement:beam.tip:hub.rim:y \
	  --title "Case 1: a beam on a hub that a torque turns and stops" -o out/case1.png
	@echo "hub speed and tip deflection: $(CURDIR)/out/case1.png"

test: $(VENV)/.installed ## the tests that take up to a second each, on two processes
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest $(PARALLEL) -m "not slow and not validation and not large and not soak"

slow-test: $(VENV)/.installed ## those that take longer, as tests/slow.txt lists them; .ci/run runs them too
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest $(PARALLEL) -m "slow and not validation and not large and not soak"

lint: $(TOOLS)/.installed build/types/.linked ## style and types
	$(TOOLS)/$(SCRIPTS)/ruff check .
	$(TOOLS)/$(SCRIPTS)/ruff format --check .
	MYPYPATH=build/types $(TOOLS)/$(SCRIPTS)/mypy -p duhamel
	$(TOOLS)/$(SCRIPTS)/python tools/budget.py

validation: $(VENV)/.validation ## published problems and peer codes; takes minutes
	$(BIN)/python -m pytest -m validation --complete

large-validation: $(VENV)/.validation ## exact problems with a million unknowns; takes half an hour and 9 GB
	$(BIN)/python -m pytest -m large --complete tests/validation

wheel: build/wheel/.built ## the wheel, with the compiled time step for Linux, Windows and macOS, in build/wheel

wheel-test: $(CI)/3.11/.wheel ## all tests, of the wheel, with every extra: none may be skipped
	$(CI)/3.11/bin/python .ci/check_wheel.py build/wheel/*.whl
	$(CI)/3.11/bin/pytest --complete $(PARALLEL)

platform-test: $(CI)/platform/.installed ## the wheel that lies in build/wheel, on this machine: tests of compiled code and commands
	$(CI)/platform/$(SCRIPTS)/python -m pip -qq install --no-deps --no-index --force-reinstall build/wheel/*.whl
	$(CI)/platform/$(SCRIPTS)/python .ci/check_wheel.py build/wheel/*.whl
	OMP_NUM_THREADS=1 $(CI)/platform/$(SCRIPTS)/python -m pytest -q $(FAST)

plain-test: $(CI)/3.11/.wheel ## tests that run compiled code as plain Python
	NUMBA_DISABLE_JIT=1 $(CI)/3.11/bin/pytest -q $(PLAIN)

coverage: $(CI)/3.11/.wheel ## the branches that all tests take, compiled code as plain Python; takes an hour
	COVERAGE_FILE=$(CI)/coverage.wheel $(CI)/3.11/bin/coverage run $(CI)/3.11/bin/pytest -q --complete
	NUMBA_DISABLE_JIT=1 COVERAGE_FILE=$(CI)/coverage.plain \
	  $(CI)/3.11/bin/coverage run $(CI)/3.11/bin/pytest -q $(PLAIN)
	$(CI)/3.11/bin/coverage combine --keep --quiet --data-file=$(CI)/.coverage $(CI)/coverage.*
	$(CI)/3.11/bin/python .ci/coverage_table.py $(CI)/.coverage

python-test: export DUHAMEL_COMPILER :=
python-test: $(CI)/$(VERSION)/.wheel ## the wheel on another Python, VERSION=3.13: tests of compiled code and readers, on 3.12 of MPI
	$(CI)/$(VERSION)/bin/python .ci/check_wheel.py build/wheel/*.whl
	$(CI)/$(VERSION)/bin/pytest -q --complete $(TESTS_OF_$(VERSION))

lowest-test: $(CI)/lowest/.wheel ## the wheel with the oldest numba and numpy: tests of compiled code
	$(CI)/lowest/bin/python .ci/check_wheel.py build/wheel/*.whl
	$(CI)/lowest/bin/pytest -q --complete $(COMPILED)

audit: $(CI)/3.11/.wheel ## known vulnerabilities of what the constraints name, where a list of them is reached
	$(CI)/3.11/bin/python .ci/audit.py constraints.txt

release: $(CI)/release/.installed $(CI)/tools/.installed ## wheel and sdist of HEAD in build/release, built twice and compared, and checked; TAG=v1.2.3
	$(CI)/release/bin/python .ci/build_release.py build/release $(TAG)
	$(CI)/tools/bin/twine check --strict build/release/*
	$(CI)/tools/bin/check-wheel-contents --ignore W002 build/release/*.whl
	$(CI)/release/bin/python -m pip -qq install --no-deps --no-index --force-reinstall build/release/*.whl
	$(CI)/release/bin/python .ci/check_wheel.py build/release/*.whl
	cd build/release && sha256sum *.whl *.tar.gz

fuzz: $(VENV)/.installed ## damaged files for all readers, for SECONDS=60 from number FIRST=0 on
	$(BIN)/python -m tests.fuzz.run $(or $(SECONDS),60) $(or $(FIRST),0)

soak: $(VENV)/.installed ## ten million steps, two hundred bodies, every bad value at every key of a model; takes half an hour
	$(BIN)/python -m pytest -m soak -s tests/soak tests/bad_inputs

mutants: $(VENV)/.installed ## faults put into the core, and which the tests do not notice; takes half an hour
	nice $(BIN)/python tools/mutate.py $(CORE)

benchmark: $(VENV)/.benchmark ## timed work and ratios to peers, in build/benchmarks.md; takes an hour
	$(BIN)/python benchmarks

docs: $(TOOLS)/.docs build/types/.linked ## the documentation as a site in build/site; warnings are errors
	$(TOOLS)/$(SCRIPTS)/python tools/draw_architecture.py
	NO_MKDOCS_2_WARNING=1 PYTHONPATH=build/types $(TOOLS)/$(SCRIPTS)/mkdocs build --strict --quiet
	$(TOOLS)/$(SCRIPTS)/python tools/check_site.py build/site
	@echo "documentation: $(CURDIR)/build/site/index.html; its search needs: python -m http.server -d build/site"

notebooks: $(VENV)/.notebooks ## the notebooks, run, with their pictures, in build/notebooks
	MPLBACKEND= $(BIN)/python tools/run_notebooks.py build/notebooks

constraints: ## the newest versions that pyproject.toml allows, with hashes, written to constraints*.txt
	$(PYTHON) -m venv build/constraints
	build/constraints/bin/python -m pip --disable-pip-version-check --quiet install uv
	build/constraints/bin/uv pip compile $(LOCK) --universal --all-extras pyproject.toml -o build/constraints.txt
	build/constraints/bin/uv pip compile $(LOCK) --extra build --extra pytest pyproject.toml constraints-lowest.in \
	  -o build/constraints-lowest.txt
	mv build/constraints*.txt .
	rm -rf build/constraints

clean: ## remove what the targets above made
	rm -rf $(VENV) build out

# The stamps stand for a finished installation: a second make finds them and installs nothing.
INSTALL := .ci/install pyproject.toml constraints.txt
$(VENV)/.installed: $(INSTALL)
	.ci/install $(PYTHON) $(VENV) constraints.txt test
	$(BIN)/python -m pip -qq install --no-deps --no-build-isolation -e .
	@touch $@

$(VENV)/.validation: $(VENV)/.installed
	.ci/install $(PYTHON) $(VENV) constraints.txt test validation
	@touch $@

$(VENV)/.benchmark: $(VENV)/.installed
	.ci/install $(PYTHON) $(VENV) constraints.txt test benchmark
	@touch $@

$(VENV)/.docs: $(VENV)/.installed
	.ci/install $(PYTHON) $(VENV) constraints.txt test docs
	@touch $@

$(VENV)/.notebooks: $(VENV)/.installed
	.ci/install $(PYTHON) $(VENV) constraints.txt test notebooks
	@touch $@

# A first run from the wheel compiles nothing: it has the time step for common machines.
build/wheel/.built: $(CI)/3.11/.installed $(SOURCES) build/types/.linked
	rm -rf build/wheel build/lib
	PYTHONPATH=build/types $(CI)/3.11/bin/python tools/make_shipped_steps.py
	$(CI)/3.11/bin/python -m pip -qq wheel --no-deps --no-build-isolation -w build/wheel .
	@touch $@

# Not editable: what is tested is the wheel.
$(CI)/%/.wheel: $(CI)/%/.installed build/wheel/.built
	$(CI)/$*/bin/python -m pip -qq install --no-deps --no-index --force-reinstall build/wheel/*.whl
	@touch $@

$(CI)/3.11/.installed: $(INSTALL)
	.ci/install $(PYTHON) $(CI)/3.11 constraints.txt $(EVERY) audit
	@touch $@

$(CI)/3.11/.docs: $(CI)/3.11/.installed
	@touch $@

$(CI)/tools/.installed: .ci/release_tools.txt
	$(PYTHON) -m venv $(CI)/tools
	$(CI)/tools/bin/python -m pip --disable-pip-version-check -qq install -r .ci/release_tools.txt
	@touch $@

$(CI)/release/.installed: $(INSTALL)
	.ci/install $(PYTHON) $(CI)/release constraints.txt pytest
	@touch $@

$(CI)/platform/.installed: $(INSTALL)
	.ci/install $(PYTHON) $(CI)/platform constraints.txt test
	@touch $@

$(CI)/lowest/.installed: $(INSTALL) constraints-lowest.txt
	.ci/install $(PYTHON) $(CI)/lowest constraints-lowest.txt pytest
	@touch $@

$(CI)/%/.installed: $(INSTALL)
	.ci/install $$(.ci/python $*) $(CI)/$* constraints.txt $(if $(filter 3.12,$*),pytest mpi,test)
	@touch $@

# An editable install hides the namespace from mypy, so it is shown a tree of links with the same shape.
build/types/.linked: Makefile $(wildcard top/*.py)
	mkdir -p build/types/duhamel
	for package in $(PACKAGES); do ln -sfn ../../../$$package build/types/duhamel/$$package; done
	ln -sfn $(patsubst %,../../../%,$(wildcard top/*)) build/types/duhamel
	@touch $@
