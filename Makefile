# Everything runs in .venv, made from constraints.txt; `make demo` and `make test` need nothing done before.
PYTHON ?= python3
BIN := .venv/bin
BASE := .venv/.kouros-runs
STAMP := .venv/.kouros-installed
PEERS := .venv/.kouros-peers
# Three, for browsers, servers and nights that are waited for leave a fifth of two cores idle.
BOTH_CORES := $(BIN)/python -m pytest --numprocesses 3 --dist loadfile --no-loadscope-reorder

.PHONY: demo test test-long lint rules types ready docs catalogues bench soak audit airflow check-browser clean

INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt

# What a museum installs. The demonstration needs no more, and who only looks at that does not wait for what tests need.
$(BASE): pyproject.toml constraints.txt
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv || { echo "python3 has no venv module: apt-get install python3-venv"; exit 1; }
	$(INSTALL) --editable .
	@touch $(BASE)

$(STAMP): $(BASE)
	$(INSTALL) --editable '.[dev,docs]'
	@touch $(STAMP)

# One by one: a peer that has no wheel for this machine is left out, and the benchmark says so.
$(PEERS): $(STAMP)
	@$(BIN)/python -c "import tomllib; from pathlib import Path; \
	print(*tomllib.loads(Path('pyproject.toml').read_text())['project']['optional-dependencies']['peers'], sep='\n')" | \
	while read -r peer; do \
	  $(INSTALL) "$$peer" || \
	  echo "$$peer cannot be installed here"; done
	@touch $(PEERS)

demo: $(BASE)  ## the whole job on the bundled collection and record; ends with the path of the report
	$(BIN)/kouros demo

test: $(STAMP) check-browser  ## lint, types, floors and every test but those that are long and show what others show
	@$(MAKE) --no-print-directory --jobs 2 ready types rules
	$(BOTH_CORES) -m "not long"

# They say themselves which test of `make test` shows the same: tests/test_long.py.
test-long: $(STAMP) check-browser  ## the tests that `make test` leaves out
	$(BOTH_CORES) -m long

# Types are checked on one core while rules and floors are on the other.
lint: $(STAMP)
	@$(MAKE) --no-print-directory --jobs 2 rules types

rules: $(STAMP)
	$(BIN)/ruff format --check pipeline schemas tests examples docs .ci
	$(BIN)/ruff check pipeline schemas tests examples docs .ci
	$(BIN)/bandit --quiet --configfile pyproject.toml --recursive pipeline schemas
	$(BIN)/lint-imports

types: $(STAMP)
	$(BIN)/mypy

# What all workers of the tests would else make at once: it takes as long as types and rules, which the other core checks.
ready: $(STAMP)
	@PYTHONDONTWRITEBYTECODE= $(BIN)/python -m tests.ready

# Offline; a broken link, a page that no table of contents names and an unreadable docstring are errors.
docs: $(STAMP)  ## the documentation, in build/docs
	$(BIN)/python -m docs.rooms
	$(BIN)/python -m sphinx -W --keep-going -q -b html -d build/doctrees docs build/docs
	@echo "build/docs/index.html"

catalogues: $(STAMP)  ## the languages that travel with Kouros get new phrases, to be translated, and lose old ones
	$(BIN)/python -m docs.catalogues

bench: $(PEERS)  ## costs beside peers and beside C, ns per object and sample of each model, the stages of a night
	$(BIN)/python -m tests.benchmarks

soak: $(STAMP)  ## what is too long for every day: readers fed damaged files for two minutes each, fifty nights killed, every call disturbed, two hundred museums changed eight times, every seed and every row that means harm, all tests, the long ones too, with all of their samples, the image built and run
	KOUROS_FUZZ_SECONDS=120 $(BIN)/python -m pytest --numprocesses 2 tests/motions/formats/test_fuzz.py -k damage
	KOUROS_KILLS=50 $(BIN)/python -m pytest --numprocesses 2 tests/operations/test_interruptions.py -k kill
	KOUROS_DAMAGES=1000 $(BIN)/python -m pytest tests/operations/test_damage.py
	KOUROS_CALLS=1 $(BIN)/python -m pytest -s tests/operations/test_every_call.py
	KOUROS_OBJECTS=8 $(BIN)/python -m pytest tests/night/test_faults.py
	KOUROS_SEQUENCES=200 $(BIN)/python -m pytest --numprocesses 2 tests/night/test_incremental.py
	KOUROS_GRID=1 $(BIN)/python -m pytest tests/models/test_bounded_work.py
	KOUROS_ROWS=40 $(BIN)/python -m pytest --numprocesses 2 tests/models/test_error_estimate.py
	KOUROS_DRAWS=160 $(BIN)/python -m pytest tests/analysis/test_likelihood.py -k plain_monte_carlo
	KOUROS_SEEDS=24 $(BIN)/python -m pytest tests/collection/test_known_rows.py tests/report/test_damaged_reports.py
	KOUROS_HOSTILE=1000 $(BIN)/python -m pytest tests/security/test_hostile_collection.py
	KOUROS_SOAK=1 $(BOTH_CORES)
	KOUROS_IMAGE=1 $(BIN)/python -m pytest -s tests/operations/test_containers.py

# In environments of their own: what audits and what schedules must not decide which versions Kouros is tested with.
audit:  ## known vulnerabilities of the pinned versions; needs the network, and says so and fails where it has none
	@test -x .venv-audit/bin/pip-audit || { $(PYTHON) -m venv .venv-audit && \
	  .venv-audit/bin/pip install --quiet --disable-pip-version-check pip-audit; } || \
	  { echo "audit: NOT AUDITED: pip-audit cannot be installed here"; exit 75; }
	@.venv-audit/bin/python .ci/audit.py

airflow: $(STAMP)  ## the example for Airflow in Airflow itself
	@test -x .venv-airflow/bin/airflow || { $(PYTHON) -m venv .venv-airflow && \
	  .venv-airflow/bin/pip install --quiet --disable-pip-version-check 'apache-airflow>=3,<4'; }
	KOUROS_AIRFLOW=$(CURDIR)/.venv-airflow/bin/python $(BIN)/python -m pytest tests/operations/test_examples.py -k airflow

# The browser tests need Chromium and its driver; where they are missing they come from Debian's packages.
check-browser:
	@command -v chromium >/dev/null && command -v chromedriver >/dev/null || \
	{ echo "bringing Chromium from Debian's packages"; \
	  SUDO=$$([ "$$(id -u)" = 0 ] || echo sudo); \
	  $$SUDO apt-get update -qq && $$SUDO apt-get install -y -qq chromium chromium-driver >/dev/null; } || \
	{ echo "the browser tests need chromium and chromium-driver: install both"; exit 1; }

clean:
	rm -rf .venv kouros-demo build docs/reference/generated dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
