"""Every public name is documented: summary, parameters, returns, raises, an example."""

import ast
import functools
import importlib
import inspect
import pkgutil
import textwrap
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from numpydoc.validate import validate

import runway_modal

PYPROJECT = Path(__file__).parents[1] / "pyproject.toml"
CHECKS = set(tomllib.loads(PYPROJECT.read_text())["tool"]["numpydoc_validation"]["checks"])

#: Call such functions with arguments that are always right.
UNFAILING = {"runway_modal.report1980.main"}

#: Read like attributes: no call, so no example of one.
ATTRIBUTES = (property, functools.cached_property)


def public() -> dict[str, object]:
    """Classes and functions named in any `__all__`, with the members of the classes."""
    package = runway_modal.__name__
    inner = (f"{package}.{module.name}" for module in pkgutil.iter_modules(runway_modal.__path__))
    found = {}
    for module in (package, *(name for name in inner if "._" not in name)):
        members = importlib.import_module(module)
        for name in getattr(members, "__all__", ()):
            value = getattr(members, name)
            if inspect.isfunction(value):
                found[f"{module}.{name}"] = value
            # The compiled classes in it are the exceptions: nothing to call.
            if inspect.isclass(value) and not issubclass(value, Exception):
                found[f"{module}.{name}"] = value
                found |= {
                    f"{module}.{name}.{member}": inner
                    for base in reversed(value.__mro__)
                    if base.__module__.startswith(package)
                    for member, inner in vars(base).items()
                    if not member.startswith("_") and is_documentable(inner)
                }
    return found


def is_documentable(member: object) -> bool:
    kinds = (*ATTRIBUTES, classmethod, staticmethod)
    return inspect.isfunction(member) or isinstance(member, kinds)


def raises(function: Callable[..., object]) -> bool:
    """Whether a function's own text raises anything."""
    return any(isinstance(node, ast.Raise) for node in ast.walk(parsed(function)))


def called(function: ast.AST) -> set[str]:
    """Names of the functions called."""
    calls = (node.func for node in ast.walk(function) if isinstance(node, ast.Call))
    return {call.id for call in calls if isinstance(call, ast.Name)}


def helpers() -> set[str]:
    """Functions of the package that raise `InputError`, or call one that does."""
    functions = [
        node
        for file in Path(runway_modal.__file__).parent.rglob("*.py")
        for node in ast.parse(file.read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef)
    ]
    found: set[str] = set()
    while more := {one.name for one in functions if called(one) & (found | {"InputError"})} - found:
        found |= more
    return found


HELPERS = helpers()


def refuses(function: Callable[..., object]) -> bool:
    """Whether a function checks an argument: with a helper, or by handing on its `units`."""
    return (
        bool(called(parsed(function)) & (HELPERS | {"InputError"}))
        or "units" in inspect.signature(function).parameters
    )


def parsed(function: Callable[..., object]) -> ast.AST:
    return ast.parse(textwrap.dedent(inspect.getsource(function)))


PUBLIC = public()


@pytest.mark.parametrize("name", PUBLIC)
def test_documented(name: str) -> None:
    value = PUBLIC[name]
    skipped = {"EX01"} if isinstance(value, ATTRIBUTES) else set()
    result = validate(name)
    wrong = [f"{code}: {text}" for code, text in result["errors"] if code in CHECKS - skipped]
    assert not wrong, f"{name} in {result['file']}:{result['file_line']}"
    function = getattr(value, "__func__", value)
    if not inspect.isfunction(function):
        return
    _, _, said = inspect.getdoc(function).partition("Raises\n------\n")
    assert said or not raises(function), f"{name} raises; Raises is missing"
    if name not in UNFAILING:
        assert "InputError\n" in said or not refuses(function), f"{name}: InputError is missing"
