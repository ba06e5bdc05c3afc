# make run    the main scenario            make test    everything CI checks
# make compiled  the emulator as a library (make run does it)    make both  the fast tests on it    make wheels
# make bench  speed figures (JSON in out/) make paper   the paper's experiments
# make blind  the blind tests (about an hour, resumable)    make fit  repeat the parameter search
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
WORKERS ?= $(shell $(PYTHON) -c "import os; print(min(4, os.cpu_count() or 1))")

.PHONY: run compiled wheels both test fast slow long guest lint paper bench blind fit clean

run: $(READY) compiled
	$(BIN)/schmidt run scenarios/observing-night.yaml --out out/observing-night
	$(BIN)/schmidt run scenarios/observing-night.yaml --firmware fine --out out/observing-night-fine

# The same source as a library, where there is a C compiler; says in one line where there is none.
compiled: $(READY)
	@$(BIN)/python -m scenarios.native

# dist/: the wheel of this platform (manylinux where auditwheel can tell) and the pure one
wheels: $(VENV)/.wheels
	$(BIN)/python -m scenarios.native.wheels

test: lint fast slow

# The fast suite on the compiled library (it runs plain otherwise, which is what a debugger sees).
both: compiled
	SCHMIDT_PURE=0 $(BIN)/python -m pytest -n $(WORKERS) -m "not slow and not long and not guest"

fast: $(READY)
	$(BIN)/python -m pytest -n $(WORKERS) -m "not slow and not long and not guest"

slow: $(READY)
	$(BIN)/python -m pytest -n $(WORKERS) -m "slow and not long and not guest"

# Minutes of an idle core each: the finder on many logs, the paper's table, a cluster of workers. Not in CI.
long: $(VENV)/.cluster
	$(BIN)/python -m pytest -n $(WORKERS) -m "long"

# In a Linux guest with vcan, under emulation; skips with a message where qemu is not installed.
guest: $(READY)
	$(BIN)/python -m pytest -rs -m guest

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m bus.protocol.page --check
	$(BIN)/python -m scenarios.faults.page --check

paper: $(READY)
	$(BIN)/schmidt paper --out out/paper --json out/paper/paper.json

bench: $(VENV)/.bench
	mkdir -p out
	$(BIN)/python -m scenarios.bench --json out/bench.json --history out/bench-history.jsonl
	$(BIN)/python -m tests.benchmarks.calibration --json out/bench-calibration.json

blind: $(READY)
	$(BIN)/python -m tests.blind --out out/blind

fit: $(READY)
	$(BIN)/python -m scenarios.paper.search --out out/fit --jobs $(WORKERS)

clean:
	rm -rf $(VENV) out build dist scenarios/native/library plant/library *.egg-info

$(READY): pyproject.toml
	$(PYTHON) -c "import sys; sys.exit('schmidt needs Python 3.11 or newer; this is ' + sys.version.split()[0] + '. Try: make PYTHON=python3.11') if sys.version_info < (3, 11) else None"
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet -e ".[test]"
	touch $@

$(VENV)/.cluster: $(READY)
	$(BIN)/python -m pip install --quiet -e ".[test,cluster]"
	touch $@

$(VENV)/.wheels: $(READY)
	$(BIN)/pip install --quiet -e '.[test,wheels]'
	@touch $@

$(VENV)/.bench: $(READY)
	$(BIN)/python -m pip install --quiet -e ".[test,bench]"
	touch $@
