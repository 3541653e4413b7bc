"""Mapping of the packages below `moseg` to the folders at the top of the checkout."""

from setuptools import find_packages, setup

FOLDERS = {
    "moseg.schemas": "schemas",
    "moseg.store": "store",
    "moseg.tasks": "moseg_tasks",
    "moseg.workflows": "workflows",
}
FRONT = "workflows/api/moseg"

inner = [
    f"{package}.{name}" for package, folder in FOLDERS.items() for name in find_packages(folder, exclude=["api.moseg"])
]
setup(packages=["moseg", *FOLDERS, *inner], package_dir={"moseg": FRONT, **FOLDERS})
