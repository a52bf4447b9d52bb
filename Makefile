# Two commands: `make demo` flies, `make test` checks everything. Both do only what is needed.
# PYTHON=/path/to/python3 chooses the interpreter; ARGS='...' goes on to the command.

MAKEFLAGS += --no-print-directory
SHELL := /bin/sh
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1
export PYTHON
export FIRMWARE
export CORES
export ADC
export VEHICLE

enter := root='$(CURDIR)' && . tools/workspace.sh
sources := config src test campaigns examples tools conftest.py

.PHONY: help demo build test-environment test test-fast test-long contract checked check format \
    campaign same firmware docs reference lock wheel ros2 clean

# The words behind `campaign` are its name, not targets
ifeq (campaign,$(firstword $(MAKECMDGOALS)))
name := $(wordlist 2,2,$(MAKECMDGOALS))
$(eval $(name):;@:)
endif

help:  ## show this list
	@sed -n 's/^\([a-z0-9-]*\):[^#]*## \(.*\)/  make \1|\2/p' Makefile | awk -F '|' '{ printf "%-18s %s\n", $$1, $$2 }'

demo: build  ## fly to the lamp; the last line gives the paths of bag and page
	@# Robots on a domain share a clock: take the first domain on which nobody of this user flies
	@for ROS_DOMAIN_ID in $${ROS_DOMAIN_ID:-0 1 2 3 4 5 6 7 8 9}; do \
	    lock=$${XDG_RUNTIME_DIR:-$${TMPDIR:-/tmp}}/lta-$$(id -u)-$$ROS_DOMAIN_ID.lock; \
	    [ ! -f "$$lock" ] || flock -n "$$lock" true || continue; \
	    break; \
	done; export ROS_DOMAIN_ID; exec ./lta fly $(ARGS)

build:  ## build the environment in .venv and the workspace in install/, if they changed
	@tools/environment.sh run
	@tools/build.sh

test-environment:  ## install the packages for the tests, to run some of them by hand
	@tools/environment.sh test
	@tools/build.sh

test: checked  ## check style and types, run all tests except the long ones
	@$(enter) && tools/suite.sh 'not long' $(ARGS)

test-fast: test-environment  ## run the unit tests nearest to the changes against main (a minute at most)
	@$(enter) && tools/fast.sh $(ARGS)

test-long: checked  ## run all tests, including the long ones
	@$(enter) && tools/suite.sh '' $(ARGS)

contract: test-environment  ## run the contract tests: names, layers, declarations, pages (two minutes)
	@$(enter) && .venv/bin/python -P -m pytest -q -n 2 -m 'not long' test/contract $(ARGS)

# One core checks types and collects the tests; the other compiles the kernels for all workers. The
# first import rewrites the tests' assertions and caches the result: once here, not in each worker.
checked: test-environment
	@{ ./lta simulate --no-bag >/dev/null && $(enter) && .venv/bin/python test/compile_kernels.py; } & \
	    $(MAKE) check && { ls test/contract/__pycache__/*-pytest-*.pyc >/dev/null 2>&1 || { $(enter) && \
	    .venv/bin/python -P -m pytest -q --collect-only >/dev/null 2>&1 || :; }; } && wait $$!

check: test-environment  ## check style and types only
	@.venv/bin/ruff check --quiet $(sources)
	@.venv/bin/ruff format --check --quiet $(sources)
	@$(enter) && .venv/bin/python tools/message_stubs.py
	@.venv/bin/mypy config/lta_config src/*/lta_*

format: test-environment  ## format the sources
	@.venv/bin/ruff check --quiet --fix $(sources)
	@.venv/bin/ruff format --quiet $(sources)

campaign: test-environment  ## score, measure or fly for minutes or hours: make campaign NAME (without NAME: list them)
	@$(enter) && PYTHONPATH="$$root:$$PYTHONPATH" nice .venv/bin/python -P -m campaigns $(name) $(ARGS)

same: test-environment  ## compare simulations, commands and studies with their stored results (minutes; ARGS=--freeze: store them)
	@$(enter) && .venv/bin/python test/same/same.py $(ARGS)

firmware: test-environment  ## build both firmware images (FIRMWARE=/path/to/crazyflie-firmware CORES=... ADC=... VEHICLE=gtmab; ARGS=--rehearse: run it here)
	@$(enter) && .venv/bin/python tools/firmware.py $(ARGS)

docs: build  ## build the docs as a site without network access: site/index.html
	@tools/site.sh

reference: build  ## generate the reference pages of docs/
	@$(enter) && tools/reference.sh

lock: test-environment docs  ## write locked/ and docs/licences.md after a change of requirements*.txt or constraints.txt
	@.venv/bin/python tools/lock.py
	@.venv/bin/python tools/licences.py

wheel: build  ## build one wheel in dist/ with everything that needs no ROS
	@tools/wheel.sh

ros2: build  ## install the ros2 command, which the wheels lack: ./ros2 topic echo ... (FROM=where the repositories of ROS 2 are)
	@tools/ros2cli.sh $(FROM)

clean:  ## remove everything that make created, except runs/
	@rm -rf .venv .venv-docs site build install log dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	@find config src test campaigns -name __pycache__ -prune -exec rm -rf {} +
