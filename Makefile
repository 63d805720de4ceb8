PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: run test docs kernels types planes test-all fuzz test-real wheel clean

run: $(VENV)/run.stamp  ## run the example mission and write its replay page
	$(BIN)/teamformer run examples/warehouse.yaml --out out/

test: $(VENV)/dev.stamp  ## everything CI runs
	$(BIN)/ruff check src tests examples
	$(BIN)/ruff format --check src tests examples
	$(MAKE) --jobs=2 --output-sync kernels types planes
	$(BIN)/pytest -q -n 2 -m "not slow"

docs: $(VENV)/docs.stamp  ## the site, in build/site; a link that leads nowhere is an error
	$(BIN)/ruff check docs/making
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build
	@echo "read it: $(BIN)/python -m http.server --directory build/site, then http://localhost:8000"

kernels: $(VENV)/dev.stamp  ## compiled once, before two processes of the suite would both compile them
	$(BIN)/python -m teamformer.commands.compiling --everything > /dev/null

types: $(VENV)/dev.stamp
	$(BIN)/mypy

planes: $(VENV)/dev.stamp  ## every index checked, as it runs
	NUMBA_BOUNDSCHECK=1 $(BIN)/pytest -q -n 0 tests/sim/test_planes.py

test-all: $(VENV)/dev.stamp  ## the long tests too
	$(BIN)/pytest -q -n 2

MINUTES ?= 10
fuzz: $(VENV)/dev.stamp kernels  ## other random examples of every property, for so many minutes
	$(BIN)/python tests/fuzz/fuzz.py $(MINUTES)

wheel: $(VENV)/dev.stamp  ## one that brings compiled kernels, checked: a first run compiles nothing
	rm -rf build/kernels build/installed build/first-run src/teamformer/compiled dist
	NUMBA_CACHE_DIR=build/kernels NUMBA_CPU_NAME=x86-64-v3 NUMBA_CPU_FEATURES= \
		$(BIN)/python -m teamformer.commands.compiling --everything
	mkdir src/teamformer/compiled
	find build/kernels -name '*.nbc' ! -name 'inner.*' -exec mv {} src/teamformer/compiled/ ';'  # linked in
	$(BIN)/pip wheel --quiet --no-deps --wheel-dir dist . ; built=$$?; rm -r src/teamformer/compiled; exit $$built
	$(BIN)/pip install --quiet --no-deps --target build/installed dist/*.whl
	PYTHONPATH=build/installed NUMBA_CACHE_DIR=build/first-run \
		$(BIN)/python -m teamformer.cli run examples/warehouse.yaml
	test -z "$$(find build/first-run -name '*.nbc')"

test-real: $(VENV)/dev.stamp  ## processes, and vehicles of others where a broker and they are there
	$(BIN)/pytest -q tests/fleet/test_vda5050.py tests/fleet/test_commands.py

$(VENV)/run.stamp: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --editable .
	touch $@

$(VENV)/dev.stamp: pyproject.toml  # bytecode as it is needed: most of it never is
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --no-compile --editable '.[dev]'
	touch $@ $(VENV)/run.stamp

$(VENV)/docs.stamp: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --editable '.[docs]'
	touch $@ $(VENV)/run.stamp

clean:
	rm -rf $(VENV) out build dist
