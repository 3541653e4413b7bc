"""URLs of object stores, their environment, and the one line that names an error."""

import pickle
import subprocess
import sys

import obstore
import pytest

from moseg.schemas.errors import InputError, MissingStoreError, StoreChoiceError, StoreError
from moseg.store import open_store
from moseg.store.names import CONTENT, MARKER
from moseg.store.remote import connection
from moseg.store.remote.connection import connect, s3_settings
from moseg.store.remote.requests import Requests, requests_for

SECRET = "a-secret-of-mine"


def fails(url: str, match: str) -> InputError:
    with pytest.raises(InputError, match=match) as caught:
        open_store(url)
    assert "\n" not in str(caught.value) and SECRET not in str(caught.value)
    return caught.value


def test_an_empty_prefix_becomes_a_store_and_stays_one(s3):
    with pytest.raises(MissingStoreError):
        open_store(s3, create=False)
    assert obstore.list(connect(s3)).collect() == []
    assert open_store(f"{s3}/").url == open_store(s3, create=False).url == s3


def test_a_prefix_with_other_objects_is_refused_and_not_changed(s3):
    obstore.put(connect(s3), "thesis.tex", b"text")
    for create in (True, False):
        with pytest.raises(StoreChoiceError, match=r"not an artifact store .*thesis\.tex"):
            open_store(s3, create=create)
    assert [item["path"] for item in obstore.list(connect(s3)).collect()] == ["thesis.tex"]


@pytest.mark.parametrize("first", ["logs/run/0.jsonl", "objects/toy/0"])
@pytest.mark.parametrize("create", [True, False])
def test_a_store_that_another_process_makes_meanwhile_is_opened(s3, monkeypatch, create, first):
    look_up, client = Requests.get, connect(s3)

    def look_up_early(requests, name):
        content = look_up(requests, name)
        obstore.put(client, MARKER, CONTENT)
        obstore.put(client, first, b"")
        return content

    monkeypatch.setattr(Requests, "get", look_up_early)
    assert open_store(s3, create=create).url == s3


@pytest.mark.parametrize("content", [b'{"store": "moseg artifacts", "format": 3}', b"{}", b""])
def test_an_unknown_format_is_refused(s3, content):
    obstore.put(connect(s3), "moseg-store.json", content)
    fails(s3, r"moseg-store\.json")


def test_a_missing_bucket_is_named(s3):
    fails("s3://no-such-bucket/p", "no such bucket in s3://no-such-bucket/p")


def test_a_missing_server_is_named(s3, monkeypatch):
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:9")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", SECRET)
    fails(s3, "cannot connect to http://127.0.0.1:9")


def test_the_command_line_ends_with_2_and_one_line_if_the_store_cannot_be_opened(s3, moseg):
    ran = moseg("store", "ls", "--store", "s3://no-such-bucket/p")
    assert ran.code == 2 and ran.out == ""
    assert ran.err.strip().count("\n") == 0 and "no such bucket" in ran.err


def test_a_server_that_stops_is_a_fault_and_not_bad_input(s3, put_toy, monkeypatch):
    store = open_store(s3)
    ref = put_toy(store)
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:9")
    monkeypatch.setitem(connection._RETRIES, "max_retries", 1)
    # the connection of a server that has stopped
    monkeypatch.setitem(store._requests.__dict__, "_client", connect(s3))
    for call in (
        lambda: store.has(ref),
        lambda: store.present([ref, ref.replace("toy", "tea")]),
        lambda: store.read(ref, "x"),
        lambda: list(store.refs()),
        lambda: store.append_log("run", b"line\n"),
    ):
        with pytest.raises(StoreError, match=f"cannot connect .* in {s3}") as caught:
            call()
        assert not isinstance(caught.value, InputError) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("url", "match"),
    [
        (f"s3://key:{SECRET}@bucket/p", "credentials in a store's URL"),
        (f"s3://{SECRET}@bucket/p", "credentials in a store's URL"),
        (f"s3://bucket/p?sig={SECRET}", "more than a path"),
        ("s3://", "bad bucket"),
        ("s3:///prefix", "bad bucket"),
        ("s3://bücket/p", "bad bucket"),
        ("s3://bucket//p", "empty path segment"),
        (f"https://key:{SECRET}@server/p", "unsupported artifact store"),
        ("http://server/p", "unsupported artifact store"),
        ("memory:///p", "unsupported artifact store"),
    ],
)
def test_an_invalid_url_is_bad_input_and_secrets_are_not_repeated(s3, url, match):
    fails(url, match)


