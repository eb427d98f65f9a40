"""Arithmetic in case files: columns and constants, without any other operation."""

from __future__ import annotations

import ast
import math
import warnings
from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt

from wingcrack.errors import CaseError

Array = npt.NDArray[np.float64]

FUNCTIONS: dict[str, Callable[..., Array]] = {
    "sqrt": np.sqrt,
    "abs": np.abs,
    "exp": np.exp,
    "log": np.log,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "erf": np.vectorize(math.erf, otypes=[np.float64]),
    "erfc": np.vectorize(math.erfc, otypes=[np.float64]),
    "hypot": np.hypot,
    "minimum": np.minimum,
    "maximum": np.maximum,
    "radians": np.radians,
    "degrees": np.degrees,
}

_OPERATIONS: dict[type[ast.operator], Callable[[Array, Array], Array]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
}


def names_in(text: str) -> set[str]:
    """Names that an expression uses: columns, constants and functions."""
    return {node.id for node in ast.walk(_parse(text)) if isinstance(node, ast.Name)}


def evaluate(text: str, values: Mapping[str, Array | float]) -> Array:
    """Value of an expression; what is no number (1/0, sqrt(-1)) comes out as nan or inf.

    Raises `CaseError` if the text is no arithmetic, or if a name is unknown.
    """
    tree = _parse(text).body
    try:
        with np.errstate(all="ignore"):
            return np.asarray(_value(tree, values, text), dtype=np.float64)
    except (RecursionError, OverflowError):
        raise CaseError(f"{_short(text)} is too deep, or has too large a whole number") from None


def _parse(text: str) -> ast.Expression:
    try:
        with warnings.catch_warnings(action="ignore", category=SyntaxWarning):
            return ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):  # too deep; with a zero byte
        raise CaseError(f"{_short(text)} is no arithmetic expression, or too long") from None


def _short(text: str) -> str:
    return repr(text if len(text) <= 80 else f"{text[:77]}...")


def _value(node: ast.expr, values: Mapping[str, Array | float], text: str) -> Array:
    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as number):
            return np.asarray(number, dtype=np.float64)
        case ast.Name(id=name):
            if name == "pi":
                return np.asarray(math.pi)
            if name in values:
                return np.asarray(values[name], dtype=np.float64)
            there = ", ".join(sorted(values)) or "none"
            raise CaseError(f"'{name}' in {_short(text)} is missing (there are: {there})")
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_value(operand, values, text)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _value(operand, values, text)
        case ast.BinOp(left=left, op=operation, right=right) if type(operation) in _OPERATIONS:
            operate = _OPERATIONS[type(operation)]
            return operate(_value(left, values, text), _value(right, values, text))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in FUNCTIONS:
            operands = [_value(argument, values, text) for argument in arguments]
            if len(operands) != getattr(FUNCTIONS[name], "nin", 1):
                raise CaseError(f"'{name}' in {_short(text)} has the wrong number of arguments")
            return np.asarray(FUNCTIONS[name](*operands), dtype=np.float64)
        case _:
            pass
    raise CaseError(f"{_short(text)} holds what no expression may: {_short(ast.unparse(node))}")
