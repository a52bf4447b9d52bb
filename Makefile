# Two commands: `make demo` flies, `make test` checks everything. Both do only what is needed.
# PYTHON=/path/to/python3 chooses the interpreter; ARGS='...' goes on to lta fly or pytest.

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
sources := config src test examples tools conftest.py

.PHONY: help demo build contract test test-fast test-long test-packages bench bench-compare flights hops trust wrong-imports calibration-trials same challenge classes real-flights forecasts crazyflie odometry faults real-firmware ros2 firmware rehearsal end-to-end mutation chaos soak docs reference pictures lock check format clean

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

contract: test-environment  ## run the contract tests: names, layers, declarations, pages (two minutes)
	@$(enter) && .venv/bin/python -P -m pytest -q -n 2 -m 'not long' test/contract $(ARGS)

test: checked  ## check style and types, run all tests except the long ones
	@$(enter) && tools/suite.sh 'not long and not benchmark' $(ARGS)

test-fast: test-environment  ## run the unit tests nearest to the changes against main (a minute at most)
	@$(enter) && tools/fast.sh $(ARGS)

test-long: checked  ## run all tests, including the long ones
	@$(enter) && tools/suite.sh 'not benchmark' $(ARGS)

test-packages: test-environment  ## run the unit tests of each package with colcon (ARGS='src/lta_vlc': only some)
	@$(enter) && tools/test_packages.sh $(ARGS)

bench: test-environment  ## run the benchmarks, next to other projects (ARGS='kernel mujoco': only some)
	@$(enter) && .venv/bin/python test/benchmark/bench.py $(ARGS)

bench-compare: test-environment  ## compare the last `make bench` with the stored ratios (ARGS=--keep: store it, and write docs/validation.md)
	@$(enter) && .venv/bin/python test/benchmark/compare.py $(ARGS)

flights: test-environment  ## fly many seeds (ARGS=SEEDS, 20 by default: minutes)
	@$(enter) && .venv/bin/python test/benchmark/flights.py $(ARGS)

trust: test-environment  ## score the trust checks on clean and corrupted flights (minutes)
	@$(enter) && .venv/bin/python test/score/trust.py $(ARGS)

wrong-imports: test-environment  ## score how often a wrong unit or axis in an import is found, and named (minutes)
	@$(enter) && .venv/bin/python test/score/wrong_imports.py $(ARGS)

calibration-trials: test-environment  ## calibrate vehicles with hidden calibrations, and count what is found (ARGS='--cases 100': an hour; resumes)
	@$(enter) && .venv/bin/python test/score/calibration_trials.py $(ARGS)

challenge: test-environment  ## hide effects in flights of an independent simulator and score discovery (ARGS='--seed 1 --n 30': an hour; resumes)
	@$(enter) && nice .venv/bin/python test/challenge/score.py $(ARGS)

hops: test-environment  ## count the files, calls and returns of one step of each node (ARGS='navigator': list its calls)
	@$(enter) && .venv/bin/python test/score/hops.py $(ARGS)

same: test-environment  ## compare simulations, commands and studies with their stored results (minutes; ARGS=--freeze: store them)
	@$(enter) && .venv/bin/python test/same/same.py $(ARGS)

classes: test-environment  ## compute which effects are indistinguishable (a minute)
	@$(enter) && .venv/bin/python test/score/classes.py $(ARGS)

real-flights: test-environment  ## study real flights of two blimps; writes docs/discovery_flights.md (ten minutes)
	@$(enter) && nice .venv/bin/python test/score/real_flights.py $(ARGS)

forecasts: test-environment  ## compare calibrated forecasts of real and simulated flights with two simple peers; writes docs/forecasts.md (half an hour; ARGS='--sets rgblimp')
	@$(enter) && nice .venv/bin/python test/score/forecast_peers.py $(ARGS)

faults: test-environment  ## inject faults into flights of emulated hardware, 20 of each kind; writes docs/hardware_faults.md (hours)
	@$(enter) && .venv/bin/python test/score/faults.py $(ARGS)

real-firmware: test-environment  ## run the bridge against the real Crazyflie firmware (FIRMWARE=/path; ARGS='--steps record suite': minutes)
	@$(enter) && .venv/bin/python test/score/real_firmware.py '$(FIRMWARE)' $(ARGS)

