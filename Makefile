PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: run test test-all clean

run: $(VENV)/run.stamp  ## run the example mission and write its replay page
	$(BIN)/teamformer run examples/warehouse.yaml --html --out out/

test: $(VENV)/dev.stamp  ## everything CI runs
	$(BIN)/ruff check src tests examples
	$(BIN)/ruff format --check src tests examples
	$(BIN)/mypy
	$(BIN)/pytest -q -n 2 -m "not slow"

test-all: $(VENV)/dev.stamp  ## the long tests too
	$(BIN)/pytest -q -n 2

$(VENV)/run.stamp: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --editable .
	touch $@

$(VENV)/dev.stamp: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --editable '.[dev]'
	touch $@ $(VENV)/run.stamp

clean:
	rm -rf $(VENV) out build dist
