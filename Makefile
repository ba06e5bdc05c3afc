# make run    the main scenario            make test    everything CI checks
# make compiled  the emulator as a library (make run does it)    make both  the fast tests on it    make wheels
# make bench  speed figures (JSON in out/) make paper   the paper's experiments
# make blind  the blind tests (about an hour, resumable)    make fit  repeat the parameter search
# make docs   the documentation in out/site     make coverage  lines the fast tests never execute, by room
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
FIRST := $(VENV)/.first
READY := $(VENV)/.ready
# Versions that are known to work together. make CONSTRAINTS= takes the newest ones.
CONSTRAINTS ?= -c constraints.txt
INSTALL := PYTHONWARNINGS=ignore $(BIN)/python -m pip install --quiet --no-build-isolation $(CONSTRAINTS)
WORKERS ?= $(shell $(PYTHON) -c "import os; print(min(4, os.cpu_count() or 1))")

.PHONY: run compiled wheels both test fast slow long guest lint paper bench blind fit docs coverage clean

# A short night first, on a fresh machine: judged before anything is compiled.
run: $(VENV)/.night
	@$(MAKE) --no-print-directory compiled
	$(BIN)/schmidt run scenarios/observing-night.yaml --out out/observing-night
	$(BIN)/schmidt run scenarios/observing-night.yaml --firmware fine --out out/observing-night-fine

# The same source as a library, where there is a C compiler; says in one line where there is none.
compiled: $(READY)
	@$(BIN)/python -m scenarios.native

# dist/: the wheel of this platform (manylinux where auditwheel can tell) and the pure one
wheels: $(VENV)/.wheels
	rm -rf out/wheels
	SCHMIDT_PURE=1 $(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir out/wheels .
	SCHMIDT_PURE= $(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir out/wheels .
	mkdir -p dist
	cp out/wheels/*.whl dist
	-PATH="$(CURDIR)/$(BIN):$$PATH" auditwheel repair --wheel-dir dist out/wheels/*linux*.whl && rm dist/*-linux_*.whl
	@ls dist/*.whl; test $$(ls out/wheels/*.whl | wc -l) = 2 || (echo "schmidt: the compiled wheel is missing" && false)

test: lint fast slow

# The fast suite on the compiled library (it runs plain otherwise, which is what a debugger sees). The finder is
# not in it.
both: compiled
	SCHMIDT_PURE=0 $(BIN)/python -m pytest -n $(WORKERS) --dist loadgroup -m "not slow and not long and not guest" \
		--ignore tests/calibration --ignore tests/blind --ignore tests/measured

fast: $(READY)
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadgroup -m "not slow and not long and not guest"

slow: $(READY)
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadgroup -m "slow and not long and not guest"

# Minutes of an idle core each: the finder on many logs, the paper's table, a cluster of workers. Not in CI.
long: $(VENV)/.cluster
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadgroup -m "long"

# In a Linux guest with vcan, under emulation; skips with a message where qemu is not installed.
guest: $(READY)
	$(BIN)/python -m pytest -rs -m guest

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m docs.generate --check

paper: $(READY)
	$(BIN)/schmidt paper --out out/paper --json out/paper/paper.json

bench: $(VENV)/.bench
	mkdir -p out
	$(BIN)/python -m tests.benchmarks --json out/bench.json --history out/bench-history.jsonl
	$(BIN)/python -m tests.benchmarks.calibration --json out/bench-calibration.json

blind: $(READY)
	$(BIN)/python -m tests.blind --out out/blind

fit: $(READY)
	$(BIN)/python -m tests.studies.paper.search --out out/fit --jobs $(WORKERS)

# Strict: a dead link, or a page outside the navigation, fails. Prints the pages with the longest sentences. Needs no network once its packages are there.
docs: $(VENV)/.docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	@$(BIN)/python -m tests.docs.language
	@$(BIN)/python -m tests.docs.wording
	@echo "out/site/index.html; with search: $(BIN)/python -m http.server --directory out/site"

coverage: $(VENV)/.coverage
	mkdir -p out
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadgroup -m "not slow and not long and not guest" --cov --cov-report=
	$(BIN)/python -m tests.coverage

clean:
	rm -rf $(VENV) out build dist scenarios/native/library plant/library *.egg-info

# What a judged night needs, then everything.
$(FIRST): pyproject.toml constraints.txt
	@$(PYTHON) -c "import sys; sys.exit('schmidt needs Python 3.11 or newer; this is ' + sys.version.split()[0] + '. Try: make PYTHON=python3.11') if sys.version_info < (3, 11) else None"
	@echo "1 of 2: installing what a night needs, half a minute with packages at hand"
	@$(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --upgrade pip "setuptools>=70.1"
	@$(INSTALL) -e ".[parquet,plots]"
	@touch $@

$(VENV)/.night: | $(FIRST)
	$(BIN)/schmidt run quick-look --out out/first-night
	@touch $@

$(READY): $(FIRST)
	@echo "2 of 2: installing the rest, half a minute with packages at hand"
	@$(INSTALL) -e ".[all,test]"
	@touch $@

$(VENV)/.cluster: $(READY)
	$(INSTALL) -e ".[all,test,cluster]"
	touch $@

$(VENV)/.wheels: $(READY)
	$(INSTALL) -e '.[all,test,wheels]'
	@touch $@

$(VENV)/.bench: $(READY)
	$(INSTALL) -e ".[all,test,bench]"
	touch $@

$(VENV)/.docs: $(READY)
	$(INSTALL) -e ".[all,docs]"
	@touch $@

$(VENV)/.coverage: $(READY)
	$(INSTALL) -e ".[all,test,coverage]"
	@touch $@
