# Everything runs in .venv, made from constraints.txt; `make demo` and `make test` need nothing done before.
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.kouros-installed
PEERS := .venv/.kouros-peers

.PHONY: demo test lint bench soak check-browser clean

$(STAMP): pyproject.toml constraints.txt
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv || { echo "python3 has no venv module: apt-get install python3-venv"; exit 1; }
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev]'
	@touch $(STAMP)

# One by one: a peer that has no wheel for this machine is left out, and the benchmark says so.
$(PEERS): $(STAMP)
	@$(BIN)/python -c "import tomllib; from pathlib import Path; \
	print(*tomllib.loads(Path('pyproject.toml').read_text())['project']['optional-dependencies']['peers'], sep='\n')" | \
	while read -r peer; do \
	  $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt "$$peer" || \
	  echo "$$peer cannot be installed here"; done
	@touch $(PEERS)

demo: $(STAMP)  ## the whole job on the bundled collection and record; ends with the path of the report
	$(BIN)/kouros demo

test: $(STAMP) lint check-browser  ## lint, types, floors and all tests
	$(BIN)/python -m pytest --numprocesses 2 --dist loadfile

lint: $(STAMP)
	$(BIN)/ruff format --check pipeline schemas tests
	$(BIN)/ruff check pipeline schemas tests
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(PEERS)  ## costs beside peers and beside C, ns per object and sample of each model, the stages of a night
	$(BIN)/python -m tests.benchmarks

soak: $(STAMP)  ## what is too long for every day: each reader of records fed damaged files for two minutes
	KOUROS_FUZZ_SECONDS=120 $(BIN)/python -m pytest --numprocesses 2 tests/motions/formats/test_fuzz.py -k damage

# The browser tests need Chromium and its driver; where they are missing they come from Debian's packages.
check-browser:
	@command -v chromium >/dev/null && command -v chromedriver >/dev/null || \
	{ echo "bringing Chromium from Debian's packages"; \
	  SUDO=$$([ "$$(id -u)" = 0 ] || echo sudo); \
	  $$SUDO apt-get update -qq && $$SUDO apt-get install -y -qq chromium chromium-driver >/dev/null; } || \
	{ echo "the browser tests need chromium and chromium-driver: install both"; exit 1; }

clean:
	rm -rf .venv kouros-demo build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
