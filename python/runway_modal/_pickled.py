"""Results that stay read-only when they are pickled or copied."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from ._input import read_only

if TYPE_CHECKING:
    from collections.abc import Callable


class Pickled:
    """A dataclass of results; NumPy alone would make its pickled arrays writeable."""

    __slots__ = ()

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        """Pickle by the fields."""
        values = {each.name: getattr(self, each.name) for each in fields(self)}  # type: ignore[arg-type]
        return _made_again, (type(self), values)


def _made_again(kind: type, values: dict[str, Any]) -> Any:
    for value in values.values():
        for each in value.values() if isinstance(value, dict) else (value,):
            if isinstance(each, np.ndarray):
                read_only(each)
    return kind(**values)
