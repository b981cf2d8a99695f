#!/usr/bin/env python3
"""Draws the rows of contact_bench as time against the number of vertices: contact_chart.py ROWS.csv OUT.svg"""
import csv
import sys

import svg_chart

# Case in the rows: label, colour (of a palette that colour-blind readers tell apart), dashes.
SERIES = {
    "closest/apart_warm": ("closest features, warm", "#0072b2", ""),
    "closest/apart_cold": ("closest features, cold", "#0072b2", "5 4"),
    "sat/apart_warm": ("separating axis, warm", "#d55e00", ""),
    "sat/apart_cold": ("separating axis, cold", "#d55e00", "5 4"),
    "sat/near_warm": ("depth, warm", "#e69f00", ""),
    "manifold/near_warm": ("manifold of near pairs, warm", "#009e73", ""),
    "impact": ("time of impact", "#cc79a7", ""),
    "box2dDistance/warm": ("Box2D 2.4 distance, warm", "#555555", ""),
    "box2dManifold/near": ("Box2D 2.4 manifold, near", "#555555", "5 4"),
    "libccd/gjk_intersect": ("libccd GJK, near", "#999999", ""),
    "libccd/mpr_penetration": ("libccd MPR, near", "#999999", "5 4"),
}


def read(path):
    """{case: [(vertices, ns)]} of the last run of each case and a line about the machine; nothing without rows."""
    found, about = {}, ""
    with open(path, newline="") as rows:
        for row in csv.DictReader(rows):
            name, _, size = row["case"].rpartition("/")
            if name in SERIES:
                found.setdefault(name, {})[int(size)] = float(row["ns_best"])
                about = f'{row["cpu"]}, commit {row["commit"]}, 1 thread'
    return found and ({name: sorted(points.items()) for name, points in found.items()}, about)


def draw(rows):
    found, about = rows
    points = [p for series in found.values() for p in series]
    sizes, times = [n for n, _ in points], [ns for _, ns in points]
    low, high = svg_chart.decades(min(times), max(times))
    chart = svg_chart.Chart(
        "Two convex polygons: time of a query against their vertices",
        f"random pairs; {about}",
        size=(900, 540),
        margins=(76, 250, 56, 64),
        x=(min(sizes), max(sizes)),
        y=(10.0**low, 10.0**high),
    )
    chart.axes(
        {n: n for n in (4, 8, 16, 32, 64, 125, 250, 500, 1000)},
        "vertices of each polygon",
        {10.0**k: f"{10**k:,}" for k in range(low, high + 1)},
        "nanoseconds a pair, least of the runs",
    )
    x, legend = chart.right + 16, chart.top + 10
    for name, (label, colour, dashes) in SERIES.items():
        if name not in found:
            continue
        look = f'stroke="{colour}" stroke-width="1.5" stroke-dasharray="{dashes}"'
        chart.path([(chart.px(n), chart.py(ns)) for n, ns in found[name]], look)
        for n, ns in found[name]:
            chart.circle(chart.px(n), chart.py(ns), 3, f'fill="{colour}"', f"{label}, {n}: {ns:g} ns")
        chart.line(x, legend, x + 28, legend, look)
        chart.text(x + 36, legend + 4, label)
        legend += 22
    return chart.svg()


if __name__ == "__main__":
    sys.exit(svg_chart.run(sys.argv[1:], "contact_chart.py", "contact", read, draw))
