# Everything here does its own set-up: a Python 3.11 or newer with pip is all that is needed.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# A file of tests stays together: its numbers are worked out once.
TWO_CORES := -n 2 --dist loadfile

.PHONY: demo test test-all lint kernels bench docs clean

demo: $(VENV)/run
	$(BIN)/spheredrive demo

test: $(VENV)/dev lint kernels
	$(BIN)/python -m pytest $(TWO_CORES) -m "not long"

test-all: $(VENV)/dev lint kernels
	$(BIN)/python -m pytest $(TWO_CORES)

# What the tests run is compiled once, on both cores, and kept on disk.
kernels: $(VENV)/dev
	$(BIN)/python tests/compile_kernels.py

lint: $(VENV)/dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

bench: $(VENV)/dev
	$(BIN)/python benchmarks/kinematics.py
	$(BIN)/python benchmarks/rolling.py
	$(BIN)/python benchmarks/vibration.py
	$(BIN)/python benchmarks/compliant.py
	$(BIN)/python benchmarks/studies.py

docs: $(VENV)/docs
	MPLBACKEND=Agg $(BIN)/python -m sphinx -W --keep-going -q -b html -d docs/_build/doctrees docs docs/_build/html

# The stamps are renewed when the list of dependencies changes.
$(VENV)/run: pyproject.toml constraints.txt
	$(PYTHON) -c "import sys; sys.exit('spheredrive needs Python 3.11 or newer' if sys.version_info < (3, 11) else 0)"
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --constraint constraints.txt --editable .
	touch $@

# The browser that the app is tested in is Debian's; elsewhere, or where it cannot be installed, its tests say so.
$(VENV)/dev: pyproject.toml constraints.txt
	$(PYTHON) -c "import sys; sys.exit('spheredrive needs Python 3.11 or newer' if sys.version_info < (3, 11) else 0)"
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --constraint constraints.txt --editable ".[dev]"
	command -v chromium > /dev/null || (apt-get update -qq && apt-get install -qq -y --no-install-recommends chromium) || true
	touch $(VENV)/run $@

$(VENV)/docs: $(VENV)/dev
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --constraint constraints.txt --editable ".[docs]"
	touch $@

clean:
	rm -rf $(VENV) .pytest_cache .ruff_cache .hypothesis dist docs/_build docs/gallery
	find src tests -name __pycache__ -type d -prune -exec rm -rf {} +
