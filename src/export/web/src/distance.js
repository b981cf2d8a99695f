// The exact signed distance to a polygon, from the cells of its field; and the closest features of two convex polygons.

/** Edges of rings [x, y, x, y, …], the solid on their left; edge k begins at vertex k. */
export function edgesOf(rings) {
  return rings.flatMap((ring) => {
    const n = ring.length / 2;
    return Array.from({ length: n }, (_, i) => [ring[2 * i], ring[2 * i + 1], ring[2 * ((i + 1) % n)], ring[2 * ((i + 1) % n) + 1]]);
  });
}

/** Closest point of a segment, and whether it is one of its ends. */
function closestOfEdge([ax, ay, bx, by], x, y) {
  const ex = bx - ax;
  const ey = by - ay;
  const t = ((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey);
  if (t <= 0) return [ax, ay, true];
  if (t >= 1) return [bx, by, true];
  return [ax + t * ex, ay + t * ey, false];
}

export class Field {
  /** `page`: as src/export/field_page.cpp writes it. */
  constructor(page) {
    this.page = page;
    this.edges = edgesOf(page.rings);
    this.all = this.edges.map((_, k) => k);
    this.bounds = [0, 1].map((c) => page.rings[0].filter((_, k) => k % 2 === c)).flatMap((list) => [Math.min(...list), Math.max(...list)]);
  }
  /** What the cell at a point keeps: a list of edges, 0 outside, 1 inside; null beyond the grid. */
  cellAt(x, y) {
    const { origin, cell, columns, rows, cells } = this.page;
    const i = Math.floor((x - origin[0]) / cell);
    const j = Math.floor((y - origin[1]) / cell);
    return i < 0 || j < 0 || i >= columns || j >= rows ? null : cells[j * columns + i];
  }
  inside(x, y) {
    let odd = false;
    for (const [ax, ay, bx, by] of this.edges) if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) odd = !odd;
    return odd;
  }
  /** Distance [m, negative inside], closest point, and the unit normal out of the polygon there. Cells that keep edges answer from
   *  these alone; elsewhere, and where fewer edges would not be exact, all of them are asked. */
  sample(x, y) {
    const cell = this.cellAt(x, y);
    const near = Array.isArray(cell) ? this.nearest(cell, x, y) : null;
    const found = near && near.distance <= this.page.band ? near : this.nearest(this.all, x, y);
    const sign = (Array.isArray(cell) || cell === null ? this.inside(x, y) : cell === 1) ? -1 : 1;
    const [dx, dy] = [x - found.x, y - found.y];
    let normal = [(sign * dx) / found.distance, (sign * dy) / found.distance];
    if (found.distance === 0) {
      const [ax, ay, bx, by] = this.edges[found.edge];
      const length = Math.hypot(bx - ax, by - ay);
      normal = [(by - ay) / length, -(bx - ax) / length];
    }
    return { distance: sign * found.distance + 0, closest: [found.x, found.y], normal, vertex: found.vertex, edge: found.edge, cell };
  }
  nearest(list, x, y) {
    let best = null;
    for (const edge of list) {
      const [px, py, vertex] = closestOfEdge(this.edges[edge], x, y);
      const distance = Math.hypot(x - px, y - py);
      if (!best || distance < best.distance) best = { distance, x: px, y: py, vertex, edge };
    }
    return best;
  }
}

// ---- two convex polygons

/** Convex hull, counter-clockwise (Andrew's monotone chain). */
export function convexHull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  const half = (list) => {
    const chain = [];
    for (const p of list) {
      while (chain.length > 1 && turn(chain[chain.length - 2], chain[chain.length - 1], p) <= 0) chain.pop();
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half([...sorted].reverse())];
}

const normalOf = (polygon, k) => {
  const [a, b] = [polygon[k], polygon[(k + 1) % polygon.length]];
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  return [(b[1] - a[1]) / length, -(b[0] - a[0]) / length];
};

/** The deepest overlap along the normals of both polygons, or null where an axis separates them. */
export function overlapOf(a, b) {
  let least = null;
  for (const [one, other, sign] of [[a, b, 1], [b, a, -1]])
    for (let k = 0; k < one.length; ++k) {
      const n = normalOf(one, k);
      const depth = -Math.min(...other.map((p) => (p[0] - one[k][0]) * n[0] + (p[1] - one[k][1]) * n[1]));
      if (depth <= 0) return null;
      if (!least || depth < least.depth) least = { depth, normal: [sign * n[0], sign * n[1]] };
    }
  return least;
}

/** Closest points of two convex polygons that are apart, and which vertex or edge of each they lie on. */
export function closestFeatures(a, b) {
  let best = null;
  for (const [one, other, swapped] of [[a, b, false], [b, a, true]])
    one.forEach((p, i) => other.forEach((q, k) => {
      const next = other[(k + 1) % other.length];
      const [x, y, end] = closestOfEdge([...q, ...next], ...p);
      const distance = Math.hypot(p[0] - x, p[1] - y);
      if (best && distance >= best.distance) return;
      const near = Math.hypot(x - q[0], y - q[1]) <= Math.hypot(x - next[0], y - next[1]) ? k : (k + 1) % other.length;
      const mine = { kind: 'vertex', index: i, at: p };
      const its = { kind: end ? 'vertex' : 'edge', index: end ? near : k, at: [x, y] };
      best = { distance, a: swapped ? its : mine, b: swapped ? mine : its };
    }));
  return best;
}

/** The Voronoi region of a feature of a convex polygon, as a polygon that reaches `far`. */
export function voronoiRegion(polygon, { kind, index }, far) {
  const out = (p, n) => [p[0] + far * n[0], p[1] + far * n[1]];
  const p = polygon[index];
  if (kind === 'edge') {
    const n = normalOf(polygon, index);
    const q = polygon[(index + 1) % polygon.length];
    return [p, out(p, n), out(q, n), q];
  }
  const before = normalOf(polygon, (index + polygon.length - 1) % polygon.length);
  const after = normalOf(polygon, index);
  const middle = [before[0] + after[0], before[1] + after[1]];
  const length = Math.hypot(...middle) || 1;
  return [p, out(p, before), out(p, [(1.5 * middle[0]) / length, (1.5 * middle[1]) / length]), out(p, after)];
}
