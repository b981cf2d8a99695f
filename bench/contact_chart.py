#!/usr/bin/env python3
"""Draws the rows of contact_bench as time against the number of vertices: contact_chart.py ROWS.csv OUT.svg"""
import csv
import math
import sys

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
WIDTH, HEIGHT = 900, 540
LEFT, RIGHT, TOP, BOTTOM = 76, 250, 56, 64


def read(path):
    """{case: [(vertices, ns)]} of the last run of each case, and a line about the machine."""
    found, about = {}, ""
    with open(path, newline="") as rows:
        for row in csv.DictReader(rows):
            name, _, size = row["case"].rpartition("/")
            if name in SERIES:
                found.setdefault(name, {})[int(size)] = float(row["ns_best"])
                about = f'{row["cpu"]}, commit {row["commit"]}, 1 thread'
    return {name: sorted(points.items()) for name, points in found.items()}, about


def chart(found, about):
    points = [p for series in found.values() for p in series]
    x0, x1 = (math.log10(f(n for n, _ in points)) for f in (min, max))
    y0 = math.floor(math.log10(min(ns for _, ns in points)))
    y1 = math.ceil(math.log10(max(ns for _, ns in points)))

    def px(n):
        return LEFT + (math.log10(n) - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT)

    def py(ns):
        return HEIGHT - BOTTOM - (math.log10(ns) - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)

    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" '
        'font-family="DejaVu Sans, sans-serif" font-size="12">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
        f'<text x="{LEFT}" y="24" font-size="16">Two convex polygons: time of a query against their vertices</text>',
        f'<text x="{LEFT}" y="42" fill="#555">random pairs; {about}</text>',
    ]
    for n in (4, 8, 16, 32, 64, 125, 250, 500, 1000):
        out.append(f'<line x1="{px(n):.1f}" y1="{TOP}" x2="{px(n):.1f}" y2="{HEIGHT - BOTTOM}" stroke="#ddd"/>')
        out.append(f'<text x="{px(n):.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{n}</text>')
    for k in range(y0, y1 + 1):
        y = py(10.0**k)
        out.append(f'<line x1="{LEFT}" y1="{y:.1f}" x2="{WIDTH - RIGHT}" y2="{y:.1f}" stroke="#ddd"/>')
        out.append(f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{10**k:,}</text>')
    out.append(
        f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 22}" text-anchor="middle">vertices of each polygon</text>'
    )
    middle = (TOP + HEIGHT - BOTTOM) / 2
    out.append(
        f'<text x="20" y="{middle}" text-anchor="middle" transform="rotate(-90 20 {middle})">nanoseconds a pair, least of the runs</text>'
    )
    legend = TOP + 10
    for name, (label, colour, dashes) in SERIES.items():
        if name not in found:
            continue
        path = " ".join(f"{px(n):.1f},{py(ns):.1f}" for n, ns in found[name])
        out.append(
            f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.5" stroke-dasharray="{dashes}"/>'
        )
        for n, ns in found[name]:
            out.append(
                f'<circle cx="{px(n):.1f}" cy="{py(ns):.1f}" r="3" fill="{colour}"><title>{label}, {n}: {ns:g} ns</title></circle>'
            )
        x = WIDTH - RIGHT + 16
        out.append(
            f'<line x1="{x}" y1="{legend}" x2="{x + 28}" y2="{legend}" stroke="{colour}" stroke-width="1.5" stroke-dasharray="{dashes}"/>'
        )
        out.append(f'<text x="{x + 36}" y="{legend + 4}">{label}</text>')
        legend += 22
    out.append("</svg>")
    return "\n".join(out) + "\n"


def main(arguments):
    if len(arguments) != 2:
        print("usage: contact_chart.py ROWS.csv OUT.svg", file=sys.stderr)
        return 2
    found, about = read(arguments[0])
    if not found:
        print(f"{arguments[0]}: no rows of contact in it", file=sys.stderr)
        return 2
    with open(arguments[1], "w") as out:
        out.write(chart(found, about))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
