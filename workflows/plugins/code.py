"""Fingerprint of a plug-in's code, which is part of the keys of the artifacts that the plug-in computes."""

import ast
import os
import sys
import sysconfig
import warnings
from collections.abc import Iterable
from functools import cache
from hashlib import blake2b
from importlib.machinery import ModuleSpec
from importlib.metadata import distribution, packages_distributions
from importlib.util import find_spec
from pathlib import Path

from moseg.schemas.errors import InputError

OWN_PACKAGE = "moseg"
MAIN, SPAWNED_MAIN = "__main__", "__mp_main__"
"""Names of the main script, in its own process and in one that multiprocessing has spawned."""
DIGEST_BYTES = 16
INSTALLED = {"site-packages", "dist-packages"}
"""Folders of installed packages."""
ENVIRONMENT = "pyvenv.cfg"
"""File of a virtual environment."""
_BASE = {"platbase": sys.base_exec_prefix}
_STANDARD_LIBRARY = {Path(sysconfig.get_path(kind, vars=_BASE)).resolve() for kind in ("stdlib", "platstdlib")}


def code_of_plugin(declared: object, caller: str) -> tuple[str, str]:
    """Return the packages that define an object, and the fingerprint of their code.

    These are the packages of the caller and of the functions in the object; those that hold the object in a variable,
    or in a list or tuple, because a script may register an object that it imports; and those that any of these imports
    by a statement, unless they were installed by themselves. The fingerprint covers every ``.py`` file of a package,
    without hidden folders and environments, or the file of a module outside any package. A comment changes the
    fingerprint too: artifacts are computed anew more often than needed, never too seldom.

    Parameters
    ----------
    declared : object
        Object that `moseg.register` accepts.
    caller : str
        Name of the module that registers it.

    Raises
    ------
    InputError
        The code is in no file, such as the code of a notebook's cell.
    """
    task = getattr(declared, "task", None)
    functions = [each for each in (getattr(task, name, None) for name in ("run", "run_together", "params")) if each]
    defining = _packages(getattr(each, "__module__", None) or MAIN for each in (type(declared), *functions))
    calling = _packages([caller])
    # The main script has its own variables, but not those of a package that is found without it.
    holding = {name for name in _packages(_holders(declared)) - {MAIN} if _has_code(name)}
    if not (all(map(_has_code, calling)) or holding):
        # Otherwise the object was imported from a file, into a notebook for instance.
        defining |= calling
    names = _with_imports({*filter(_has_code, calling), *defining, *holding})
    state = blake2b(digest_size=DIGEST_BYTES, person=b"moseg:plugin")
    for name in names:
        state.update(_code_of_package(name))
    return " ".join(names), state.hexdigest()


def _packages(modules: Iterable[str]) -> set[str]:
    """Return the outermost packages of modules, without this project's and Python's own."""
    found = {module.partition(".")[0] for module in modules}
    return {MAIN if name == SPAWNED_MAIN else name for name in found if not _is_known(name)}


def _is_known(name: str) -> bool:
    """Return whether a module is this project's or Python's own, and not the user's with the name of such a one."""
    places = [] if name in (MAIN, SPAWNED_MAIN) else [place.resolve() for place in _places(name)]
    if name == OWN_PACKAGE or not places:
        return name == OWN_PACKAGE or name in sys.stdlib_module_names
    return all(
        _STANDARD_LIBRARY.intersection(each.parents) and not INSTALLED.intersection(each.parts) for each in places
    )


def _holders(declared: object) -> set[str]:
    """Return the names of the modules with a variable that is the object or a list of it."""
    found = set()
    for name, module in list(sys.modules.items()):
        for value in list(getattr(module, "__dict__", {}).values()):
            if value is declared or (type(value) in (list, tuple) and any(each is declared for each in value)):
                found.add(name)
    return found


def _with_imports(packages: set[str]) -> list[str]:
    """Return packages and all that belongs to them, sorted: what they import of the user's own code, and so on."""
    found, waiting = set(packages), list(packages)
    while waiting:
        package = waiting.pop()
        for name in _imports(package) - found:
            if not _is_known(name) and _belongs_to(name, package):
                found.add(name)
                waiting.append(name)
    return sorted(found)


