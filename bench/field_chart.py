#!/usr/bin/env python3
"""Draws the rows of field_accuracy_bench as speed against error: field_chart.py ROWS.csv OUT.svg"""
import csv
import math
import sys

import svg_chart

# Case in the rows: label, colour (of a palette that colour-blind readers tell apart), what its argument counts.
SERIES = {
    "exact": ("DistanceField, exact", "#0072b2", None),
    "sampled": ("SampledField, bilinear", "#d55e00", "cells"),
    "sampledPoints": ("bilinear, point by point", "#e69f00", "cells"),
    "cubicPoints": ("bicubic, point by point", "#cc79a7", "cells"),
    "openvdb": ("OpenVDB BoxSampler", "#009e73", "voxels"),
    "bruteForce": ("every edge, in double", "#555555", None),
}
LABELLED = ("sampled", "openvdb")  # the others' points stand in the same order


def read(path):
    """{case: {argument: [ns, largest, rms]}} of the last run of each case."""
    found = {}
    with open(path, newline="") as rows:
        for row in csv.DictReader(rows):
            words = row["case"].split("/")
            if words[0] not in SERIES:
                continue
            size = words[1] if len(words) > 2 and words[1].isdigit() and words[0] not in ("exact", "bruteForce") else ""
            measure = words[2] if size else words[1]
            point = found.setdefault(words[0], {}).setdefault(size, [math.inf, None, None])
            point[0] = min(point[0], float(row["ns_best"]))
            point[1 + int(measure)] = float(row["error"])
            found["about"] = f'{row["cpu"]}, {row["simd"]}, commit {row["commit"]}, 1 thread'
    return found


def power(k):
    return f'10<tspan dy="-5" font-size="9">{str(k).replace("-", "−")}</tspan>'


def draw_series(chart, label, colour, labelled, points):
    """Points are [size, [ns, largest, rms]]: the largest errors as rings, the root mean squares as discs."""
    for which, dash in ((1, "4 3"), (2, "")):
        drawn = [(chart.px(p[0]), chart.py(p[which]), size) for size, p in points if p[which] is not None]
        if len(drawn) > 1:
            chart.path([(x, y) for x, y, _ in drawn], f'stroke="{colour}" stroke-dasharray="{dash}"')
        for x, y, size in drawn:
            fill = "white" if which == 1 else colour
            chart.circle(x, y, 4, f'fill="{fill}" stroke="{colour}" stroke-width="1.5"', f"{label} {size}")
            if which == 2 and size and labelled:
                chart.text(x + 7, y + 4, size, f'font-size="9" fill="{colour}"')


def draw(found):
    about = found.pop("about")
    points = [(ns, e) for series in found.values() for ns, *errors in series.values() for e in errors if e is not None]
    times, errors = [ns for ns, _ in points], [e for _, e in points]
    x0, x1 = svg_chart.decades(min(times), max(times))
    y0, y1 = svg_chart.decades(min(errors), max(errors))
    chart = svg_chart.Chart(
        "Distance to an outline of 1,000 edges: time against error",
        f"random points in the band; {about}",
        size=(860, 520),
        margins=(90, 240, 56, 64),
        x=(10.0**x0, 10.0**x1),
        y=(10.0**y0, 10.0**y1),
    )
    chart.axes(
        {10.0**k: f"{10**k:g}" for k in range(x0, x1 + 1)},
        "nanoseconds a point, least of the runs",
        {10.0**k: power(k) for k in range(y0, y1 + 1, 1 if y1 - y0 < 8 else 2)},
        "error of the distance [m]",
    )
    mark, x, legend = chart.right + 22, chart.right + 34, chart.top + 10
    for name, (label, colour, counted) in SERIES.items():
        if name not in found:
            continue
        series = sorted(found[name].items(), key=lambda item: int(item[0] or 0))
        draw_series(chart, label, colour, name in LABELLED, series)
        chart.circle(mark, legend, 4, f'fill="{colour}"')
        chart.text(x, legend + 4, label)
        if counted:
            legend += 14
            chart.text(x, legend + 4, f"numbers: {counted} along 1 m", 'font-size="9" fill="#555"')
        legend += 22
    chart.circle(mark, legend + 8, 4, 'fill="#333"')
    chart.text(x, legend + 12, "root mean square")
    chart.circle(mark, legend + 28, 4, 'fill="white" stroke="#333" stroke-width="1.5"')
    chart.text(x, legend + 32, "largest")
    return chart.svg()


if __name__ == "__main__":
    sys.exit(svg_chart.run(sys.argv[1:], "field_chart.py", "field_accuracy", read, draw))
