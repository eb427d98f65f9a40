"""What the Python packages import is declared: for .venv, and for the wheel, which is smaller."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator, Sequence
from fnmatch import fnmatch
from graphlib import TopologicalSorter
from importlib.metadata import packages_distributions
from typing import Any

from launcher_tree import TOP

POST = TOP / "post"
OWN = sorted(path.name for path in POST.glob("wingcrack*"))
OPTIONAL = {"imageio_ffmpeg": "imageio-ffmpeg"}  # which .venv may lack


def imports(node: ast.AST, *, at_once: bool) -> Iterator[str]:
    """Modules that code imports; `at_once` those alone that are loaded with it."""
    for child in ast.iter_child_nodes(node):
        if at_once and isinstance(child, ast.FunctionDef | ast.If):
            continue  # loaded when called; TYPE_CHECKING
        if isinstance(child, ast.Import):
            yield from (name.name for name in child.names)
        elif isinstance(child, ast.ImportFrom) and child.module and child.level == 0:
            yield child.module
        yield from imports(child, at_once=at_once)


def imported(
    packages: list[str], *, at_once: bool = False, without: Sequence[str] = ()
) -> dict[str, str]:
    """Packages that are imported, each with a file that does so; `without` parts of some names."""
    found: dict[str, str] = {}
    for package in packages:
        for path in sorted((POST / package).rglob("*.py")):
            place = ".".join(path.relative_to(POST).with_suffix("").parts)
            if any(fnmatch(place, pattern) for pattern in without):
                continue
            tree = ast.parse(path.read_text("utf-8"))
            for module in imports(tree, at_once=at_once):
                found[module.partition(".")[0]] = str(path.relative_to(POST))
    return {name: path for name, path in found.items() if name not in sys.stdlib_module_names}


def declared(requirements: list[str]) -> set[str]:
    """Names of required distributions."""
    matches = (re.match(r"[\w.-]+", line) for line in requirements)
    return {match[0].lower().replace("_", "-") for match in matches if match}


def undeclared(found: dict[str, str], requirements: list[str]) -> dict[str, str]:
    """Which of what is imported no requirement gives."""
    known = declared(requirements)
    given = packages_distributions()
    return {
        name: path
        for name, path in found.items()
        if known.isdisjoint(
            one.lower().replace("_", "-") for one in given.get(name, [OPTIONAL.get(name, name)])
        )
    }


def wheel() -> tuple[dict[str, Any], list[str], list[str]]:
    """What pyproject.toml says of the wheel, which packages are in it, and which parts are not."""
    content = tomllib.loads((TOP / "pyproject.toml").read_text("utf-8"))
    find = content["tool"]["setuptools"]["packages"]["find"]
    inside = [name for name in OWN if any(fnmatch(name, one) for one in find["include"])]
    assert "wingcrack" in inside
    return content["project"], inside, find["exclude"]


def test_the_wheel_declares_what_it_imports() -> None:
    project, inside, outside = wheel()
    extras = [line for lines in project["optional-dependencies"].values() for line in lines]
    at_once = imported(inside, at_once=True, without=outside)
    assert {"numpy", "matplotlib", "f90nml"} <= set(at_once)
    foreign = {name: path for name, path in at_once.items() if name not in inside}
    assert undeclared(foreign, project["dependencies"]) == {}
    every = {
        name: path for name, path in imported(inside, without=outside).items() if name not in inside
    }
    assert {"pandas", "pyvista"} <= set(every)
    assert undeclared(every, [*project["dependencies"], *extras]) == {}
    names = set(every) | {name.replace("_", "-") for name in every} | {"pillow"}
    assert declared([*project["dependencies"], *extras]) <= names  # and nothing in vain


def test_requirements_hold_all_that_is_imported() -> None:
    lists = [
        path for path in TOP.glob("requirements*.txt") if path.name != "requirements_developer.txt"
    ]
    lines = [line for path in lists for line in path.read_text("utf-8").splitlines()]
    foreign = {name: path for name, path in imported(OWN).items() if name not in OWN}
    assert undeclared(foreign, lines) == {}


def test_packages_need_each_other_in_one_direction() -> None:
    for own, others in {
        "wingcrack": ["wingcrack_docs", "wingcrack_maps", "wingcrack_verify"],
        "wingcrack_maps": ["wingcrack_docs", "wingcrack_verify"],
        "wingcrack_verify": ["wingcrack_docs"],
    }.items():
        assert imported([own]).keys().isdisjoint(others)


def test_what_is_in_the_wheel_needs_no_part_that_is_not() -> None:
    _, inside, outside = wheel()
    for path in (path for one in inside for path in (POST / one).rglob("*.py")):
        place = ".".join(path.relative_to(POST).with_suffix("").parts)
        if not any(fnmatch(place, pattern) for pattern in outside):
            for module in imports(ast.parse(path.read_text("utf-8")), at_once=False):
                assert not any(fnmatch(module, pattern) for pattern in outside), (place, module)


def test_no_modules_import_each_other_in_a_circle() -> None:
    modules = {
        ".".join(path.relative_to(POST).with_suffix("").parts): path
        for path in POST.glob("wingcrack*/**/*.py")
        if path.name != "__init__.py"
    }
    graph = {
        name: [
            found
            for node in ast.walk(ast.parse(path.read_text("utf-8")))
            if isinstance(node, ast.ImportFrom)
            for found in (node.module, *(f"{node.module}.{one.name}" for one in node.names))
            if found in modules
        ]
        for name, path in modules.items()
    }
    assert sum(map(len, graph.values())) > 300
    TopologicalSorter(graph).prepare()  # or CycleError, which names them


def test_an_import_that_is_not_declared_is_found() -> None:
    code = "import numpy.linalg\ndef f() -> None:\n    from f90nml import read\n"
    tree = ast.parse(code)
    assert list(imports(tree, at_once=True)) == ["numpy.linalg"]
    assert list(imports(tree, at_once=False)) == ["numpy.linalg", "f90nml"]
    assert undeclared({"f90nml": "a.py", "numpy": "b.py"}, ["numpy==2.0"]) == {"f90nml": "a.py"}