def _belongs_to(name: str, package: str) -> bool:
    """Return whether a package that another one imports is code of the same user, not of a library."""
    if not _has_code(name):
        return False
    mine = {*_distributions().get(name, ())}
    return not _is_installed(name, mine) or bool(mine & {*_distributions().get(package, ())})


def _is_installed(name: str, distributions: Iterable[str]) -> bool:
    """Return whether a package is where libraries are, or beside the list of files with which one was installed."""
    places = _places(name)
    if any(INSTALLED.intersection(place.parts) for place in places):
        return True
    found = map(distribution, distributions)
    folders = {Path(str(each.locate_file(""))).resolve() for each in found if each.read_text("RECORD") is not None}
    return any(place.parent.resolve() in folders for place in places)


@cache
def _distributions() -> dict[str, list[str]]:
    return dict(packages_distributions())


@cache
def _imports(package: str) -> set[str]:
    """Return the outermost names that the statements of a package's files import."""
    found: set[str] = set()
    for _, path in _sources(package):
        for node in _statements(path):
            if isinstance(node, ast.Import):
                found.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                found.add(node.module)
    return {name.partition(".")[0] for name in found}


def _statements(path: Path) -> Iterable[ast.AST]:
    """Return the nodes of a file's syntax tree; none if it is not Python, which cannot be imported either."""
    try:
        with warnings.catch_warnings():
            # What Python warns about in the file, it says when the file is imported.
            warnings.simplefilter("ignore")
            return ast.walk(ast.parse(_read(path)))
    except (SyntaxError, ValueError):
        return ()


@cache
def _code_of_package(package: str) -> bytes:
    sources = _sources(package)
    if not sources:
        expected = "a module in a file"
        raise InputError("the code of a plug-in cannot be read", where=package, got="no file", expected=expected)
    state = blake2b(digest_size=DIGEST_BYTES)
    for name, path in sources:
        for part in (name.encode(), _read(path).replace(b"\r\n", b"\n")):
            state.update(len(part).to_bytes(8, "little"))
            state.update(part)
    return state.digest()


def _sources(package: str) -> list[tuple[str, Path]]:
    """Return the names and paths of a package's files; empty if it is in none."""
    places = _places(package)
    if places and not places[0].is_dir():
        return [("", places[0])]
    return sorted((path.relative_to(folder).as_posix(), path) for folder in places for path in _python_files(folder))


@cache
def _python_files(folder: Path) -> list[Path]:
    """Return the ``.py`` files in a folder and in those within it, except hidden ones and those of libraries."""
    found = []
    for parent, folders, files in os.walk(folder):
        here = Path(parent)
        folders[:] = [name for name in folders if not name.startswith(".") and name not in INSTALLED]
        folders[:] = [name for name in folders if not (here / name / ENVIRONMENT).exists()]
        found += [here / name for name in files if name.endswith(".py") and not name.startswith(".")]
    # A link may lead nowhere.
    return [path for path in found if path.is_file()]


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError("the code of a plug-in cannot be read", where=path, got=error.strerror) from error


def _has_code(package: str) -> bool:
    return bool(_sources(package))


def _places(package: str) -> list[Path]:
    """Return the folders of a package, or the file of a module; empty if it is in no file."""
    module = sys.modules.get(package)
    if package == MAIN:
        # While a spawned process runs the main script, its own main module is another.
        module = sys.modules.get(SPAWNED_MAIN, module)
    if module is None:
        spec = _find(package)
        folders, file = (spec.submodule_search_locations, spec.origin) if spec else (None, None)
    else:
        folders, file = getattr(module, "__path__", None), getattr(module, "__file__", None)
    if folders:
        return [Path(folder) for folder in folders]
    return [Path(file)] if file is not None and Path(file).is_file() else []


def _find(name: str) -> ModuleSpec | None:
    try:
        return find_spec(name)
    except (ImportError, ValueError):
        return None
