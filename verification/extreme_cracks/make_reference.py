"""Stress intensity factors of a kinked crack in an infinite body by displacement discontinuities.

Constant elements (Crouch and Starfield, Boundary Element Methods in Solid Mechanics, 1983,
chapter 5), graded towards tips and kink. The ratio of K to the discontinuity of the element at a
tip is that of a straight crack with the same elements, where K is known. The error falls with the
size of the elements; two sizes give the values extrapolated to none.

    python make_reference.py            # writes kink_120.csv after comparing with catalogue 1.8
"""

from __future__ import annotations

import csv
import itertools
import math
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Stress = tuple[float, float, float]  # xx, yy, xy
SMALLEST = 1.0e-7  # element, over the main crack's half length


def graded(length: float, largest: float) -> Array:
    """Element ends on a segment, graded towards both of its ends: factor 1 + 8 * largest."""
    sizes = [SMALLEST]
    while sum(sizes) < 0.5 * length:
        sizes.append(min(sizes[-1] * (1.0 + 8.0 * largest), largest))
    half = np.concatenate([[0.0], np.cumsum(sizes)])
    half *= 0.5 * length / half[-1]
    return np.concatenate([half, length - half[-2::-1]])


def elements(vertices: Array, largest: float) -> tuple[Array, Array]:
    """Starts and ends of the elements of a polyline."""
    starts, ends = [], []
    for a, b in itertools.pairwise(vertices):
        length = float(np.linalg.norm(b - a))
        s = graded(length, largest) / length
        points = a + s[:, None] * (b - a)
        starts.append(points[:-1])
        ends.append(points[1:])
    return np.concatenate(starts), np.concatenate(ends)


def tip_values(vertices: Array, stress: Stress, largest: float) -> Array:
    """Discontinuities (normal, shear) of the first and last element over the root of its length."""
    start, end = elements(vertices, largest)
    middle, half = 0.5 * (start + end), 0.5 * np.linalg.norm(end - start, axis=1)
    tangent = (end - start) / (2.0 * half[:, None])
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    arm = middle[:, None, :] - middle[None, :, :]
    x = np.einsum("ijk,jk->ij", arm, tangent)
    y = np.einsum("ijk,jk->ij", arm, normal)
    a = half[None, :]
    r1, r2 = (x - a) ** 2 + y**2, (x + a) ** 2 + y**2
    f_xy = y / r1 - y / r2
    f_yy = -((x - a) / r1 - (x + a) / r2)
    f_xyy = ((x - a) ** 2 - y**2) / r1**2 - ((x + a) ** 2 - y**2) / r2**2
    f_yyy = 2.0 * y * ((x - a) / r1**2 - (x + a) / r2**2)
    # Stresses in the axes of the source element, by its shear and its normal discontinuity.
    by_shear = (2.0 * f_xy + y * f_xyy, -y * f_xyy, f_yy + y * f_yyy)
    by_normal = (f_yy + y * f_yyy, f_yy - y * f_yyy, -y * f_xyy)
    cosine = np.einsum("ik,jk->ij", tangent, tangent)
    sine = np.einsum("ik,jk->ij", tangent, normal)
    blocks = []
    for s_xx, s_yy, s_xy in (by_shear, by_normal):
        across = s_xx * sine**2 - 2.0 * s_xy * sine * cosine + s_yy * cosine**2
        along = (s_yy - s_xx) * sine * cosine + s_xy * (cosine**2 - sine**2)
        blocks.append((along, across))
    matrix = np.block([[blocks[0][0], blocks[1][0]], [blocks[0][1], blocks[1][1]]])
    xx, yy, xy = stress
    tensor = np.array([[xx, xy], [xy, yy]])
    traction = normal @ tensor
    right = -np.concatenate([np.sum(traction * tangent, axis=1), np.sum(traction * normal, axis=1)])
    jump = np.linalg.solve(matrix, right)
    n = len(half)
    root = np.sqrt(2.0 * half)
    return np.array([[jump[n + k] / root[k], jump[k] / root[k]] for k in (0, n - 1)])


def intensities(angle_deg: float, branch: float, stress: Stress) -> Array:
    """K_I, K_II over sqrt(pi a) at the far tip and at the branch, for a unit half length a."""
    angle = math.radians(angle_deg)
    kink = np.array([1.0, 0.0])
    tip = kink + branch * np.array([math.cos(angle), math.sin(angle)])
    found = []
    for largest in (0.01, 0.005):
        straight = tip_values(np.array([[-1.0, 0.0], [1.0, 0.0]]), (0.0, 1.0, 1.0), largest)
        found.append(tip_values(np.array([[-1.0, 0.0], kink, tip]), stress, largest) / straight)
    return 2.0 * found[1] - found[0]


def main() -> int:
    """Compare with the catalogue, then write the values for 120 degrees."""
    tension, shear = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    known = [
        (30.0, 0.5, tension, [[1.098351152, -0.02872004775], [0.885564212, 0.4894949268]]),
        (45.0, 0.2, shear, [[-0.02784330689, 1.063523368], [-1.008730008, 0.5090135093]]),
        (70.5288, 0.3, tension, [[1.025490857, -0.02020148306], [0.2195738731, 0.5710909694]]),
        (70.5288, 0.3, shear, [[-0.03944285304, 1.104433988], [-1.086233605, -0.05605287735]]),
    ]
    worst = 0.0
    for angle, branch, stress, exact in known:
        difference = intensities(angle, branch, stress) - np.array(exact)
        worst = max(worst, float(np.max(np.abs(difference))))
        print(angle, branch, np.round(difference, 7).tolist())
    print(f"largest difference from catalogue 1.8: {worst:.1e}")
    with (Path(__file__).parent / "kink_120.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(
            ["branch", "sxx", "syy", "sxy", "k1_far", "k2_far", "k1_branch", "k2_branch"]
        )
        for stress in ((1.0, 1.0, 0.0), tension, shear):
            values = intensities(120.0, 0.5, stress).ravel()
            writer.writerow([0.5, *stress, *(f"{v:.6f}" for v in values)])
    return 0 if worst < 1.0e-3 else 1


if __name__ == "__main__":
    sys.exit(main())
