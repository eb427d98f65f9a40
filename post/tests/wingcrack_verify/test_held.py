"""Stated errors that hold in a share of all values."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from wingcrack_verify.held import Held, holding

WANTED = Held(share=0.75, factor=4.0)


def test_the_share_is_that_of_all_values() -> None:
    found = holding(WANTED, 1.0, [np.array([0.5, -0.5, 2.0]), np.array([0.25])])
    assert found.good
    assert found.reason == "3 of 4 hold (75 %), median factor 2"
    assert not holding(WANTED, 1.0, [np.array([0.5, 2.0, -2.0, 0.25])]).good


def test_errors_that_are_much_too_large_do_not_pass() -> None:
    found = holding(WANTED, 1.0, [np.array([0.01, 0.02, 0.03])])
    assert not found.good
    assert "median factor 50" in found.reason


def test_a_value_without_error_holds_and_has_no_factor() -> None:
    assert holding(WANTED, 1.0, [np.array([0.0, 0.5])]).reason.endswith("median factor 2")
    assert holding(WANTED, 1.0, [np.zeros(2)]).good
    assert not holding(WANTED, 1.0, []).good


@pytest.mark.parametrize("share", [0.0, 1.1])
def test_a_share_is_one(share: float) -> None:
    with pytest.raises(ValidationError):
        Held(share=share, factor=1.0)
