"""Lines that faults are named with, against the TOML parser's own word on prefixes."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import runway_modal as rm
from runway_modal.case.toml import _line, read_toml

SOURCE = '''# comment
title = "x # ]"
a.b = 1 # dotted

[units]
length = "in"
[aircraft]
mass = [
 1, # ]
 2,
 [3,
 4],
]
text = """
foo
[track]
"""
[aircraft.stations]
pilot = [1,
  2]
"odd key" = 3
[[aircraft.gears]]
name = "a"
[[aircraft.gears]]
name = "b"
[aircraft.gears.sub]
z = {q = [{r = 1},
 {r = 2}]}
[[track]]
x = 1
[[track]]
x = 2
[track.deep.er]
k = 1
[last]
'''


def places(values: Any, keys: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Every key and index there is."""
    pairs = values.items() if isinstance(values, dict) else enumerate(values)
    for key, value in pairs:
        yield (*keys, key)
        if isinstance(value, dict | list):
            yield from places(value, (*keys, key))


def line_by_prefixes(keys: tuple[str | int, ...]) -> int | None:
    """First line after the longest prefix without the key: slow, and right by definition."""
    lines, begin = SOURCE.split("\n"), 0
    for end in range(1, len(lines) + 1):
        try:
            found: Any = tomllib.loads("\n".join(lines[:end]))
        except tomllib.TOMLDecodeError:
            continue
        try:
            for key in keys:
                found = found[key]
        except (KeyError, IndexError, TypeError):
            begin = end
        else:
            return begin + 1
    return None


@pytest.mark.parametrize("keys", list(places(tomllib.loads(SOURCE))), ids=str)
def test_every_key_is_found_on_its_line(keys: tuple[str | int, ...]) -> None:
    assert _line(SOURCE, keys) == line_by_prefixes(keys)


def test_no_such_key() -> None:
    assert _line(SOURCE, ("units", "force")) is None
    assert _line(SOURCE, ()) is None


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_what_windows_writes_is_read(tmp_path: Path, encoding: str, end: str) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(SOURCE.replace("\n", end).replace("foo", "Ü\u2028").encode(encoding))
    table = read_toml(path)
    assert table.values["aircraft"]["text"] == "Ü\u2028\n[track]\n"
    assert "a.toml:5: " in str(table.fault("?", "units"))
    assert "a.toml:35: " in str(table.fault("?", "last"))


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"a = 1\nb = '\xff'\n", ":2: not UTF-8 text"),
        (b"a = 1\nb = \n", r"line 2"),
        (b"a = 1" + b"0" * 5000, "digits"),
        (b"a = " + b"[" * 5000, "recursion"),
        (b"a = 1\0", "line 1"),
    ],
)
def test_what_is_not_toml_is_refused(tmp_path: Path, data: bytes, said: str) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(data)
    with pytest.raises(rm.InputError, match=said):
        read_toml(path)
