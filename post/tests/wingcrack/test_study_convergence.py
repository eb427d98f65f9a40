"""Extrapolation of values whose limit and order are known."""

from __future__ import annotations

import numpy as np
import pytest

from wingcrack.studies.convergence import extrapolate


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0, 3.7])
@pytest.mark.parametrize("sizes", [(1.0, 2.0, 4.0), (0.3, 0.5, 1.1), (1.0, 1.5, 2.0, 40.0)])
@pytest.mark.parametrize("factor", [-3.0, 0.2])
def test_limit_and_order_are_found(order: float, sizes: tuple[float, ...], factor: float) -> None:
    size = np.array(sizes)[::-1]
    found = extrapolate(size, 7.0 + factor * size**order)
    assert found is not None
    assert found.order == pytest.approx(order, rel=1e-6)
    assert found.limit == pytest.approx(7.0, rel=1e-6)
    assert found.error == pytest.approx(abs(factor) * min(sizes) ** order, rel=1e-5)


def test_no_order_is_made_up() -> None:
    assert extrapolate([1.0, 2.0], [1.0, 2.0]) is None
    assert extrapolate([1.0, 2.0, 4.0], [1.0, 2.0, 1.5]) is None  # to and fro
    assert extrapolate([1.0, 2.0, 4.0], [1.0, 1.0, 1.0]) is None
