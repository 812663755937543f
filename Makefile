# VASO: `make` lists the targets, `make demo` is the shortest way from a clone to a checked skill.
BIN := .venv/bin
UV = $(shell command -v uv || echo .tools/bin/uv)
REALTIME := tests/modules/robots
SETUP_NEEDS := pyproject.toml uv.lock scripts/setup.sh $(wildcard third_party/pynusmv/*.*)

.PHONY: help setup everything demo test test-slow notebooks lint format bench lock clean

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /\1|/p' $(MAKEFILE_LIST) | awk -F'|' '{printf "  %-10s %s\n", $$1, $$2}'

setup: .venv/.ready ## install into .venv (bootstraps uv, builds PyNuSMV once)

.venv/.ready: $(SETUP_NEEDS)
	@bash scripts/setup.sh
	@touch $@

everything: .venv/.everything ## also install all optimizers, notebooks, and what the tests need

.venv/.everything: .venv/.ready
	@bash scripts/setup.sh everything
	@touch $@

demo: setup ## verify and optimize a skill, offline; in under a minute once set up
	@$(BIN)/vaso demo

test: everything ## the fast tests; those of robots, which measure times, by themselves
	$(BIN)/pytest -n 2 --ignore=$(REALTIME)
	$(BIN)/pytest $(REALTIME) || $(BIN)/pytest $(REALTIME) --last-failed # once more: machines stall

test-slow: everything ## the slow tests: long differential runs, builds, time-outs
	$(BIN)/pytest -m slow

notebooks: everything ## run the notebooks, and compare their outputs with the committed ones
	$(BIN)/python scripts/notebooks.py

lint: everything ## ruff, formatting, types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: everything ## rewrite files the way `make lint` wants them
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: setup ## regenerate the benchmark tables
	$(BIN)/vaso bench

lock: ## resolve dependencies again after editing pyproject.toml
	$(UV) lock

clean: ## remove what was built here (the PyNuSMV build cache stays in ~/.cache/vaso)
	rm -rf .venv .tools build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