@pytest.mark.parametrize("endpoint", ["nonsense", "ftp://server", "http://", f"http://key:{SECRET}@server"])
def test_a_bad_address_of_a_server_is_named(s3, monkeypatch, endpoint):
    monkeypatch.setenv("AWS_ENDPOINT_URL", endpoint)
    fails(s3, "AWS_ENDPOINT_URL")


def test_without_credentials_the_error_names_the_variables_to_set(s3, monkeypatch, tmp_path):
    monkeypatch.delenv("AWS_ACCESS_KEY_ID")
    monkeypatch.delenv("AWS_SECRET_ACCESS_KEY")
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    for name in ("AWS_CONFIG_FILE", "AWS_SHARED_CREDENTIALS_FILE"):
        monkeypatch.setenv(name, str(tmp_path / "none"))
    connection._boto_session.cache_clear()
    fails(s3, f"no credentials in {s3}.*AWS_ACCESS_KEY_ID")
    monkeypatch.setenv("AWS_PROFILE", "nobody")
    fails(s3, f"no credentials: .*nobody.* in {s3}")


def test_a_profile_gives_keys_region_and_server(s3, monkeypatch, tmp_path, put_toy):
    endpoint = connection.os.environ["AWS_ENDPOINT_URL"]
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY", "AWS_ENDPOINT_URL", "AWS_REGION"):
        monkeypatch.delenv(name)
    config = tmp_path / "config"
    config.write_text(
        f"[profile lab]\nregion = eu-central-1\nendpoint_url = {endpoint}\n"
        f"aws_access_key_id = of-a-profile\naws_secret_access_key = {SECRET}\n"
    )
    monkeypatch.setenv("AWS_CONFIG_FILE", str(config))
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(tmp_path / "none"))
    monkeypatch.setenv("AWS_PROFILE", "lab")
    connection._boto_session.cache_clear()
    settings, provider = s3_settings(connection.os.environ)
    assert settings == {"region": "eu-central-1", "endpoint": endpoint}
    assert provider()["access_key_id"] == "of-a-profile"
    store = open_store(s3)
    assert store.has(put_toy(store))


def test_the_endpoint_for_s3_has_priority_over_the_general_one():
    environ = {"AWS_ACCESS_KEY_ID": "k", "AWS_ENDPOINT_URL": "http://all", "AWS_DEFAULT_REGION": "b"}
    assert s3_settings(environ) == ({"region": "b", "endpoint": "http://all"}, None)
    environ |= {"AWS_ENDPOINT_URL_S3": "http://s3:9000/", "AWS_REGION": "a"}
    assert s3_settings(environ) == ({"region": "a", "endpoint": "http://s3:9000"}, None)


def test_a_pickled_store_has_no_credentials_and_shares_the_client_of_its_process(s3, monkeypatch):
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", SECRET)
    store = open_store(s3)
    data = pickle.dumps(store)
    assert SECRET.encode() not in data and b"test-key" not in data
    assert pickle.loads(data)._requests is store._requests is requests_for(s3)
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "another")
    assert pickle.loads(data)._requests is not store._requests


def test_modules_for_object_stores_are_imported_only_for_such_a_store():
    code = (
        "import sys, moseg.store, moseg.workflows.cli.app\n"
        "assert not {'obstore', 'boto3', 'botocore', 'moseg.store.remote'} & sys.modules.keys()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
