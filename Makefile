# make demo   set up .venv, run scenes/beam.txt, end with the path of the movie
# make test   set up .venv, run the tests
# make soak   set up .venv, run the long form of the hard cases (tests/stability, test_ranks.py)
# make clean  forget everything that was built
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SOURCES := pyproject.toml CMakeLists.txt $(shell find plugin python -name '*.so' -prune -o -name __pycache__ -prune -o -type f -print)

.PHONY: demo test soak setup clean
.DEFAULT_GOAL := demo

setup: $(VENV)/.installed

$(VENV)/.installed: $(SOURCES)
	@command -v $(firstword $(PYTHON)) >/dev/null || { echo "no $(PYTHON) found; try: make PYTHON=python3.11"; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || { echo "Python >= 3.10 is needed, $(PYTHON) is $$($(PYTHON) -V); try: make PYTHON=python3.11"; exit 1; }
	@command -v c++ >/dev/null || { echo "a C++17 compiler is needed (Debian: apt install g++)"; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV) || { echo "no venv module (Debian: apt install python3-venv)"; exit 1; }
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet '.[test]'
	@touch $@

demo: setup
	$(BIN)/mdanim-lammps scenes/beam.txt --force

test: setup
	$(BIN)/python -m pytest -n 2 --dist loadfile

soak: setup
	$(BIN)/python -m pytest -n 2 -m soak tests/stability tests/test_ranks.py

clean:
	rm -rf $(VENV) build dist
