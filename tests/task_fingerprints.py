"""Fingerprints of the code behind each task's version.

A fingerprint is a digest over every definition that a task's adapter reaches, in its own module, in `moseg.tasks` and
in `moseg.workflows`: functions, classes and module-level values, each followed through imports to the module that
defines it. Comments, docstrings, layout and definitions that are not reached are not part of it.

Three things are left out on purpose. Parameter models (`schemas`): their values are in the recipes, so that another
default gives another key. The modules that only pass arrays on (`PLUMBING`): they change no array. Libraries: their
versions are in the manifests.
"""

import ast
import json
from collections.abc import Callable
from functools import cache
from hashlib import blake2b
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
RECORD = Path(__file__).with_suffix(".json")
FOLLOWED = {"moseg.tasks": "moseg_tasks", "moseg.workflows": "workflows"}
"""Packages whose code is followed, and their folders."""
CODE_KEYWORDS = ("run", "run_together")
PLUMBING = ("moseg.workflows.stages.task", "moseg.workflows.stages.inputs", "moseg.workflows.stages.resident")
LEAF_READERS = (
    ("ingest:leaves", "moseg.workflows.engine.ingest", "_LEAVES", "INGEST_VERSION"),
    ("ingest:images", "moseg.workflows.sources.image_files", "ImageFiles", "DECODING_VERSION"),
    ("ingest:video", "moseg.workflows.sources.video_file", "VideoFile", "DECODING_VERSION"),
    ("ingest:masks", "moseg.workflows.sources.mask_files", "MaskFiles", "DECODING_VERSION"),
    ("ingest:depth", "moseg.workflows.sources.depth_files", "DepthFiles", "DECODING_VERSION"),
    ("ingest:flow", "moseg.workflows.sources.flow_files", "FlowFiles", "DECODING_VERSION"),
    ("ingest:labelled_points", "moseg.workflows.sources.trajectory_files", "LabelledPointFile", "DECODING_VERSION"),
    ("ingest:tracks", "moseg.workflows.sources.track_files", "TrackFile", "DECODING_VERSION"),
    ("ingest:trajectories", "moseg.workflows.sources.trajectory_files", "TrajectoryFile", "DECODING_VERSION"),
    ("ingest:trajectory_labels", "moseg.workflows.sources.trajectory_files", "TrajectoryLabels", "DECODING_VERSION"),
    ("ingest:scenes", "moseg.workflows.sources.scenes", "_rendered", "RENDERER_VERSION"),
    ("ingest:warped_picture", "moseg.workflows.sources.warped_picture", "WarpedPicture", "WARP_VERSION"),
)
"""Decoders of files into leaves, which have versions too because `ingest` artifacts keep their results."""
_TRAINING, _CLIPS = "moseg.workflows.training.shards", "moseg.workflows.pipelines.video_clips"
TRAINING_DATA = (
    ("training:scenes", "moseg.tasks.motion_network.samples", "draw_sample", f"{_TRAINING}.DRAWING_VERSION"),
    ("training:clips", "moseg.tasks.network_training.clips", "make_clip", f"{_CLIPS}.CLIPS_VERSION"),
)
"""Writers of files that a later training reads again."""

SourceReader = Callable[[str], str | None]
"""Source of a module by its dotted name; None if it is not a module of this project."""


class Fingerprint(NamedTuple):
    """Record of one task."""

    version: int
    fingerprint: str


class Source(NamedTuple):
    """Parsed module: its statements, those that bind each name, and the module and name behind each import."""

    statements: list[ast.stmt]
    binders: dict[str, list[int]]
    imports: dict[str, tuple[str, str | None]]


class ModuleName(NamedTuple):
    """Name in a module; None stands for the whole module."""

    module: str
    name: str | None


def read_source(module: str) -> str | None:
    """Return the source of a module of the followed packages, from the working tree."""
    package, *inner = module.split(".")[1:] if module.startswith("moseg.") else [""]
    if f"moseg.{package}" not in FOLLOWED:
        return None
    path = ROOT.joinpath(FOLLOWED[f"moseg.{package}"], *inner)
    for candidate in (path.with_suffix(".py"), path / "__init__.py"):
        if candidate.is_file():
            return candidate.read_text(encoding="utf-8")
    return None


def current_fingerprints(read: SourceReader = read_source) -> dict[str, Fingerprint]:
    """Return the version and fingerprint of every task, of every decoder behind the leaves and of data for training."""
    return {name: Fingerprint(version, fingerprint(root, read)) for name, (version, root) in _roots().items()}


def recorded_fingerprints(path: Path = RECORD) -> dict[str, Fingerprint]:
    """Return the last record; empty if there is none."""
    if not path.is_file():
        return {}
    return {name: Fingerprint(**entry) for name, entry in json.loads(path.read_text(encoding="utf-8")).items()}


def moved_unnoticed(recorded: dict[str, Fingerprint], current: dict[str, Fingerprint]) -> list[str]:
    """Return the names whose code differs from the record although their version does not."""
    both = recorded.keys() & current.keys()
    return sorted(
        name
        for name in both
        if recorded[name].version == current[name].version and recorded[name].fingerprint != current[name].fingerprint
    )


