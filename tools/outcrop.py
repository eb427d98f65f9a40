"""Print a synthetic fracture map as GeoJSON: inputs/examples/outcrop.geojson comes from it.

    python tools/outcrop.py --seed 4 >inputs/examples/outcrop.geojson

Fifty traces of three sets on a pavement of 40 m x 30 m, as somebody may have digitized them:
slightly curved, and with what digitizing leaves behind, each a known number of times: ends that
stop short of the trace they should meet or run past it, traces drawn twice, traces that go on
over a stretch of another one, vertices set twice, names with blanks and accents.
"""

import argparse
import itertools
import json
import math
import random

WIDTH, HEIGHT = 40.0, 30.0  # [m]
SETS = ((25.0, 6.0, 11.0, 0.60), (85.0, 7.0, 8.0, 0.65), (140.0, 9.0, 6.0, 0.70))
CLEARANCE = 0.4  # of traces that have nothing to do with each other [m]

Trace = list[tuple[float, float]]


def main() -> None:
    """Read what is asked for and print the map."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=4)
    parser.add_argument("--plain", type=int, default=34, help="traces drawn with care")
    asked = parser.parse_args()
    numbers = random.Random(asked.seed)
    traces: list[tuple[Trace, int]] = []
    while len(traces) < asked.plain:
        which = numbers.choices(range(3), weights=(5, 4, 3))[0]
        trace = draw(numbers, which)
        if all(is_clear(trace, other) for other, _ in traces):
            traces.append((trace, which))
    for k in range(8):  # abutting ones, whose ends miss by some centimetres
        traces.append((abutting(numbers, traces, k), 2))
    for k in range(3):  # drawn twice
        trace, which = traces[5 * k]
        traces.append(([(x + 0.01, y - 0.01) for x, y in trace], which))
    for k in range(3):  # goes on over the last metre of another one
        trace, which = traces[5 * k + 1]
        (x_0, y_0), (x_1, y_1) = trace[-2:]
        length = math.hypot(x_1 - x_0, y_1 - y_0)
        along = ((x_1 - x_0) / length, (y_1 - y_0) / length)
        ends = [(x_1 + s * along[0], y_1 + s * along[1]) for s in (-0.6, 1.0)]
        traces.append((ends, which))
    for k in range(2):  # a vertex set twice, and a speck
        trace, which = traces[7 * k + 3]
        trace.insert(1, (trace[0][0] + 0.004, trace[0][1] + 0.003))
        x, y = 2.0 + 36.0 * k, 1.0 + 28.0 * k
        traces.append(([(x, y), (x + 0.03, y + 0.02)], which))
    print(as_text(traces))


def draw(numbers: random.Random, which: int) -> Trace:
    """Draw a trace of four vertices that bends a little."""
    mean, spread, length, _ = SETS[which]
    length *= math.exp(numbers.gauss(0.0, 0.35))
    angle = math.radians(numbers.gauss(mean, spread))
    place = (numbers.uniform(3.0, WIDTH - 3.0), numbers.uniform(3.0, HEIGHT - 3.0))
    place = (place[0] - 0.5 * length * math.cos(angle), place[1] - 0.5 * length * math.sin(angle))
    trace = [place]
    for _ in range(3):
        angle += math.radians(numbers.gauss(0.0, 4.0))
        place = (
            place[0] + length / 3.0 * math.cos(angle),
            place[1] + length / 3.0 * math.sin(angle),
        )
        trace.append(place)
    return trace


def is_clear(trace: Trace, other: Trace) -> bool:
    """Whether no vertex of one comes near to the other: they may cross."""
    return all(
        distance(place, line) > CLEARANCE
        for places, line in ((trace, other), (other, trace))
        for place in places
    )


def distance(place: tuple[float, float], line: Trace) -> float:
    """Distance of a place from a polyline."""
    least = math.inf
    for (x_0, y_0), (x_1, y_1) in itertools.pairwise(line):
        d = (x_1 - x_0, y_1 - y_0)
        share = ((place[0] - x_0) * d[0] + (place[1] - y_0) * d[1]) / (d[0] ** 2 + d[1] ** 2)
        share = min(1.0, max(0.0, share))
        least = min(least, math.hypot(place[0] - x_0 - share * d[0], place[1] - y_0 - share * d[1]))
    return least


def abutting(numbers: random.Random, traces: list[tuple[Trace, int]], k: int) -> Trace:
    """Draw a trace that should end on another one and misses it, short of it or past it."""
    while True:
        target, _ = traces[numbers.randrange(34)]
        (x_0, y_0), (x_1, y_1) = target[1:3]
        share = numbers.uniform(0.3, 0.7)
        turn = math.atan2(y_1 - y_0, x_1 - x_0) + math.radians(numbers.uniform(55.0, 125.0))
        miss = numbers.uniform(0.02, 0.08) * (1 if k % 2 else -1)
        start = (x_0 + share * (x_1 - x_0) + miss * math.cos(turn),
                 y_0 + share * (y_1 - y_0) + miss * math.sin(turn))  # fmt: skip
        reach = numbers.uniform(1.5, 4.0)
        trace = [start, (start[0] + reach * math.cos(turn), start[1] + reach * math.sin(turn))]
        others = [line for line, _ in traces if line is not target]
        if all(is_clear(trace, other) for other in others):
            return trace


def as_text(traces: list[tuple[Trace, int]]) -> str:
    """Give the map as GeoJSON, a feature a line."""
    features = []
    for number, (trace, which) in enumerate(traces, start=1):
        name = f"Kluft {number}" if number % 10 else f"Störung {number}"
        properties = {"name": name, "friction": SETS[which][3], "set": which + 1}
        places = [[round(x, 3), round(y, 3)] for x, y in trace]
        geometry = {"type": "LineString", "coordinates": places}
        features.append({"type": "Feature", "properties": properties, "geometry": geometry})
    rows = ",\n".join(json.dumps(feature, ensure_ascii=False) for feature in features)
    return f'{{"type": "FeatureCollection", "features": [\n{rows}\n]}}'


if __name__ == "__main__":
    main()
