"""What an error says is one line, whatever it quotes."""

import pickle

from moseg.schemas.errors import InputError


def test_control_characters_of_a_file_are_written_out():
    error = InputError("not a name", where="a\nb.txt", got="\x1b[31mred\r\x00", expected="é, 映像 or \udcfc")
    assert str(error) == "not a name in a b.txt; got \\x1b[31mred\\r\\x00; expected é, 映像 or \udcfc"
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_a_name_of_millions_of_characters_is_truncated():
    line = str(InputError("no such name", got="n" * 10**6, expected="a name"))
    assert line.endswith("nnn…; expected a name") and len(line) < 3000
