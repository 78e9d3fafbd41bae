"""Every example runs, and every public function has one."""

import doctest
import importlib
import inspect
import pkgutil
import re
from pathlib import Path

import pytest

import phicam

MODULES = [
    importlib.import_module(f"phicam.{module.name}")
    for module in pkgutil.iter_modules(phicam.__path__)
    if module.name != "_native"
]


EXAMPLES = [example for module in [phicam, *MODULES] for example in doctest.DocTestFinder().find(module) if example.examples]


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.name)
def test_examples(example):
    if any("import mitsuba" in line.source for line in example.examples):
        pytest.importorskip("mitsuba")
    assert doctest.DocTestRunner().run(example).failed == 0


def test_every_function_has_an_example():
    functions = {name: getattr(phicam, name) for name in phicam.__all__ if inspect.isfunction(getattr(phicam, name))}
    assert len(functions) >= 15
    for name, cls in ((name, getattr(phicam, name)) for name in phicam.__all__ if inspect.isclass(getattr(phicam, name))):
        functions |= {f"{name}.{key}": cls.__dict__[key] for key, _ in inspect.getmembers(cls) if key in vars(cls) and key[0] != "_"}
    # Of classes the functions; what is there or is computed once takes no arguments, and is documented.
    plain = (inspect.isfunction, inspect.ismethod, lambda member: isinstance(member, (classmethod, staticmethod)))
    functions = {name: member for name, member in functions.items() if any(kind(member) for kind in plain)}
    assert len(functions) >= 40
    assert [name for name, member in functions.items() if ">>>" not in (inspect.getdoc(member) or "")] == []


def test_every_public_method_is_documented():
    classes = [getattr(phicam, name) for name in phicam.__all__ if inspect.isclass(getattr(phicam, name))]
    bare = [
        f"{cls.__name__}.{name}"
        for cls in classes
        for name, member in vars(cls).items()
        if not name.startswith("_") and (callable(member) or isinstance(member, property)) and not inspect.getdoc(member)
    ]
    assert bare == []


@pytest.mark.parametrize("folder", [1, 2], ids=["python", "phicam"])
def test_readme(folder):
    text = (Path(__file__).parents[folder] / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert blocks
    for block in blocks:
        names: dict = {}
        exec(block, names)
        assert names["verdict"].agrees


def test_one_version():
    root = Path(__file__).parents[2]
    stated = re.search(r'(?m)^version = "(.*)"$', (root / "Cargo.toml").read_text(encoding="utf-8"))[1]
    assert phicam.__version__ == stated
    assert f"version: {stated}" in (root / "CITATION.cff").read_text(encoding="utf-8")
