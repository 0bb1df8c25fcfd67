# Everything a clone needs: `make demo` or `make test`, each alone, sets up .venv first.
# Variables: PYTHON=python3.12 (the interpreter of a new .venv), ARGS="-k groin" (passed on to pytest, the benchmarks, the fuzzer),
# FUZZ_MUTANTS=10000 (damaged files that `make fuzz` reads of each format).

SUPPORTED := import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))
PYTHON ?= $(shell for p in python3 python3.11 python3.12 python3.13; do \
	"$$p" -c '$(SUPPORTED)' 2>/dev/null && echo "$$p" && break; done)
BIN := .venv/bin
# Set to nothing to run the tests in one process, where they can be debugged.
WORKERS ?= -n 2 --dist worksteal

# Byte code is what makes the second start quick.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help install tools demo test check compiled format bench fuzz handbook lock clean

help:
	@echo 'make demo     fit the scan examples/room.laz: demo/groin'
	@echo 'make test     style, types, imports, then the tests  (ARGS="-k groin" for some of them)'
	@echo 'make check    style, types and imports alone'
	@echo 'make format   put the code in order'
	@echo 'make bench    the benchmarks'
	@echo 'make fuzz     the tests that make up their own bad input'
	@echo 'make handbook what docs/families.md and the README say of the families, anew from their declarations'
	@echo 'make install  set up .venv for fits alone  (PYTHON=python3.12 picks the interpreter)'
	@echo 'make tools    set up .venv with the extras and the tools of the tests, too'
	@echo 'make lock     requirements.lock and requirements-dev.lock anew from pyproject.toml (needs uv)'
	@echo 'make clean    remove .venv, caches and the demo'

install: .venv/project.stamp

# What a fit needs is enough for the demo; all else needs the extras and the tools, too.
tools: .venv/tools.stamp install

demo: install
	$(BIN)/vaultcad fit examples/room.laz -o demo/groin
	@echo 'Open demo/groin/report.html in a browser, model.ifc or model.step in CAD or BIM, segments.laz in CloudCompare.'

# What is compiled takes as long as mypy does, each on a core of its own.
test: tools
	@$(MAKE) --no-print-directory -j 2 check compiled
	$(BIN)/python -m pytest $(WORKERS) $(ARGS)

# Each of the tests' workers would compile it for itself.
compiled: tools
	$(BIN)/python -m tools.compiled

check: tools
	$(BIN)/python -m ruff check
	$(BIN)/python -m ruff format --check
	$(BIN)/python -m mypy
	$(BIN)/lint-imports

format: tools
	$(BIN)/python -m ruff check --fix
	$(BIN)/python -m ruff format

bench: tools
	$(BIN)/python -m bench $(ARGS)

fuzz: tools
	$(BIN)/python -m pytest fuzz $(ARGS)

handbook: tools
	$(BIN)/python -m tools.handbook

# No --upgrade: what the locks hold already stays as it is. build123d asks for OCP without VTK, cadquery for OCP with it;
# both write the package `OCP`, and where both would be, only the one with VTK serves both.
COMPILE := uv pip compile pyproject.toml --universal --python-version 3.11 --generate-hashes \
	--no-emit-index-url --no-emit-find-links --no-annotate --no-header --quiet
lock:
	@command -v uv >/dev/null || { echo 'make lock needs uv: python3 -m pip install uv' >&2; exit 1; }
	$(COMPILE) --extra build -o requirements.lock
	echo "cadquery-ocp-novtk ; sys_platform == 'never'" | \
		$(COMPILE) --extra dev --overrides - --constraints requirements.lock -o requirements-dev.lock

clean:
	rm -rf .venv demo build *.egg-info .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# compileall may warn and fail: some packages ship templates that are no Python.
define set_up
	@"$(PYTHON)" -c '$(SUPPORTED)' 2>/dev/null || { echo 'vaultcad needs Python 3.11, 3.12 or 3.13: make PYTHON=/path/to/python3' >&2; exit 1; }
	@"$(PYTHON)" tools/system.py
	@$(BIN)/python -m pip --version >/dev/null 2>&1 || "$(PYTHON)" -m venv --clear .venv
	@echo 'Installing what $(1) names into .venv: some minutes, $(2)'
	@$(if $(3),$(BIN)/python -m pip uninstall --quiet --quiet --yes $(3))
	@$(BIN)/python -m pip install --quiet --no-input --disable-pip-version-check --no-compile --only-binary :all: \
		--no-deps --require-hashes -r $(1)
	@PYTHONWARNINGS=ignore $(BIN)/python -m compileall -qq -j 0 .venv/lib || true
	@touch .venv/packages.stamp
endef

# An environment that has the extras keeps them: OCP without VTK would overwrite the one with it.
EXTRAS = $(wildcard .venv/lib/*/site-packages/cadquery_ocp-[0-9]*.dist-info)
.venv/packages.stamp: requirements.lock
	$(if $(EXTRAS),$(call set_up,requirements-dev.lock,3.6 GB),$(call set_up,requirements.lock,1.5 GB))

.venv/tools.stamp: requirements-dev.lock
	$(call set_up,requirements-dev.lock,3.6 GB,cadquery-ocp-novtk)
	@touch $@

.venv/project.stamp: pyproject.toml .venv/packages.stamp
	@$(BIN)/python -m pip install --quiet --no-input --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@
