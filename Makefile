# make run    the main scenario            make test    everything CI checks
# make bench  speed figures (JSON in out/) make paper   the paper's experiments
# make blind  the blind tests (about an hour, resumable)    make fit  repeat the parameter search
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
WORKERS ?= $(shell $(PYTHON) -c "import os; print(min(4, os.cpu_count() or 1))")

.PHONY: run test fast slow guest lint paper bench blind fit clean

run: $(READY)
	$(BIN)/schmidt run scenarios/observing-night.yaml --out out/observing-night

test: lint fast slow

fast: $(READY)
	$(BIN)/python -m pytest -n $(WORKERS) -m "not slow and not guest"

slow: $(READY)
	$(BIN)/python -m pytest -n $(WORKERS) -m "slow and not guest"

# In a Linux guest with vcan, under emulation; skips with a message where qemu is not installed.
guest: $(READY)
	$(BIN)/python -m pytest -rs -m guest

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m bus.protocol.page --check

paper: $(READY)
	$(BIN)/schmidt paper --out out/paper --json out/paper/paper.json

bench: $(VENV)/.bench
	mkdir -p out
	$(BIN)/python -m scenarios.bench --json out/bench.json
	$(BIN)/python -m tests.benchmarks.calibration --json out/bench-calibration.json

blind: $(READY)
	$(BIN)/python -m tests.blind --out out/blind

fit: $(READY)
	$(BIN)/python -m scenarios.paper.search --out out/fit

clean:
	rm -rf $(VENV) out build *.egg-info

$(READY): pyproject.toml
	$(PYTHON) -c "import sys; sys.exit('schmidt needs Python 3.11 or newer; this is ' + sys.version.split()[0] + '. Try: make PYTHON=python3.11') if sys.version_info < (3, 11) else None"
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet -e ".[test]"
	touch $@

$(VENV)/.bench: $(READY)
	$(BIN)/python -m pip install --quiet -e ".[test,bench]"
	touch $@
