# Every target is one line that calls moseg; set-up runs again only when what it installs has changed.
PYTHON  ?= python3
DATASET ?= synthetic
VIDEO   ?=
OUT     ?= out
VARIANT ?=
ROOT    ?=
WORKERS ?= 0
STORE   ?= .moseg/store
MOSEG   := .venv/bin/moseg
OPTIONS  = $(if $(ROOT),--root "$(ROOT)") --workers $(WORKERS) --store "$(STORE)" $(ARGS)

.PHONY: setup eval ablation segment test lint bench bench-networks bench-memory bench-objects clean

setup: .venv/.ready

.venv/.ready: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "moseg needs Python 3.11 or newer (make PYTHON=python3.12 ...)" >&2; exit 2; }
	$(PYTHON) -m venv .venv
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[models,test]'
	touch $@

eval: setup
	$(MOSEG) eval --dataset $(DATASET) $(if $(VARIANT),--variant $(VARIANT)) $(OPTIONS)

ablation: setup
	$(MOSEG) ablate --dataset $(DATASET) $(OPTIONS)

segment: setup
	$(MOSEG) segment "$(VIDEO)" --out "$(OUT)" --workers $(WORKERS) --store "$(STORE)" $(ARGS)

test: setup
	.venv/bin/python -m pytest -n 2 $(ARGS)

lint: setup
	.venv/bin/ruff check . && .venv/bin/ruff format --check .

bench: setup
	for script in benchmarks/*.py; do echo "== $$script"; .venv/bin/python "$$script" || exit 1; done

bench-networks: setup
	.venv/bin/python benchmarks/networks/cost.py $(ARGS)

bench-memory: setup
	.venv/bin/python benchmarks/long_video/peak_memory.py $(ARGS)

bench-objects: setup
	.venv/bin/python benchmarks/kt3dmoseg/object_affinities.py $(if $(ROOT),"$(ROOT)") $(ARGS)
	.venv/bin/python benchmarks/kt3dmoseg/motion_counts.py $(if $(ROOT),"$(ROOT)")

clean:
	rm -rf .venv build *.egg-info
