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


@pytest.mark.parametrize("module", [phicam, *MODULES], ids=lambda module: module.__name__)
def test_examples(module):
    found = doctest.testmod(module)
    assert found.failed == 0


def test_every_function_has_an_example():
    functions = [name for name in phicam.__all__ if inspect.isfunction(getattr(phicam, name))]
    assert len(functions) >= 15
    without = [name for name in functions if ">>>" not in (getattr(phicam, name).__doc__ or "")]
    assert without == []


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
