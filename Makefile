# `make run`: set everything up and watch the agent find things. `make test`: set everything up and pass the tests.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
# `make setup TORCH_INDEX=URL` installs torch from this package index, such as PyTorch's index of CPU wheels, which need
# no CUDA packages; all else comes from the default index. Empty: torch comes from the default index, too.
TORCH_INDEX :=
# Bytecode is written at the first use: without it, each process of the tests would compile all packages again (3 s).
unexport PYTHONDONTWRITEBYTECODE
TORCH := $(shell grep '^torch==' constraints.txt)

.PHONY: setup system-libraries run test test-all lint types docs habitat test-habitat ros test-ros lerobot test-lerobot clean

setup: system-libraries $(STAMP)

$(STAMP): pyproject.toml setup.py constraints.txt
	@echo "== creating $(VENV) and installing the pinned packages of constraints.txt"
	$(PYTHON) -m venv $(VENV)
ifneq ($(TORCH_INDEX),)
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --no-deps --index-url '$(TORCH_INDEX)' '$(TORCH)'
endif
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --constraint constraints.txt --editable '.[dev]'
	@touch $@

system-libraries:
	@sh tools/maintenance/system_libraries.sh

run: setup
	@echo "== five episodes, filmed: stubborn-plus looks for objects in apartments that ship with this repository"
	$(BIN)/stubborn run --agent stubborn-plus --video --record --workers 2

test: setup
	@echo "== the tests; where all cases would be too many, a sample that changes with each commit (all: make test-all)"
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "not slow"

test-all: setup
	@echo "== every test, every case"
	$(BIN)/python -m pytest -n 2 --dist worksteal --all-cases $(PYTEST_OPTIONS)

habitat: setup
	@test -d .venv-habitat || $(BIN)/stubborn habitat setup

test-habitat: habitat
	@echo "== the tests with the real habitat-lab, in its own environment"
	@.venv-habitat/bin/python -c "import pytest" 2> /dev/null || .venv-habitat/bin/python -m pip install --quiet pytest
	.venv-habitat/bin/python -m pytest -q -c /dev/null --rootdir . --import-mode=importlib --noconftest -p no:cacheprovider tests/habitat_lab

ros: setup
	@test -d .venv-ros2 || $(BIN)/stubborn ros setup

test-ros: ros
	@echo "== the tests with ROS 2, in its own environment"
	@.venv-ros2/bin/python -c "import pytest, rosbags" 2> /dev/null || .venv-ros2/bin/python -m pip install --quiet pytest rosbags
	.venv-ros2/bin/python -m pytest -q -c /dev/null --rootdir . --import-mode=importlib --noconftest -p no:cacheprovider tests/ros2

lerobot:
	@test -x .venv-lerobot/bin/lerobot-eval || { $(PYTHON) -m venv .venv-lerobot && \
	.venv-lerobot/bin/python -m pip install --quiet lerobot --editable . ./lerobot_env_stubborn; }

test-lerobot: lerobot
	@echo "== the tests with LeRobot, in its own environment"
	@.venv-lerobot/bin/python -c "import pytest, beartype" 2> /dev/null || .venv-lerobot/bin/python -m pip install --quiet pytest beartype
	PYTHONPATH=. .venv-lerobot/bin/python -m pytest -q -c /dev/null --rootdir . --import-mode=importlib --noconftest -p no:cacheprovider tests/lerobot

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/codespell
	$(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.github-issue-forms .github/ISSUE_TEMPLATE/*.yml

types: setup
	$(BIN)/python -m tools.maintenance.mujoco_stubs
	$(BIN)/pyright

docs: setup $(VENV)/.docs-installed
	@echo "== the documentation site: build/site/index.html"
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

$(VENV)/.docs-installed: pyproject.toml constraints.txt
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --constraint constraints.txt --editable '.[docs]'
	@touch $@

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .ruff_cache
