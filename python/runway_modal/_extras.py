"""Optional dependencies."""

from __future__ import annotations

from importlib.util import find_spec


def need(what: str, extra: str, *modules: str) -> None:
    """Raise an `ImportError` that names the extra if a module is missing; `what` is plural."""
    missing = [module for module in modules if find_spec(module) is None]
    if missing:
        names = " and ".join(missing)
        raise ImportError(f"{what} need {names}: pip install 'runway_modal[{extra}]'")
