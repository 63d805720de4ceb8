PYTHON ?= python3
MAKE_VENV = $(PYTHON) -c 'import sys; v = sys.version_info[:2]; sys.exit(0 if (3, 11) <= v < (3, 14) else \
	"$(PYTHON) is Python %d.%d; name one from 3.11 to 3.13, as in: make run PYTHON=python3.12" % v)' && \
	$(PYTHON) -m venv
VENV := .venv
BIN := $(VENV)/bin

unexport PYTHONDONTWRITEBYTECODE  # hundreds of processes start in a test run, which else compile all they import

.PHONY: run test check lint docs kernels types page-types indices test-all behaviour fuzz test-real test-ros wheel wheel-of clean

run: $(VENV)/run.stamp  ## run the example mission and write its record page
	$(BIN)/teamformer run examples/warehouse.yaml --out out/

test: $(VENV)/dev.stamp lint  ## before every commit: three to four minutes on two cores
	$(MAKE) --jobs=2 --output-sync kernels types
	$(BIN)/pytest -q -n 2 -m "not thorough and not slow"

check: $(VENV)/dev.stamp lint  ## everything CI runs
	$(MAKE) --jobs=2 --output-sync kernels types indices
	$(BIN)/pytest -q -n 2 -m "not slow"

lint: $(VENV)/dev.stamp
	$(BIN)/ruff check src tests examples
	$(BIN)/ruff format --check src tests examples

docs: $(VENV)/docs.stamp  ## the site, in build/site; a link that leads nowhere is an error
	$(BIN)/ruff check docs/making
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build
	@echo "read it: $(BIN)/python -m http.server --directory build/site, then http://localhost:8000"

kernels: $(VENV)/dev.stamp  ## compiled once, before two processes of the suite would both compile them
	$(BIN)/python -m teamformer.cli.terminal.compiling --everything > /dev/null

types: $(VENV)/dev.stamp $(if $(shell command -v npm),page-types)
	$(BIN)/mypy

page-types: node_modules/stamp  ## the page's JavaScript, where there is npm
	node_modules/.bin/tsc

CHECKED := tests/world/test_planes.py tests/planning/search tests/planning/test_crews.py tests/planning/continuous/test_reactive.py
indices: $(VENV)/dev.stamp  ## every index of an array checked, as it runs
	NUMBA_BOUNDSCHECK=1 $(BIN)/pytest -q -n 0 -m "not thorough and not slow" $(CHECKED)

test-all: $(VENV)/dev.stamp  ## the long tests too
	$(BIN)/pytest -q -n 2

behaviour: $(VENV)/dev.stamp kernels  ## what must not change while code moves, in tests/behaviour/behaviour.txt
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python tests/behaviour/behaviour.py
	git diff --stat tests/behaviour/behaviour.txt

MINUTES ?= 10
fuzz: $(VENV)/dev.stamp kernels  ## other random examples of every property, for so many minutes
	$(BIN)/python tests/fuzz/fuzz.py $(MINUTES)

PYTHONS ?= $(foreach version,3.11 3.12 3.13,$(shell python$(version) -c 'import sys; print(sys.executable)' 2> /dev/null))
wheel:  ## one for each Python that is there, with compiled kernels, checked: a first run compiles nothing and is quick
	rm -rf dist build/kernels build/wheels
	test -n "$(PYTHONS)"  # no python3.11, python3.12 or python3.13 on the path: name some in PYTHONS
	for python in $(PYTHONS); do $(MAKE) wheel-of PYTHON=$$python || exit 1; done

WHEEL_BIN = build/wheels/$(notdir $(PYTHON))/bin
wheel-of:  ## the wheel of one PYTHON, built and tried in an environment of its own
	$(PYTHON) -m venv build/wheels/$(notdir $(PYTHON))
	$(WHEEL_BIN)/pip install --quiet .
	rm -rf build/kernels build/first-run src/teamformer/compiled
	PYTHONPATH=src NUMBA_CACHE_DIR=build/kernels NUMBA_CPU_NAME=x86-64-v3 NUMBA_CPU_FEATURES= \
		$(WHEEL_BIN)/python -m teamformer.cli.terminal.compiling --everything
	mkdir src/teamformer/compiled
	find build/kernels -name '*.nbc' ! -name 'inner.*' -exec mv {} src/teamformer/compiled/ ';'  # linked in
	$(WHEEL_BIN)/pip wheel --quiet --no-deps --wheel-dir build/wheel . ; \
		built=$$?; rm -r src/teamformer/compiled; exit $$built
	$(WHEEL_BIN)/pip install --quiet --no-deps --force-reinstall build/wheel/*.whl
	NUMBA_CACHE_DIR=build/first-run $(WHEEL_BIN)/python tests/first_run.py \
		$(WHEEL_BIN)/teamformer run examples/warehouse.yaml
	test -z "$$(find build/first-run -name '*.nbc')"
	$(WHEEL_BIN)/python -m zipfile --list build/wheel/*.whl | grep teamformer/py.typed
	mkdir -p dist
	mv build/wheel/*.whl dist/

test-real: $(VENV)/dev.stamp  ## processes, and vehicles of others where a broker and they are there
	$(BIN)/pytest -q tests/fleet/test_vda5050.py tests/fleet/test_commands.py

ROS := .venv-ros
test-ros: $(ROS)/stamp  ## bodies in ROS 2, by the real rclpy, in an environment of its own
	$(ROS)/bin/python -m pytest -q -n 0 tests/fleet/test_ros2.py

$(ROS)/stamp: pyproject.toml  # its packages re-execute every Python of their environment
	python3.11 -m venv $(ROS)
	$(ROS)/bin/pip install --quiet --editable '.[fleet]' pytest pytest-xdist hypothesis 'ros-rclpy[fastrtps]==9.1.2' \
		ros-geometry-msgs ros-nav-msgs ros-action-msgs 'ros-visualization-msgs==5.5.1' 'ros-test-msgs==2.3.0'
	touch $@

LIBRARIES := sed -n '/^dependencies/,/^]/s/^  \("[^"]*"\),/\1/p' pyproject.toml
$(VENV)/run.stamp: pyproject.toml  # ortools and onnxruntime come while kernels are compiled, which need neither
	$(MAKE_VENV) $(VENV)
	@echo "installing, and compiling beside it: about a minute in all ..."
	$(LIBRARIES) | grep -v '"o' | xargs $(BIN)/pip install --quiet --no-compile
	PYTHONPATH=src $(BIN)/python -m teamformer.cli.terminal.compiling --planner > $(VENV)/compiling.log 2>&1 & \
		trap "kill $$!" INT TERM; $(BIN)/pip install --quiet --no-compile --editable .
	touch $@

$(VENV)/dev.stamp: pyproject.toml  # bytecode as it is needed: most of it never is
	$(MAKE_VENV) $(VENV)
	$(BIN)/pip install --quiet --no-compile --editable '.[dev]'
	touch $@ $(VENV)/run.stamp

node_modules/stamp: package-lock.json
	npm ci --silent
	touch $@

$(VENV)/docs.stamp: pyproject.toml
	$(MAKE_VENV) $(VENV)
	$(BIN)/pip install --quiet --editable '.[docs]'
	touch $@ $(VENV)/run.stamp

clean:
	rm -rf $(VENV) $(ROS) node_modules out build dist
