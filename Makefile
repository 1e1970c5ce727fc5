# Everything runs in .venv, made here from PYTHON; no environment needs to be activated.
PYTHON ?= python3

VENV := .venv
BIN := $(VENV)/bin
PY := $(BIN)/python
MADE := $(VENV)/.made
DEV := $(VENV)/.dev
# maturin puts the extension beside the Python sources: it is its own time stamp.
CORE := python/runway_modal/_core.abi3.so
BENCHES := long_profile one_mat direct_integration sweep ensemble monte_carlo memory
SOURCES := Cargo.toml Cargo.lock pyproject.toml $(shell find rust -name '*.rs')

# Writes what users need as constraints: "numpy>=1.26" as "numpy==1.26.*".
define LEAST
import tomllib
project = tomllib.load(open("pyproject.toml", "rb"))["project"]
extras = [project["optional-dependencies"][name] for name in ("plot", "taxi", "tables", "cli", "dask")]
for need in sum(extras, project["dependencies"]):
    print(need.replace(">=", "==") + ".*")
endef
export LEAST

# maturin and pyo3 must see this environment and no other.
export VIRTUAL_ENV := $(CURDIR)/$(VENV)
export PYO3_PYTHON := $(CURDIR)/$(PY)
export PATH := $(CURDIR)/$(BIN):$(PATH)
unexport CONDA_PREFIX PYTHONHOME PYTHONPATH

export PIP_QUIET := 1
export PIP_DISABLE_PIP_VERSION_CHECK := 1

# Figures are drawn to files.
export MPLBACKEND := Agg

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
MAKEFLAGS += --no-builtin-rules
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
.PHONY: help demo test fmt lint lint-rust lint-python test-rust test-python bench bench-smoke \
	same-bits accuracy slow oldest clean toolchain linters

help: ## this list
	@awk -F '## ' '/^[a-z-]+:.*## / { split($$1, target, ":"); printf "  make %-13s %s\n", target[1], $$2 }' Makefile

demo: $(CORE) ## the report's aircraft over the full mat: tables and a figure
	$(PY) -m runway_modal.report1980

test: ## everything CI runs
	@$(MAKE) --no-print-directory lint
	@$(MAKE) --no-print-directory test-rust
	@$(MAKE) --no-print-directory bench-smoke
	@$(MAKE) --no-print-directory test-python

fmt: $(DEV) linters ## format all sources
	cargo fmt
	$(BIN)/ruff check --fix-only --quiet .
	$(BIN)/ruff format .

lint: lint-python lint-rust ## formatting, lints, types, stubs, documentation

lint-python: $(DEV)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy --strict
	$(PY) -m mypy.stubtest runway_modal._core

lint-rust: $(MADE) linters
	cargo fmt --check
	cargo clippy --quiet --locked --all-targets -- -D warnings
	cargo clippy --quiet --locked --all-targets --all-features -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --quiet --locked --no-deps

# Without the feature `python`: the core stands alone.
test-rust: toolchain ## the core's tests, without Python
	cargo test --quiet --locked

test-python: $(DEV) ## examples in docstrings, then the tests
	$(BIN)/pytest --quiet --doctest-modules python/runway_modal
	$(BIN)/pytest

# Tests named so hold the code that chooses its vectors when it runs against plain code, and both
# against bits written down. Then all of the core is built for machines that have wider vectors.
same-bits: toolchain ## the same bits from SSE2, AVX2 and AVX-512, in optimised builds; minutes
	cargo test --quiet --locked --release --lib --test roughness --test ensemble same_bits
	@for level in v3:avx2 v4:avx512f; do \
		if grep -qw "$${level#*:}" /proc/cpuinfo; then \
			echo "built for x86-64-$${level%:*}:"; \
			RUSTFLAGS="-C target-cpu=x86-64-$${level%:*}" CARGO_TARGET_DIR=target/x86-64-$${level%:*} \
				cargo test --quiet --locked --release --lib --test roughness --test ensemble same_bits; \
		else echo "this machine has no $${level#*:}: not run"; fi; \
	done

bench: $(DEV) ## speed and memory, measured against peers; minutes
	cargo bench --locked
	for script in $(BENCHES); do $(PY) benches/$$script.py; done

bench-smoke: $(DEV) ## the same at tiny sizes: does it run?
	# Without the optimiser: what tests are built of serves here too.
	cargo test --quiet --locked --bench march -- '/1000$$|one mat'
	for script in $(BENCHES); do $(PY) -W error benches/$$script.py --quick; done

accuracy: $(DEV) ## table of errors against 40-digit arithmetic
	$(PY) tests/accuracy.py

slow: $(DEV) ## the tests that take minutes
	$(BIN)/pytest -m slow

# Old packages warn of their own dependencies.
oldest: $(DEV) ## the tests with the oldest packages that pyproject.toml allows; minutes
	$(PYTHON) -m venv --clear $(VENV)-oldest
	$(PY) -c "$$LEAST" > $(VENV)-oldest/constraints.txt
	rm -rf target/wheels
	$(BIN)/maturin build --release --locked --quiet --out target/wheels
	$(VENV)-oldest/bin/pip install -c $(VENV)-oldest/constraints.txt "$$(echo target/wheels/*.whl)[dev]"
	$(VENV)-oldest/bin/python -m pytest -o $$'filterwarnings=default\nerror:::runway_modal'

clean: ## remove all that was made
	rm -rf .venv $(VENV)-oldest target .pytest_cache .mypy_cache .ruff_cache .hypothesis $(CORE) full_mat.png
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

toolchain:
	@command -v cargo >/dev/null || { echo "error: no cargo; install Rust from https://rustup.rs" >&2; exit 1; }
	@command -v cc >/dev/null || { echo "error: no linker; apt install build-essential" >&2; exit 1; }
	@need=$$(sed -n 's/^rust-version = "1\.\([0-9]*\).*/\1/p' Cargo.toml); \
	have=$$(cargo --version | sed 's/^cargo 1\.\([0-9]*\).*/\1/'); \
	[[ $$have -ge $$need ]] || { echo "error: Rust 1.$$need or later needed, found 1.$$have; rustup update" >&2; exit 1; }

# Distributions and rustup's minimal profile leave these out.
linters: toolchain
	@{ cargo clippy --version && cargo fmt --version; } >/dev/null 2>&1 \
		|| { echo "error: no clippy or rustfmt; rustup component add clippy rustfmt" >&2; exit 1; }

# Names what is missing rather than failing half way.
$(MADE): | toolchain
	@command -v $(PYTHON) >/dev/null || { echo "error: no $(PYTHON); apt install python3" >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "error: Python 3.11 or later needed, found $$($(PYTHON) -V); set PYTHON=..." >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null \
		|| { echo "error: $(PYTHON) cannot make environments; apt install python3-venv" >&2; exit 1; }
	$(PYTHON) -m venv --clear $(VENV)
	@# The build tool at the version that pyproject.toml asks for.
	$(PY) -m pip install "$$($(PY) -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"])')"
	@touch $@

$(CORE): $(MADE) $(SOURCES)
	$(BIN)/maturin develop --release --locked --quiet --extras plot
	@touch $@

$(DEV): $(MADE) pyproject.toml | $(CORE)
	$(BIN)/maturin develop --release --locked --quiet --extras bench,dev,plot
	@touch $@ $(CORE)
