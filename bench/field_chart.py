#!/usr/bin/env python3
"""Draws the rows of field_accuracy_bench as speed against error: field_chart.py ROWS.csv OUT.svg"""
import csv
import math
import sys

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
WIDTH, HEIGHT = 860, 520
LEFT, RIGHT, TOP, BOTTOM = 90, 240, 56, 64


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


def chart(found):
    about = found.pop("about")
    points = [(ns, e) for series in found.values() for ns, *errors in series.values() for e in errors if e is not None]
    x0 = math.floor(math.log10(min(ns for ns, _ in points)))
    x1 = math.ceil(math.log10(max(ns for ns, _ in points)))
    y0 = math.floor(math.log10(min(e for _, e in points)))
    y1 = math.ceil(math.log10(max(e for _, e in points)))

    def px(ns):
        return LEFT + (math.log10(ns) - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT)

    def py(e):
        return HEIGHT - BOTTOM - (math.log10(e) - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)

    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" '
        'font-family="DejaVu Sans, sans-serif" font-size="12">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
        f'<text x="{LEFT}" y="24" font-size="16">Distance to an outline of 1,000 edges: time against error</text>',
        f'<text x="{LEFT}" y="42" fill="#555">random points in the band; {about}</text>',
    ]

    def power(k):
        return f'10<tspan dy="-5" font-size="9">{str(k).replace("-", "−")}</tspan>'

    for k in range(x0, x1 + 1):
        x = px(10.0**k)
        out.append(f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{HEIGHT - BOTTOM}" stroke="#ddd"/>')
        out.append(f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{10**k:g}</text>')
    for k in range(y0, y1 + 1, 1 if y1 - y0 < 8 else 2):
        y = py(10.0**k)
        out.append(f'<line x1="{LEFT}" y1="{y:.1f}" x2="{WIDTH - RIGHT}" y2="{y:.1f}" stroke="#ddd"/>')
        out.append(f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{power(k)}</text>')
    out.append(
        f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 22}" text-anchor="middle">nanoseconds a point, least of the runs</text>'
    )
    middle = (TOP + HEIGHT - BOTTOM) / 2
    out.append(
        f'<text x="24" y="{middle}" text-anchor="middle" transform="rotate(-90 24 {middle})">error of the distance [m]</text>'
    )
    legend = TOP + 10
    for name, (label, colour, counted) in SERIES.items():
        if name not in found:
            continue
        series = sorted(found[name].items(), key=lambda item: int(item[0] or 0))
        for which, dash in ((1, "4 3"), (2, "")):
            drawn = [(px(p[0]), py(p[which]), size) for size, p in series if p[which] is not None]
            if len(drawn) > 1:
                path = " ".join(f"{x:.1f},{y:.1f}" for x, y, _ in drawn)
                out.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-dasharray="{dash}"/>')
            for x, y, size in drawn:
                fill = "white" if which == 1 else colour
                out.append(
                    f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{fill}" stroke="{colour}" stroke-width="1.5">'
                    f"<title>{label} {size}</title></circle>"
                )
                if which == 2 and size and name in LABELLED:
                    out.append(f'<text x="{x + 7:.1f}" y="{y + 4:.1f}" font-size="9" fill="{colour}">{size}</text>')
        out.append(f'<circle cx="{WIDTH - RIGHT + 22}" cy="{legend}" r="4" fill="{colour}"/>')
        out.append(f'<text x="{WIDTH - RIGHT + 34}" y="{legend + 4}">{label}</text>')
        if counted:
            legend += 14
            out.append(
                f'<text x="{WIDTH - RIGHT + 34}" y="{legend + 4}" font-size="9" fill="#555">numbers: {counted} along 1 m</text>'
            )
        legend += 22
    out.append(f'<circle cx="{WIDTH - RIGHT + 22}" cy="{legend + 8}" r="4" fill="#333"/>')
    out.append(f'<text x="{WIDTH - RIGHT + 34}" y="{legend + 12}">root mean square</text>')
    out.append(
        f'<circle cx="{WIDTH - RIGHT + 22}" cy="{legend + 28}" r="4" fill="white" stroke="#333" stroke-width="1.5"/>'
    )
    out.append(f'<text x="{WIDTH - RIGHT + 34}" y="{legend + 32}">largest</text>')
    out.append("</svg>")
    return "\n".join(out) + "\n"


def main(arguments):
    if len(arguments) != 2:
        print("usage: field_chart.py ROWS.csv OUT.svg", file=sys.stderr)
        return 2
    found = read(arguments[0])
    if not found:
        print(f"{arguments[0]}: no rows of field_accuracy in it", file=sys.stderr)
        return 2
    with open(arguments[1], "w") as out:
        out.write(chart(found))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
