# Risorius: two commands on a fresh Debian or Ubuntu.
#
#   make demo     set up everything and film the effect of refinement: out/demo.mp4 and out/demo.png
#   make test     set up everything, check the code and run the first lane of tests (4 minutes)
#   make setup    only make .venv with everything in it
#   make check    run ruff, mypy, the import rules and the budgets alone
#   make docs     build the documentation's site into out/site
#   make reproduce  check the paper's claims and draw its figures: out/reproduce/index.html
#   make clean    remove .venv and all rendered files
#
# Slower ones, before a release:
#
#   make test-all         make test, then the second lane: details, and all slow tests
#   make test-windows     run the tests of windows ten times, alone and beside two busy processes
#   make test-lowest      run the tests with the oldest versions that pyproject.toml allows
#   make test-processors  run the tests with the rounding of other processors

PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready
LOWEST := .venv-lowest
SCREEN := xvfb-run -a -s "-screen 0 1600x1000x24"
SUDO := $(shell [ "$$(id -u)" = 0 ] || { command -v sudo >/dev/null && sudo -n true 2>/dev/null && echo "sudo -n"; })
OPENGL_PACKAGES := libegl1 libgl1 libgl1-mesa-dri
SCREEN_PACKAGES := xvfb xauth xdotool

# Tests start the command dozens of times, so Python keeps our compiled modules on every machine.
unexport PYTHONDONTWRITEBYTECODE

# $(call debian_packages,purpose,packages): install them as root or with sudo, or print the command.
define debian_packages
	if command -v apt-get >/dev/null && { [ "$$(id -u)" = 0 ] || [ -n "$(SUDO)" ]; }; then \
		echo "$(1): installing $(2)"; \
		$(SUDO) apt-get -qq update && DEBIAN_FRONTEND=noninteractive $(SUDO) apt-get -qq install -y $(2) >/dev/null; \
	else \
		echo "$(1) is missing; run: sudo apt install $(2)"; exit 2; \
	fi
endef

.PHONY: demo test test-all test-windows test-lowest test-processors setup check reproduce docs opengl screen clean

demo: setup opengl
	@$(BIN)/risorius demo

# Tests that draw or open windows take a third of the time. One process runs them.
WINDOWS := $(wildcard tests/app/test_viewer*.py) tests/app/test_plug_ins.py \
	tests/bench/test_window.py tests/refine_gl tests/render

# On a fresh machine one process compiles simulation and refinement for all others.
COMPILE := $(BIN)/risorius capture --set joy --size 64x64 -o .venv/compiled.png --quiet

# $(call pass_lane,marks,before): one process runs the commands `before` and then the tests of
# windows, on its own screen, so no other process takes its keyboard. Two processes share all other
# tests, file by file, which keeps two cores busy. The output of the first is printed at the end.
define pass_lane
	{ $(2) $(SCREEN) -n 199 $(BIN)/python -m pytest -m "$(1)" $(WINDOWS); } >.venv/windows.log 2>&1 & \
		windows=$$!; code=0; $(COMPILE); \
		$(SCREEN) $(BIN)/python -m pytest -m "$(1)" --numprocesses 2 --dist loadfile \
			$(addprefix --ignore=,$(WINDOWS)) || code=1; \
		wait $$windows || code=1; cat .venv/windows.log; exit $$code
endef

# This is a variable, because `make --dry-run` runs lines that contain MAKE.
CHECKS = $(MAKE) --no-print-directory check &&

test: setup opengl screen
	@$(call pass_lane,not slow,$(CHECKS))

test-all: test
	@$(call pass_lane,slow)

# A test that waits too briefly fails sometimes, more often on a busy machine. ROUNDS=3 is faster.
ROUNDS ?= 10

# The busy processes end with the shell that started them.
test-windows: setup opengl screen
	@code=0; for company in quiet busy; do \
		[ $$company = quiet ] || for _ in 1 2; do while kill -0 $$$$; do :; done 2>/dev/null & done; \
		for round in $$(seq $(ROUNDS)); do \
			echo "$$company, round $$round"; \
			$(SCREEN) $(BIN)/python -m pytest -q -m window || code=1; \
		done; \
	done; exit $$code

# Compiled code has its own folder, because the other numba cannot read it.
test-lowest: $(LOWEST)/.ready screen
	@NUMBA_CACHE_DIR=$(CURDIR)/$(LOWEST)/compiled $(SCREEN) $(LOWEST)/bin/python -m pytest

$(LOWEST)/.ready: pyproject.toml tests/lowest.py
	@rm -rf $(LOWEST)
	@$(PYTHON) -m venv $(LOWEST)
	@$(LOWEST)/bin/python tests/lowest.py > $(LOWEST)/constraints.txt
	@echo "Installing Risorius and the oldest versions of its dependencies into $(LOWEST)"
	@$(LOWEST)/bin/python -m pip install -qq --disable-pip-version-check \
		--constraint $(LOWEST)/constraints.txt --editable ".[dev]"
	@touch $@

# OpenBLAS, numpy and numba choose code by the processor, and these variables choose it for them.
# The last variant needs AVX-512. TESTS=tests/assets runs a part alone.
OLD_PROCESSOR := OPENBLAS_CORETYPE=Nehalem NUMBA_CPU_NAME=generic \
	NPY_DISABLE_CPU_FEATURES=X86_V3,X86_V4,AVX512_ICL,AVX512_SPR

test-processors: setup opengl screen
	@for variant in OPENBLAS_CORETYPE=Haswell OPENBLAS_CORETYPE=Zen "$(OLD_PROCESSOR)" \
			OPENBLAS_CORETYPE=SkylakeX; do \
		echo "$$variant"; \
		env $$variant $(SCREEN) $(BIN)/python -m pytest $(TESTS) || exit; \
	done

check: setup
	@$(BIN)/python tests/as_installed.py .venv/as_installed
	@$(BIN)/python tests/budgets.py
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/mypy docs/figures docs/source_pages.py
	@cd .venv/as_installed && ../bin/lint-imports --config ../../pyproject.toml

reproduce: setup opengl
	@$(BIN)/risorius reproduce all

# A broken link is an error. The variable silences an advertisement in the theme.
docs: setup
	@$(BIN)/python tests/as_installed.py .venv/as_installed
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	@echo "out/site/index.html"

setup: $(READY)

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Risorius needs Python 3.11 or newer; name one: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 2; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { $(call debian_packages,Python's venv,python3-venv); }
	@[ -x $(BIN)/python ] || $(PYTHON) -m venv .venv
	@echo "Installing Risorius and its dependencies into .venv, which takes minutes"
	@$(BIN)/python -m pip install -qq --disable-pip-version-check --no-compile \
		--constraint constraints.txt --editable ".[dev]"
	@touch $(READY)
	@echo "Installed; .venv/bin/risorius doctor reports what works here"

opengl: setup
	@$(BIN)/risorius doctor --offscreen --quiet || { $(call debian_packages,OpenGL without a screen (EGL),$(OPENGL_PACKAGES)); }
	@$(BIN)/risorius doctor --offscreen --quiet || { $(BIN)/risorius doctor; exit 2; }

screen:
	@command -v xvfb-run >/dev/null && command -v xauth >/dev/null && command -v xdotool >/dev/null || \
		{ $(call debian_packages,A virtual screen for the window tests,$(SCREEN_PACKAGES)); }

clean:
	rm -rf .venv $(LOWEST) out