ros2: build  ## install the ros2 command, which the wheels lack: ./ros2 topic echo ... (FROM=where the repositories of ROS 2 are)
	@tools/ros2cli.sh $(FROM)

firmware: test-environment  ## build both firmware images (FIRMWARE=/path/to/crazyflie-firmware CORES=... ADC=... VEHICLE=gtmab)
	@$(enter) && .venv/bin/python tools/firmware.py $(ARGS)

rehearsal: test-environment  ## run the real Crazyflie firmware on this machine until Ctrl-C (FIRMWARE=/path VEHICLE=gtmab)
	@$(enter) && .venv/bin/python tools/firmware.py --rehearse $(ARGS)

end-to-end: test-environment  ## fly 20 seeds to the lamp through the real Crazyflie firmware (FIRMWARE=/path)
	@$(enter) && .venv/bin/python test/score/end_to_end.py '$(FIRMWARE)' $(ARGS)

mutation: test-environment  ## mutation testing: do tests detect small changes of the code? writes docs/testing_mutation.md (a quarter of an hour; ARGS='--areas control': minutes)
	@$(enter) && nice .venv/bin/python test/score/mutation.py $(ARGS)

chaos: test-environment  ## inject faults into whole graphs, 12 of each kind; writes docs/reliability.md (an hour)
	@$(enter) && .venv/bin/python test/score/chaos.py $(ARGS)

soak: test-environment  ## fly two hours at the graph's full speed; writes docs/reliability.md (ARGS='--minutes 5': less)
	@$(enter) && .venv/bin/python test/score/soak.py $(ARGS)

crazyflie: test-environment  ## estimate battery sag from real Crazyflie flights; writes docs/discovery_flights.md
	@$(enter) && .venv/bin/python test/score/crazyflie.py $(ARGS)

odometry: test-environment  ## score the covariances of odom and airspeed (minutes; ARGS=--write: write docs/control.md)
	@$(enter) && nice .venv/bin/python test/score/odometry.py $(ARGS)

docs: build  ## build the docs as a site without network access: site/index.html
	@tools/site.sh

reference: build  ## generate the reference pages of docs/
	@$(enter) && tools/reference.sh

pictures: test-environment  ## draw the pictures of docs/images again, with Chromium (minutes; ARGS='flight compare': only some)
	@$(enter) && tools/pictures.sh $(ARGS)

lock: test-environment docs  ## write locked/ and docs/licences.md after a change of requirements*.txt or constraints.txt
	@.venv/bin/python tools/lock.py
	@.venv/bin/python tools/licences.py

# One core checks types and collects the tests; the other compiles the kernels for all workers.
.PHONY: checked kernels collected
checked: test-environment
	@$(MAKE) -j 2 collected kernels

kernels: test-environment
	@./lta simulate --no-bag >/dev/null
	@$(enter) && .venv/bin/python test/compile_kernels.py

# The first import rewrites the tests' assertions and caches the result: once here, not in each worker.
collected: check
	@ls test/contract/__pycache__/*-pytest-*.pyc >/dev/null 2>&1 || { $(enter) && \
		.venv/bin/python -P -m pytest -q --collect-only >/dev/null 2>&1 || :; }

check: test-environment  ## check style and types only
	@.venv/bin/ruff check --quiet $(sources)
	@.venv/bin/ruff format --check --quiet $(sources)
	@$(enter) && .venv/bin/python tools/message_stubs.py
	@.venv/bin/mypy config/lta_config src/*/lta_*

format: test-environment  ## format the sources
	@.venv/bin/ruff check --quiet --fix $(sources)
	@.venv/bin/ruff format --quiet $(sources)

.PHONY: wheel release-check test-environment
test-environment:  ## install the packages for the tests, to run some of them by hand
	@tools/environment.sh test
	@tools/build.sh

wheel: build  ## build one wheel in dist/ with everything that needs no ROS
	@tools/wheel.sh

release-check: test-environment  ## run all checks before a release, including the long tests
	@tools/release.sh

clean:  ## remove everything that make created, except runs/
	@rm -rf .venv .venv-docs site build install log dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	@find config src test -name __pycache__ -prune -exec rm -rf {} +

