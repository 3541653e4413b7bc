"""Files appear whole or not at all, whatever their names."""

import errno
import os
from pathlib import Path

import pytest

from moseg.schemas.errors import InputError, MosegError, StoreError
from moseg.workflows.exports import write_text
from moseg.workflows.process.atomic_write import atomic_path, blame_output


def test_a_name_as_long_as_the_system_allows_is_written(tmp_path):
    path = tmp_path / ("n" * os.pathconf(tmp_path, "PC_NAME_MAX"))
    write_text(path, "all of it")
    assert path.read_text() == "all of it"
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def _write_half(path):
    path.write_text("ne")
    raise InputError("half way")


def test_a_failure_leaves_the_old_file_and_nothing_half_written(tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("old")
    with pytest.raises(InputError, match="half way"), atomic_path(path) as temporary:
        _write_half(temporary)
    assert [entry.read_text() for entry in tmp_path.iterdir()] == ["old"]


def test_the_first_error_is_the_one_reported(tmp_path, monkeypatch):
    def refuse(self, missing_ok=False):
        raise PermissionError("cannot be removed")

    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(RuntimeError, match="half way"), atomic_path(tmp_path / "notes.txt"):
        raise RuntimeError("half way")


@pytest.mark.parametrize(
    ("number", "kind"),
    [
        (errno.ENOSPC, StoreError),
        (errno.EDQUOT, StoreError),
        (errno.EIO, StoreError),
        (errno.EACCES, InputError),
        (errno.EROFS, InputError),
    ],
)
def test_a_disk_that_is_full_or_fails_is_no_bad_input(tmp_path, number, kind):
    with (
        pytest.raises(MosegError, match=r"cannot write in .*notes.txt") as caught,
        blame_output(tmp_path / "notes.txt"),
    ):
        raise OSError(number, os.strerror(number))
    assert type(caught.value) is kind and os.strerror(number) in str(caught.value)


def test_a_full_disk_of_the_results_ends_with_one_line_and_exit_code_1(moseg, squares, tmp_path, monkeypatch):
    replace = os.replace

    def refuse(source, target, **options):
        if "masks" in Path(target).parts:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        replace(source, target, **options)

    monkeypatch.setattr(os, "replace", refuse)
    frames, out = squares / "squares" / "frames", tmp_path / "out"
    quick = ("--quality", "fast", "--set", "max_side=32", "--quiet", "--store", tmp_path / "store")
    ran = moseg("segment", frames, "--out", out, *quick)
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "cannot write in" in ran.err and "No space left on device" in ran.err
    assert [path for path in out.rglob("*") if path.is_file()] == []
