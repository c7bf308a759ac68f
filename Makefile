# make demo   set up .venv, run scenes/beam.txt, end with the path of the movie
# make test   set up .venv, run the tests
# make develop  set up .venv, build the plugin into the working tree: PYTHONPATH=python .venv/bin/python -m pytest tests/scene/test_units.py
# make smoke   build sdist and wheel, install the wheel into an empty environment, do there what a stranger does first (tests/smoke.py)
# make docs    the docs as a site: build/docs/index.html; notebooks are run, a warning is an error
# make soak   set up .venv, run the long form of the hard cases (all tests marked soak)
# make sanitize  set up .venv, build the plugin with sanitizers, run its tests and six scenes under them (tests/sanitize.py)
# make bench  set up .venv, measure all of docs/performance.md (six minutes; python bench/all.py --quick takes one)
# make bench-peers  set up .venv and .venv-peers, measure other programs on the same scenes (docs/performance.md)
# make clean  forget everything that was built
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Python compiles a module when it is first loaded, and keeps it; all modules of all libraries take as long as the demo itself.
PIP := $(BIN)/python -m pip install --quiet --no-compile
unexport PYTHONDONTWRITEBYTECODE
# Tests of pages, servers and ranks wait more than they compute: three at a time keep two processors busy.
WORKERS ?= 3
SOURCES := pyproject.toml CMakeLists.txt $(shell find plugin python -name '*.so' -prune -o -name __pycache__ -prune -o -type f -print)

.PHONY: demo lint test library docs smoke develop soak sanitize bench bench-peers setup tools clean
.DEFAULT_GOAL := demo

setup: $(VENV)/.installed

$(VENV)/.installed: $(SOURCES)
	@command -v $(firstword $(PYTHON)) >/dev/null || { echo "no $(PYTHON) found; try: make PYTHON=python3.11"; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { echo "Python >= 3.10 is needed, $(PYTHON) is $$($(PYTHON) -V); try: make PYTHON=python3.11"; exit 1; }
	@command -v c++ >/dev/null || { echo "a C++17 compiler is needed (Debian: apt install g++)"; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV) || { echo "no venv module (Debian: apt install python3-venv)"; exit 1; }
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(PIP) --group build
	rm -rf dist
	$(BIN)/python -m build --no-isolation >dist.log 2>&1 || { cat dist.log; exit 1; }
	$(PIP) dist/*.whl
	$(PIP) --force-reinstall --no-deps dist/*.whl
	rm dist.log
	@touch $@

# Libraries of tests, docs and measurements, which the demo does without.
tools: $(VENV)/.tools

$(VENV)/.tools: $(VENV)/.installed
	$(PIP) "$$(echo dist/*.whl)[test]"
	@touch $@

demo: setup
	$(BIN)/mdanim-lammps scenes/beam.txt --force

lint: tools $(VENV)/.linters
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/clang-format --dry-run --Werror $(shell find plugin tests/lab/plugin -name '*.cpp' -o -name '*.h')
	$(BIN)/mypy
	$(BIN)/python tests/english.py

$(VENV)/.linters: pyproject.toml $(VENV)/.tools
	$(PIP) --group lint
	@touch $@

# The test library compiles while pip fetches what tests need.
library: setup
	$(BIN)/python tests/lab/plugin_library.py

test: setup
	$(MAKE) --no-print-directory -j 2 tools library
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal

# The wheel is built from the sdist when .venv is set up; PYTHON=python3.13 makes the empty environment with another Python.
smoke: setup
	rm -rf build/smoke
	$(PYTHON) -m venv build/smoke
	build/smoke/bin/python -m pip install --quiet --no-compile dist/*.whl
	build/smoke/bin/python tests/smoke.py

docs: tools
	$(BIN)/python -m sphinx -b html -W --keep-going -d build/doctrees docs build/docs

# Ninja builds what has changed only. The file is renamed, as a process may have the old one loaded.
develop: tools
	$(BIN)/cmake -S . -B build/develop -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_MAKE_PROGRAM=$(CURDIR)/$(BIN)/ninja \
		-DPython_EXECUTABLE=$(CURDIR)/$(BIN)/python
	$(BIN)/cmake --build build/develop
	mkdir -p python/mdanim_lammps/plugin
	cp build/develop/mdanimplugin.so python/mdanim_lammps/plugin/mdanimplugin.so.tmp
	mv python/mdanim_lammps/plugin/mdanimplugin.so.tmp python/mdanim_lammps/plugin/mdanimplugin.so

soak: setup
	$(MAKE) --no-print-directory -j 2 tools library
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal -m soak

sanitize: tools
	PATH="$(abspath $(BIN)):$$PATH" $(BIN)/python tests/sanitize.py

bench: tools
	$(BIN)/python bench/all.py --write

bench-peers: tools .venv-peers/.installed
	$(BIN)/python bench/peers/all.py --write

# A peer that cannot be installed here is left out of it, and its row says so.
.venv-peers/.installed: bench/peers/requirements.txt
	test -x .venv-peers/bin/python || $(PYTHON) -m venv .venv-peers
	grep -v '^#' $< | while read -r line; do .venv-peers/bin/python -m pip install --quiet "$$line" || echo "not installed: $$line"; done
	@touch $@

clean:
	rm -rf $(VENV) .venv-peers build dist dist.log
