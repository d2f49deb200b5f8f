# What a person types. Every target sets up what it needs by itself.
.DEFAULT_GOAL := help
.PHONY: help setup demo serve test check format bench reproduce clean

help: ## this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "make %-10s %s\n", $$1, $$2 }' Makefile

setup: ## make .venv with everything, also the tools of developers
	@scripts/setup dev

demo: ## start a service, solve the cart-pole over HTTP, write demo/report.html
	@scripts/setup run
	@.venv/bin/python scripts/demo.py

serve: ## keep a service running at 127.0.0.1:8000
	@scripts/setup run
	@.venv/bin/footfall serve

test: ## run all tests
	@scripts/setup dev
	@scripts/test

check: ## format, lint, types, imports, spelling
	@scripts/setup dev
	@scripts/check

format: ## format the code
	@scripts/setup dev
	@scripts/format

bench: ## measure speed, as ratios, in one run
	@scripts/setup dev
	@.venv/bin/python -m benchmarks

reproduce: ## solve the seeds' tables from nothing, write docs/reproduction.md
	@scripts/setup dev
	@.venv/bin/python -m benchmarks.reproduce

clean: ## remove .venv, caches and what was made
	@rm -rf .venv .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis demo
	@rm -rf *.egg-info sdk/*.egg-info build sdk/build
	@find . -name __pycache__ -type d -prune -exec rm -rf {} +
