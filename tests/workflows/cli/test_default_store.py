"""The store of a user who names none."""

import pytest

from moseg.store import open_store
from moseg.workflows.api.run_settings import read_run_settings
from moseg.workflows.config.default_store import default_store

SETTINGS = {"workers": 0, "threads": 1, "batch": None, "device": "cpu", "offline": True}
LICENCES = {"non_commercial": False, "accept_licence": None}
NONE = dict.fromkeys(("scheduler", "tls_ca", "tls_cert", "tls_key"))


@pytest.fixture
def user(tmp_path, monkeypatch):
    """Set a home folder, and no variable that names a store."""
    monkeypatch.delenv("MOSEG_STORE")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setattr("sys.platform", "linux")
    return tmp_path / "home"


def test_it_is_in_the_cache_folder_of_the_platform(user, monkeypatch, tmp_path):
    assert default_store() == str(user / ".cache/moseg/store")
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert default_store() == str(user / ".cache/moseg/store")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert default_store() == str(tmp_path / "cache/moseg/store")
    monkeypatch.setattr("sys.platform", "darwin")
    assert default_store() == str(user / "Library/Caches/moseg/store")


def test_a_variable_names_another(user, monkeypatch):
    monkeypatch.setenv("MOSEG_STORE", "s3://bucket/moseg")
    assert default_store() == "s3://bucket/moseg"


@pytest.mark.usefixtures("in_empty_folder")
def test_the_commands_read_it_from_any_folder(user, moseg, put_number):
    ref = put_number(default_store())
    assert moseg("store", "ls").out == f"{ref}\n"
    assert moseg("store", "ls", "--store", "elsewhere").code == 2
    assert str(user) not in moseg("store", "ls", "--help").out


@pytest.mark.usefixtures("user")
def test_python_reads_the_same():
    assert read_run_settings(store=None, progress=False, **SETTINGS, **LICENCES, **NONE).store == default_store()
    assert read_run_settings(store="here", progress=False, **SETTINGS, **LICENCES, **NONE).store == "here"


def test_an_empty_name_is_bad_input(moseg):
    ran = moseg("store", "ls", "--store", "")
    assert ran.code == 2
    assert "no artifact store named" in ran.err


@pytest.fixture
def put_number():
    from moseg.schemas.recipes import Recipe

    def put(url):
        recipe = Recipe(task="toy", version=1)
        open_store(url).put(recipe, {}, dims={})
        return recipe.ref

    return put
