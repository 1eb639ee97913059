# Risorius: two commands on a fresh Debian or Ubuntu.
#
#   make demo     set up everything and film what refinement does: out/demo.mp4 and out/demo.png
#   make test     set up everything, check the code and pass the first lane of tests, in four minutes
#   make setup    only make .venv with everything in it
#   make check    ruff, mypy and the import rules alone
#   make docs     build the documentation's site into out/site
#   make reproduce  what the paper says and shows, made anew, on a page: out/reproduce/index.html
#   make clean    remove .venv and what was rendered
#
# Slower ones, before a release:
#
#   make test-all         make test, then the second lane: details, and all tests that take long
#   make test-windows     pass the tests of windows ten times, quiet and beside two busy processes
#   make test-lowest      pass the tests with the oldest versions that pyproject.toml allows
#   make test-processors  pass the tests as other processors round

PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready
LOWEST := .venv-lowest
SCREEN := xvfb-run -a -s "-screen 0 1600x1000x24"
SUDO := $(shell [ "$$(id -u)" = 0 ] || { command -v sudo >/dev/null && sudo -n true 2>/dev/null && echo "sudo -n"; })
OPENGL_PACKAGES := libegl1 libgl1 libgl1-mesa-dri
SCREEN_PACKAGES := xvfb xauth xdotool

# Tests start the command dozens of times: our modules are compiled once, whatever the machine says.
unexport PYTHONDONTWRITEBYTECODE

# $(call debian_packages,what needs them,packages): install where we may, else name the one command.
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

# What draws and opens windows: a third of the work. One process at a time may do that.
WINDOWS := $(wildcard tests/app/test_viewer*.py) tests/app/test_plug_ins.py \
	tests/bench/test_window.py tests/refine_gl tests/render

# On a fresh machine one process compiles what is simulated and refined; else each would do so.
COMPILE := $(BIN)/risorius capture --set joy --size 64x64 -o .venv/compiled.png --quiet

# $(call pass_lane,marks,before): one process tests windows, after what comes before them, on a
# screen of its own, whose keyboard nobody else may touch. Beside it two share all the rest, file by
# file, so that two cores have work to the end. What the first prints is shown when all have ended.
define pass_lane
	{ $(2) $(SCREEN) -n 199 $(BIN)/python -m pytest -m "$(1)" $(WINDOWS); } >.venv/windows.log 2>&1 & \
		windows=$$!; code=0; $(COMPILE); \
		$(SCREEN) $(BIN)/python -m pytest -m "$(1)" --numprocesses 2 --dist loadfile \
			$(addprefix --ignore=,$(WINDOWS)) || code=1; \
		wait $$windows || code=1; cat .venv/windows.log; exit $$code
endef

# A variable: lines that name MAKE themselves are run even by `make --dry-run`.
CHECKS = $(MAKE) --no-print-directory check &&

test: setup opengl screen
	@$(call pass_lane,not slow,$(CHECKS))

test-all: test
	@$(call pass_lane,slow)

# A test that waits too little fails now and then, more often on a busy machine. ROUNDS=3 is less.
ROUNDS ?= 10

# The busy processes end with the shell that began them, however that ends.
test-windows: setup opengl screen
	@code=0; for company in quiet busy; do \
		[ $$company = quiet ] || for _ in 1 2; do while kill -0 $$$$; do :; done 2>/dev/null & done; \
		for round in $$(seq $(ROUNDS)); do \
			echo "$$company, round $$round"; \
			$(SCREEN) $(BIN)/python -m pytest -q -m window || code=1; \
		done; \
	done; exit $$code

# Compiled code is kept apart: the other numba could not read it.
test-lowest: $(LOWEST)/.ready screen
	@NUMBA_CACHE_DIR=$(CURDIR)/$(LOWEST)/compiled $(SCREEN) $(LOWEST)/bin/python -m pytest

$(LOWEST)/.ready: pyproject.toml tests/lowest.py
	@rm -rf $(LOWEST)
	@$(PYTHON) -m venv $(LOWEST)
	@$(LOWEST)/bin/python tests/lowest.py > $(LOWEST)/constraints.txt
	@echo "Installing Risorius and the oldest of what it needs into $(LOWEST)"
	@$(LOWEST)/bin/python -m pip install -qq --disable-pip-version-check \
		--constraint $(LOWEST)/constraints.txt --editable ".[dev]"
	@touch $@

# Rounds as other processors do, as far as this one can: OpenBLAS, numpy and numba each choose code
# by the processor, and can be told. The last needs AVX-512. TESTS=tests/assets passes a part alone.
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
	@$(BIN)/mypy docs/figures
	@cd .venv/as_installed && ../bin/lint-imports --config ../../pyproject.toml

reproduce: setup opengl
	@$(BIN)/risorius reproduce all

# A broken link stops it. The variable silences an advertisement of the theme's makers.
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
	@echo "Installing Risorius and what it needs into .venv, which takes minutes"
	@$(BIN)/python -m pip install -qq --disable-pip-version-check --no-compile \
		--constraint constraints.txt --editable ".[dev]"
	@touch $(READY)
	@echo "Installed; .venv/bin/risorius doctor says what works here"

opengl: setup
	@$(BIN)/risorius doctor --offscreen --quiet || { $(call debian_packages,OpenGL without a screen (EGL),$(OPENGL_PACKAGES)); }
	@$(BIN)/risorius doctor --offscreen --quiet || { $(BIN)/risorius doctor; exit 2; }

screen:
	@command -v xvfb-run >/dev/null && command -v xauth >/dev/null && command -v xdotool >/dev/null || \
		{ $(call debian_packages,A virtual screen for the window tests,$(SCREEN_PACKAGES)); }

clean:
	rm -rf .venv $(LOWEST) out
