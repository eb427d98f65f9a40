"""Draws beside what their distributions say, by Python's own statistics."""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest

from wingcrack.errors import CaseError
from wingcrack.studies.distributions import read_draws

COUNT = 50


def draws(entry: Any, seed: int = 7, method: str = "latin_hypercube", count: int = COUNT) -> Any:
    table = {"count": count, "seed": seed, "method": method, "parameters": {"a": entry}}
    return read_draws(table, "draw", 10_000)["a"]


# Each law's distribution function, in closed form or from the standard library.
LAWS: dict[str, tuple[dict[str, Any], Any]] = {
    "uniform": ({"uniform": [-2.0, 3.0]}, lambda x: (x + 2.0) / 5.0),
    "log_uniform": ({"log_uniform": [1e-20, 1e-16]}, lambda x: math.log10(x / 1e-20) / 4.0),
    "normal": ({"normal": [0.5, 0.05]}, NormalDist(0.5, 0.05).cdf),
    "lognormal": (
        {"lognormal": [2.0, 1.5]},
        lambda x: NormalDist().cdf(math.log(x / 2.0) / math.log(1.5)),
    ),
}


@pytest.mark.parametrize("law", LAWS)
def test_a_latin_hypercube_has_one_draw_in_each_part_of_equal_chance(law: str) -> None:
    entry, cdf = LAWS[law]
    parts = sorted(int(cdf(value) * COUNT) for value in draws(entry))
    assert parts == list(range(COUNT))


@pytest.mark.parametrize("law", LAWS)
def test_free_draws_follow_the_law_too(law: str) -> None:
    entry, cdf = LAWS[law]
    shares = sorted(cdf(value) for value in draws(entry, method="random", count=2000))
    largest = max(abs(share - (k + 0.5) / 2000) for k, share in enumerate(shares))
    assert largest < 1.63 / math.sqrt(2000)  # Kolmogorov and Smirnov, 1 %
    parts = [int(share * COUNT) for share in shares[:COUNT]]
    assert len(set(parts)) < COUNT


def test_bounds_cut_the_law_off_and_heap_nothing_up() -> None:
    values = draws({"normal": [0.0, 1.0], "min": -1.0, "max": 0.5})
    law = NormalDist()
    below, above = law.cdf(-1.0), law.cdf(0.5)
    parts = sorted(int((law.cdf(value) - below) / (above - below) * COUNT) for value in values)
    assert parts == list(range(COUNT))
    assert -1.0 < min(values) < max(values) < 0.5


def test_draws_are_those_of_scipy() -> None:
    from scipy import stats

    shares = stats.qmc.LatinHypercube(1, rng=np.random.default_rng(7)).random(COUNT)[:, 0]
    laws = {
        "uniform": stats.uniform(-2.0, 5.0),
        "log_uniform": stats.loguniform(1e-20, 1e-16),
        "normal": stats.norm(0.5, 0.05),
        "lognormal": stats.lognorm(math.log(1.5), scale=2.0),
    }
    for kind, law in laws.items():
        assert draws(LAWS[kind][0]) == list(law.ppf(shares))
        assert draws(LAWS[kind][0] | {"min": law.ppf(0.2), "max": law.ppf(0.7)}) == pytest.approx(
            law.ppf(0.2 + 0.5 * shares), rel=1e-13
        )


def test_whole_numbers_come_equally_often() -> None:
    values = draws({"integers": [1, 5]})
    assert {type(value) for value in values} == {int}
    assert [values.count(value) for value in range(1, 6)] == [10] * 5


def test_words_come_equally_often() -> None:
    values = draws({"of": ["paris", "equilibrium"]})
    assert values.count("paris") == COUNT // 2


def test_a_seed_decides_all() -> None:
    entry = {"uniform": [0.0, 1.0]}
    assert draws(entry) == draws(entry)
    assert draws(entry) != draws(entry, seed=8)


def test_parameters_are_drawn_independently() -> None:
    table = {"count": 400, "seed": 3, "parameters": {k: {"uniform": [0.0, 1.0]} for k in "ab"}}
    found = read_draws(table, "draw", 10_000)
    mean = sum((a - 0.5) * (b - 0.5) for a, b in zip(found["a"], found["b"], strict=True)) / 400
    assert abs(12.0 * mean) < 0.15
    assert found["sample"] == list(range(1, 401))


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        (0.5, "must be a table with one of"),
        ({}, "must have exactly one of"),
        ({"uniform": [0, 1], "normal": [0, 1]}, "must have exactly one of"),
        ({"gauss": [0, 1]}, "must have exactly one of"),
        ({"uniform": [0.0]}, "takes two numbers"),
        ({"uniform": [1.0, 0.0]}, "the lower number first"),
        ({"uniform": ["0", 1.0]}, "must be a finite number"),
        ({"uniform": [0.0, math.inf]}, "must be a finite number"),
        ({"log_uniform": [0.0, 1.0]}, "numbers above 0"),
        ({"lognormal": [-1.0, 2.0]}, "numbers above 0"),
        ({"lognormal": [1.0, 1.0]}, "must be above 1"),
        ({"normal": [0.0, 0.0]}, "must be above 0"),
        ({"normal": [0.0, 1.0], "min": 1.0, "max": 1.0}, "'min' must be less than 'max'"),
        ({"normal": [0.0, 1.0], "min": 40.0, "max": 50.0}, "has nothing between"),
        ({"uniform": [0.0, 1.0], "min": 2.0}, "has nothing between"),
        ({"integers": [0.5, 2.0]}, "two whole numbers"),
        ({"integers": [1, 2], "min": 1.2, "max": 1.8}, "no whole number lies within"),
        ({"of": []}, "at least one value"),
        ({"uniform": [0.0, 1.0], "mean": 2.0}, "'mean' is unknown"),
    ],
)
def test_what_is_no_distribution(entry: Any, reason: str) -> None:
    with pytest.raises(CaseError) as caught:
        draws(entry)
    assert reason in str(caught.value)


@pytest.mark.parametrize(
    ("key", "value"), [("count", 0), ("count", 2.5), ("count", True), ("seed", -1), ("seed", "x")]
)
def test_counts_and_seeds_are_whole(key: str, value: Any) -> None:
    table = {"count": 2, "seed": 1, "parameters": {"a": {"uniform": [0.0, 1.0]}}} | {key: value}
    with pytest.raises(CaseError, match="whole number"):
        read_draws(table, "draw", 10_000)
