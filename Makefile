# Every target is one line that calls moseg; set-up runs again only when what it installs has changed.
PYTHON  ?= python3
DATASET ?= synthetic
VIDEO   ?=
OUT     ?= out
VARIANT ?=
ROOT    ?=
WORKERS ?= 0
RERUN   ?=
DAVIS   ?=
KT3DMOSEG ?=
HOPKINS155 ?=
HOPKINS12 ?=
MTPV62  ?=
STILL   ?=
ARGS    ?=
STORE   ?=
MOSEG   := .venv/bin/moseg
OPTIONS  = $(if $(ROOT),--root "$(ROOT)") --workers $(WORKERS) $(if $(STORE),--store "$(STORE)") $(ARGS)

.PHONY: setup eval ablation segment train test test-faults lint docs-check docs-pictures results bench bench-engine bench-faults bench-networks bench-memory bench-objects bench-prompts peers clean

setup: .venv/.ready

.venv/.ready: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "moseg needs Python 3.11 or newer (make PYTHON=python3.12 ...)" >&2; exit 2; }
	$(PYTHON) -m venv .venv
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[models,test,view]'
	touch $@

eval: setup
	$(MOSEG) eval --dataset $(DATASET) $(if $(VARIANT),--variant $(VARIANT)) $(OPTIONS)

ablation: setup
	$(MOSEG) ablate --dataset $(DATASET) $(OPTIONS)

segment: setup
	$(MOSEG) segment "$(VIDEO)" --out "$(OUT)" --workers $(WORKERS) $(if $(STORE),--store "$(STORE)") $(ARGS)

train: setup
	$(MOSEG) train --out "$(OUT)/motion_network.onnx" --folder "$(OUT)/training" $(if $(filter-out 0,$(WORKERS)),--workers $(WORKERS)) $(ARGS)

test: setup
	env -u PYTHONDONTWRITEBYTECODE .venv/bin/python -m pytest -n 2 --dist worksteal --ignore tests/faults $(ARGS)

test-faults: setup
	env -u PYTHONDONTWRITEBYTECODE .venv/bin/python -m pytest -n 2 --dist worksteal tests/faults $(ARGS)

lint: setup
	.venv/bin/ruff check . && .venv/bin/ruff format --check .

docs-check: setup
	.venv/bin/python docs/tools/check_commands.py $(ARGS)

docs-pictures: setup
	.venv/bin/python docs/tools/draw_graph.py
	.venv/bin/python docs/tools/make_pictures.py
	.venv/bin/python docs/tools/picture_view.py
	.venv/bin/python docs/tools/draw_curves.py

results: setup
	.venv/bin/python docs/tools/write_results.py $(if $(RERUN),--rerun '$(RERUN)') $(if $(DAVIS),--davis "$(DAVIS)") $(if $(KT3DMOSEG),--kt3dmoseg "$(KT3DMOSEG)") $(if $(HOPKINS155),--hopkins155 "$(HOPKINS155)") $(if $(HOPKINS12),--hopkins12 "$(HOPKINS12)") $(if $(MTPV62),--mtpv62 "$(MTPV62)") $(if $(STILL),--still "$(STILL)") $(ARGS)

bench: setup
	for script in benchmarks/*.py; do echo "== $$script"; .venv/bin/python "$$script" || exit 1; done

bench-engine: setup
	.venv/bin/python benchmarks/overhead.py --dataset $(DATASET) $(if $(ROOT),--root "$(ROOT)") --repeat 3
	.venv/bin/python benchmarks/joblib_memory.py --dataset $(DATASET) $(if $(ROOT),--root "$(ROOT)")
	.venv/bin/python benchmarks/scale.py --pairs 100,1000,10000 --calls 2000,10000
	.venv/bin/python benchmarks/object_requests.py --dataset $(DATASET) $(if $(ROOT),--root "$(ROOT)")

bench-faults: setup
	.venv/bin/python benchmarks/faults/crash.py --kills 50
	.venv/bin/python benchmarks/faults/crash.py --kills 10 --object-store
	.venv/bin/python benchmarks/faults/corruption.py
	.venv/bin/python benchmarks/faults/races.py --processes 8
	.venv/bin/python benchmarks/faults/disk.py
	.venv/bin/python benchmarks/faults/odd_paths.py
	.venv/bin/python benchmarks/faults/worker_loss.py
	.venv/bin/python benchmarks/faults/fuzz_readers.py

bench-networks: setup
	.venv/bin/python benchmarks/networks/cost.py $(ARGS)

bench-memory: setup
	.venv/bin/python benchmarks/long_video/peak_memory.py $(ARGS)

bench-objects: setup
	.venv/bin/python benchmarks/kt3dmoseg/object_affinities.py $(if $(ROOT),"$(ROOT)") $(ARGS)
	.venv/bin/python benchmarks/kt3dmoseg/motion_counts.py $(if $(ROOT),"$(ROOT)")

bench-prompts: setup
	.venv/bin/python benchmarks/prompts/motion_prompts.py $(if $(DAVIS),--davis "$(DAVIS)") $(if $(KT3DMOSEG),--kt3dmoseg "$(KT3DMOSEG)") $(ARGS)

peers: setup
	.venv/bin/python benchmarks/peers/compare.py $(if $(DAVIS),--dataset davis16 --root "$(DAVIS)",--dataset $(DATASET) $(if $(ROOT),--root "$(ROOT)")) $(ARGS)

clean:
	rm -rf .venv build *.egg-info
