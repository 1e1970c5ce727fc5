"""TOML tables whose error messages name file, line and key."""

from __future__ import annotations

import codecs
import difflib
import re
import tomllib
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from runway_modal._core import InputError
from runway_modal._input import integer

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from runway_modal.units import Dimension, Units


def read_toml(path: Path) -> Table:
    """Read a file; `InputError` if it is not TOML."""
    data = path.read_bytes()
    # PowerShell redirects output to files in UTF-16.
    wide = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        text = data.decode("utf-16" if wide else "utf-8-sig").replace("\r\n", "\n")
        return Table(path, text, (), tomllib.loads(text))
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(f"{path}:{line}: not UTF-8 text") from None
    except (ValueError, RecursionError) as error:
        twice = (
            "; a list of tables has [[...]] at each of them" if "overwrite" in str(error) else ""
        )
        raise InputError(f"{path}: {error}{twice}") from None


_REQUIRED: Any = object()


@dataclass(frozen=True, slots=True)
class Table:
    """One table of a case file; hands out checked values and knows their place in the file."""

    path: Path
    source: str
    keys: tuple[str | int, ...]
    values: dict[str, Any]

    def where(self, key: str | None = None) -> str:
        """Name the place of a key as TOML does, arrays counted from 0."""
        keys = self.keys if key is None else (*self.keys, key)
        return "".join(f"[{k}]" if isinstance(k, int) else f".{k}" for k in keys).lstrip(".")

    def fault(self, what: str, key: str | None = None) -> InputError:
        """Make the error that names file, line and table."""
        keys = (*self.keys, key) if key is not None and key in self.values else self.keys
        line = _line(self.source, keys)
        place = f"{self.path}:{line}" if line else f"{self.path}"
        return _Located(": ".join(part for part in (place, self.where(), what) if part))

    @contextmanager
    def located(self, key: str | None = None) -> Iterator[None]:
        """Add file, line and key to the library's errors, and the value as written in the file."""
        try:
            yield
        except _Located:
            raise
        except InputError as error:
            said = str(error)
            one = re.match(r"(\w+)\[(\d+)\]\.(\w+)", said)
            if one and one[1] in self.values:
                raise self.tables(one[1])[int(one[2])].fault(said, one[3]) from None
            # The library's messages begin with the argument's name: the key, if none is given.
            named = re.match(r"\w+(?=[ [:])", said)
            if named and key:
                said = key + said[named.end() :]
            key = key or (named[0] if named else "")
            raise self.fault(said + self._as_written(key, said), key) from None

    def _as_written(self, key: str, said: str) -> str:
        """Quote a value as written in the file, if the message gives it in other units."""
        value, shown = self.values.get(key), re.match(r"\w+ = (\S+)", said)
        if not shown or not isinstance(value, str | int | float) or f"= {value!r}" in said:
            return ""
        with suppress(ValueError):
            if not isinstance(value, str) and float(shown[1]) == value:
                return ""
        return f"; the file says {key} = {value!r}"

    def only(self, *allowed: str) -> None:
        """Refuse unknown keys."""
        for key in self.values:
            if key not in allowed:
                raise self.fault(f"unknown key {key!r}{hint(key, allowed)}", key)

    def get(self, key: str, default: Any = _REQUIRED) -> Any:
        """Give a value of any kind."""
        value = self.values.get(key, default)
        if value is _REQUIRED:
            raise self.fault(f"{key} is missing")
        return value

    def text(self, key: str, default: Any = _REQUIRED) -> str:
        """Give a string that is not empty."""
        value = self.get(key, default)
        if not isinstance(value, str):
            raise self.fault(f"{key} = {value!r} is not a string", key)
        if not value or "\0" in value:
            raise self.fault(f"{key} = {value!r} is empty or contains a null character", key)
        return value

    def choice(self, key: str, allowed: tuple[str, ...], default: Any = _REQUIRED) -> str:
        """Give one of the strings allowed."""
        value = self.get(key, default)
        if value not in allowed:
            raise self.fault(f"{key} = {value!r} is unknown{hint(value, allowed)}", key)
        return str(value)

    def flag(self, key: str) -> bool:
        """Give true or false; false if the key is missing."""
        value = self.get(key, False)
        if not isinstance(value, bool):
            raise self.fault(f"{key} = {value!r} is not true or false", key)
        return value

    def whole(self, key: str, least: int, default: Any = _REQUIRED) -> int:
        """Give a whole number."""
        value = self.get(key, default)
        if isinstance(value, bool):  # 0 or 1 to Python
            raise self.fault(f"{key} = {value!r} is not a whole number", key)
        with self.located(key):
            return integer(key, value, least)

    def quantity(
        self, key: str, dimension: Dimension, units: Units, default: Any = _REQUIRED
    ) -> Any:
        """Give a number, converted to the case's units."""
        value = self.get(key, default)
        if key not in self.values:
            return value
        with self.located():
            return units.quantity(key, value, dimension)

    def positive(
        self, key: str, dimension: Dimension, units: Units, default: Any = _REQUIRED
    ) -> Any:
        """Give a number > 0, converted to the case's units."""
        value = self.quantity(key, dimension, units, default)
        if key in self.values and not value > 0.0:
            raise self.fault(f"{key} = {self.values[key]!r} is not positive", key)
        return value

    def quantities(self, key: str, dimension: Dimension, units: Units) -> list[float]:
        """Give a list of numbers, converted to the case's units."""
        values = self.get(key)
        if not isinstance(values, list):
            raise self.fault(f"{key} = {values!r} is not a list", key)
        with self.located():
            return [
                units.quantity(f"{key}[{i}]", value, dimension) for i, value in enumerate(values)
            ]

    def table(self, key: str, default: Any = _REQUIRED) -> Table:
        """Give a table."""
        value = self.get(key, default)
        if not isinstance(value, dict):
            raise self.fault(f"{key} is not a table: [{self.where(key)}]", key)
        return Table(self.path, self.source, (*self.keys, key), value)

    def tables(self, key: str, default: Any = _REQUIRED) -> list[Table]:
        """Give a list of tables."""
        values = self.get(key, default)
        if not isinstance(values, list) or not all(isinstance(v, dict) for v in values):
            raise self.fault(f"{key} is not a list of tables: [[{self.where(key)}]]", key)
        return [
            Table(self.path, self.source, (*self.keys, key, i), value)
            for i, value in enumerate(values)
        ]