def fingerprint(root: ModuleName, read: SourceReader = read_source) -> str:
    """Return the digest over every definition reached from `root`."""
    lines = sorted(json.dumps(entry) for entry in reach(root, read))
    return blake2b("\n".join(lines).encode("ascii"), digest_size=32).hexdigest()


def reach(root: ModuleName, read: SourceReader = read_source) -> list[list]:
    """Return each reached statement: its module, its tree, and the definitions of the imported names in it."""
    parse = cache(lambda module: _parse(module, read))
    found: dict[tuple[str, int], list] = {}
    entered: set[ModuleName] = set()
    waiting = [root]
    while waiting:
        target = waiting.pop()
        source = parse(target.module)
        if target in entered or source is None or target.module in PLUMBING:
            continue
        entered.add(target)
        if target.name in source.imports:
            waiting.append(_resolve(*source.imports[target.name], parse))
            continue
        if target.name is None:
            waiting.extend(_resolve(*imported, parse) for imported in source.imports.values())
        for index in _statements_of(source, target.name):
            if (target.module, index) in found:
                continue
            statement = source.statements[index]
            names = sorted(_names(statement))
            # An import inside a function binds like one at the top.
            imports = source.imports | _imports([statement])
            stands_for = {name: _resolve(*imports[name], parse) for name in names if name in imports}
            found[target.module, index] = [target.module, _tree(statement), sorted(map(list, stands_for.items()))]
            waiting.extend(stands_for.values())
            waiting.extend(ModuleName(target.module, name) for name in names if name not in imports)
    return list(found.values())


def _roots() -> dict[str, tuple[int, ModuleName]]:
    from moseg.workflows.stages.registry import all_tasks

    roots = {}
    for task in all_tasks():
        adapter = (task.run or task.run_together).__module__
        (variable,) = (key for key, value in vars(import_module(adapter)).items() if value is task)
        roots[f"{task.name}:{task.method}"] = (task.version, ModuleName(adapter, variable))
    for name, module, variable, version in (*LEAF_READERS, *TRAINING_DATA):
        owner, _, constant = version.rpartition(".")
        roots[name] = (getattr(import_module(owner or module), constant), ModuleName(module, variable))
    return roots


def _parse(module: str, read: SourceReader) -> Source | None:
    text = read(module)
    if text is None:
        return None
    statements = ast.parse(text).body
    binders: dict[str, list[int]] = {}
    for index, statement in enumerate(statements):
        for name in _bound(statement):
            binders.setdefault(name, []).append(index)
    definitions = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
    return Source(statements, binders, _imports([node for node in statements if not isinstance(node, definitions)]))


def _statements_of(source: Source, name: str | None) -> list[int]:
    """Return the statements that define a name, and those that bind none, which run on every import."""
    code = [i for i, node in enumerate(source.statements) if not _is_text(node) and not _is_import(node)]
    if name is None:
        return code
    if name not in source.binders:
        return []
    return [i for i in code if i in source.binders[name] or not _bound(source.statements[i])]


def _bound(statement: ast.stmt) -> set[str]:
    """Return the names that a module-level statement binds or, through an item or attribute, fills."""
    if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return {statement.name}
    if isinstance(statement, ast.Assign | ast.AnnAssign | ast.AugAssign):
        targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
        return {node.id for target in targets for node in ast.walk(target) if isinstance(node, ast.Name)}
    return {node.id for node in ast.walk(statement) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}


def _imports(statements: list[ast.stmt]) -> dict[str, tuple[str, str | None]]:
    found: dict[str, tuple[str, str | None]] = {}
    for statement in statements:
        for node in ast.walk(statement):
            if isinstance(node, ast.Import):
                for alias in node.names:
                    found[alias.asname or alias.name.partition(".")[0]] = (alias.name, None)
            elif isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    found[alias.asname or alias.name] = (node.module, alias.name)
    return found


def _resolve(module: str, name: str | None, parse: Callable[[str], Source | None]) -> ModuleName:
    """Return the module that defines an imported name, following packages that only re-export it."""
    while name is not None:
        source = parse(module)
        if source is not None and name in source.imports:
            module, name = source.imports[name]
        elif (source is None or name not in source.binders) and parse(f"{module}.{name}") is not None:
            return ModuleName(f"{module}.{name}", None)
        else:
            break
    return ModuleName(module, name)


def _names(statement: ast.stmt) -> set[str]:
    return {node.id for node in ast.walk(statement) if isinstance(node, ast.Name)}


def _tree(node) -> object:
    """Return an AST as lists, the same on every Python: without positions, empty fields and lone strings, and
    without the declarations of a task beside its code: its version, and what its recipe contains."""
    if isinstance(node, list):
        return [_tree(item) for item in node if not _is_text(item)]
    if not isinstance(node, ast.AST):
        return f"{type(node).__name__} {node!r}"
    is_task = isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Task"
    fields = []
    for field, value in ast.iter_fields(node):
        if is_task and field == "keywords":
            value = [keyword for keyword in value if keyword.arg in CODE_KEYWORDS]
        if value is not None and value != [] and field not in ("ctx", "kind", "type_comment"):
            fields.append([field, _tree(value)])
    return [type(node).__name__, *fields]


def _is_text(node) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _is_import(node) -> bool:
    return isinstance(node, ast.Import | ast.ImportFrom)
