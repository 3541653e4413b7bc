"""Any scheduler can be reached, with or without TLS; one that cannot is refused at once, in one line."""

import json
import socket
import threading
from contextlib import contextmanager

import dask
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.connection import connect
from moseg.workflows.cluster.runners import open_runner
from moseg.workflows.cluster.tls_files import TlsFiles


@contextmanager
def _server(answer):
    """A port that does with each connection what `answer` does."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve():
            while True:
                try:
                    connection, _ = server.accept()
                except OSError:
                    return
                with connection:
                    answer(connection)

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield f"127.0.0.1:{server.getsockname()[1]}"
        server.shutdown(socket.SHUT_RDWR)
    thread.join()


def _options(files):
    return [word for option, path in files.named().items() for word in (option, path)]


@pytest.fixture(scope="module")
def behind_tls(tls_files, make_cluster, tmp_path_factory):
    """A scheduler with TLS, and a worker."""
    cluster = make_cluster(tmp_path_factory.mktemp("tls-cluster"))
    try:
        cluster.start_scheduler(tls_files)
        cluster.add_worker("one")
        yield cluster
    finally:
        cluster.close()


def test_a_cluster_behind_tls_gives_the_same_results(behind_tls, tls_files, evaluated, moseg, tmp_path):
    options = ("--scheduler", behind_tls.address, *_options(tls_files), "--store", tmp_path / "store")
    ran = moseg(*evaluated.arguments, *options, "--json", tmp_path / "report.json")
    assert (ran.code, ran.err) == (0, "")
    assert json.loads((tmp_path / "report.json").read_text())["rows"] == evaluated.report["rows"]


def test_certificates_of_dasks_own_configuration_are_used(behind_tls, tls_files):
    names = {"ca-file": tls_files.ca, "client.cert": tls_files.cert, "client.key": tls_files.key}
    with dask.config.set({f"distributed.comm.tls.{name}": path for name, path in names.items()}):
        connect(behind_tls.address, TlsFiles()).close()
        connect(str(behind_tls.file), TlsFiles()).close()


def test_tls_on_one_side_only_or_untrusted_certificates_are_refused(behind_tls, cluster, tls_files, make_tls):
    with_tls, without_tls = behind_tls, cluster
    stranger = make_tls("stranger")
    with pytest.raises(InputError, match="got a port with TLS; expected tls://"):
        connect(with_tls.address.replace("tls", "tcp"), TlsFiles())
    with pytest.raises(InputError, match="got a port without TLS; expected tcp://"):
        connect(without_tls.address.replace("tcp", "tls"), tls_files)
    with pytest.raises(InputError, match=r"no TLS with the scheduler .*certificate verify failed"):
        connect(with_tls.address, stranger)
    with pytest.raises(InputError, match=r"no TLS with the scheduler .*alert"):
        connect(with_tls.address, stranger._replace(ca=tls_files.ca))
    assert connect(with_tls.address, tls_files).close() is None


def test_tls_without_usable_files_is_refused(tls_files, tmp_path, monkeypatch):
    monkeypatch.delenv("DASK_DISTRIBUTED__COMM__TLS__CA_FILE", raising=False)
    broken = tmp_path / "broken.pem"
    broken.write_text("no certificate")
    cases = [
        (TlsFiles(), "TLS needs certificates .*--tls-ca FILE"),
        (TlsFiles(ca=tls_files.ca), "TLS needs certificates"),
        (tls_files._replace(ca=str(tmp_path / "none.pem")), "no such file in --tls-ca"),
        (tls_files._replace(cert=str(broken)), "no usable certificates in --tls-ca and --tls-cert and --tls-key"),
        (tls_files._replace(key=tls_files.ca), "no usable certificates"),
    ]
    for files, expected in cases:
        with pytest.raises(InputError, match=expected):
            connect("tls://127.0.0.1:8786", files)


def test_a_command_with_certificates_and_no_tls_is_bad_use(moseg, in_empty_folder, tls_files):
    for options in (["--scheduler", "tcp://127.0.0.1:1"], ["--workers", "2"], []):
        ran = moseg("eval", *options, *_options(tls_files))
        assert ran.code == 2
        assert ran.err.startswith("moseg: certificates are for")
        assert len(ran.err.splitlines()) == 1


@pytest.mark.parametrize("address", ["127.0.0.1:port", "nowhere://127.0.0.1:8786", "tcp://", "no.json"])
def test_a_wrong_address_is_refused(address, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="--scheduler"):
        connect(address, TlsFiles())


@pytest.mark.parametrize("text", ["", "{}", "[]", "null", '{"address": 3}'])
def test_a_wrong_scheduler_file_is_refused(text, tmp_path):
    path = tmp_path / "scheduler.json"
    path.write_text(text)
    with pytest.raises(InputError, match="--scheduler"):
        connect(str(path), TlsFiles())


def test_a_port_without_a_dask_scheduler_is_refused(monkeypatch):
    for name in ("PROMPT_SEC", "GREETING_SEC", "REACH_SEC"):
        monkeypatch.setattr(f"moseg.workflows.cluster.scheduler_probe.{name}", 0.1)
    with socket.create_server(("127.0.0.1", 0)) as server:
        free = server.getsockname()[1]
    with pytest.raises(InputError, match=r"no Dask scheduler answers .*expected a running scheduler"):
        connect(f"tcp://127.0.0.1:{free}", TlsFiles())
    with (
        _server(lambda connection: connection.recv(100)) as silent,
        pytest.raises(InputError, match=r"no Dask scheduler answers .*no greeting"),
    ):
        connect(f"tcp://{silent}", TlsFiles())
    with (
        _server(lambda connection: connection.sendall(b"SSH-2.0-OpenSSH_9.6\r\n")) as other,
        pytest.raises(InputError, match="no Dask scheduler answers"),
    ):
        connect(f"tcp://{other}", TlsFiles())


def test_a_run_without_its_scheduler_leaves_no_store(moseg, in_empty_folder, tmp_path, monkeypatch):
    for name in ("PROMPT_SEC", "GREETING_SEC", "REACH_SEC"):
        monkeypatch.setattr(f"moseg.workflows.cluster.scheduler_probe.{name}", 0.1)
    with socket.create_server(("127.0.0.1", 0)) as server:
        free = server.getsockname()[1]
    ran = moseg("eval", "--scheduler", f"tcp://127.0.0.1:{free}", "--store", tmp_path / "store")
    assert ran.code == 2 and "no Dask scheduler answers" in ran.err
    assert not (tmp_path / "store").exists()


def test_a_run_waits_for_the_first_worker_of_a_cluster(cluster, capsys):
    found = {}
    with open_runner(scheduler=cluster.address) as runner:
        assert "has no workers yet" in capsys.readouterr().err
        cluster.add_worker("one")
        runner.run([Call("light-0", abs, (-1,))], found.__setitem__)
    assert found == {"light-0": 1}