class _Located(InputError):
    """Names its place already."""


#: Possible ends of a statement that spans several lines.
_ENDS = ("]", "}", '"', "'")


def _line(source: str, keys: tuple[str | int, ...]) -> int | None:
    """Line of the statement that defines a key: tomllib itself reads statement by statement."""
    lines = source.split("\n")
    table: tuple[str | int, ...] = ()
    lengths: dict[tuple[str | int, ...], int] = {}
    begin = 0
    for end, line in enumerate(lines, 1):
        if end > begin + 1 and not line.partition("#")[0].rstrip().endswith(_ENDS):
            continue
        try:
            found: Any = tomllib.loads("\n".join(lines[begin:end]))
        except tomllib.TOMLDecodeError:
            continue
        first, begin = begin, end
        if lines[first].lstrip().startswith("["):
            table = _header(found, lengths)
            if keys and table[: len(keys)] == keys:
                return first + 1
        elif keys[: len(table)] == table and _holds(found, keys[len(table) :]):
            return first + 1
    return None


def _header(found: Any, lengths: dict[tuple[str | int, ...], int]) -> tuple[str | int, ...]:
    """Keys of the table that a header opens; counts the tables of each array of tables."""
    table: tuple[str | int, ...] = ()
    while found:
        ((name, found),) = found.items()
        table = (*table, name)
        if isinstance(found, list):
            lengths[table] = lengths.get(table, 0) + 1
            found = found[0]
        if table in lengths:
            table = (*table, lengths[table] - 1)
    return table


def _holds(found: Any, keys: tuple[str | int, ...]) -> bool:
    """Whether a statement's values have these keys."""
    try:
        for key in keys:
            found = found[key]
    except (KeyError, IndexError, TypeError):
        return False
    return bool(keys)


def hint(name: object, allowed: Iterable[str]) -> str:
    """Guess which name was meant, and list all."""
    allowed = tuple(allowed)
    near = difflib.get_close_matches(str(name), allowed, 1)
    guess = f"; did you mean {near[0]!r}?" if near else ""
    return f"{guess} Allowed: {', '.join(allowed)}" if guess else f"; allowed: {', '.join(allowed)}"
