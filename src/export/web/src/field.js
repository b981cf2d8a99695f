// The page of a distance field: explored with the pointer, and two polygons to drag.
import { h, short, kColors } from './dom.js';
import { Field, closestFeatures, convexHull, overlapOf, voronoiRegion } from './distance.js';

const kRaster = 420; // pixels along the longer side that are asked for their distance
const kOutside = [[253, 231, 205], [230, 97, 1]]; // near and far: oranges outside, blues inside (told apart by everybody)
const kInside = [[210, 229, 240], [5, 80, 140]];
const kInk = '#1d2127';

/** A canvas that shows a box of the plane, with y upwards. */
class Sheet {
  constructor(box, label) {
    this.box = box;
    this.canvas = h('canvas', { role: 'img', tabindex: 0, 'aria-label': label });
  }
  fit() {
    const width = this.canvas.clientWidth;
    const [x0, y0, x1, y1] = this.box;
    const height = Math.min((width * (y1 - y0)) / (x1 - x0), 0.8 * window.innerHeight);
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.canvas.style.height = `${height}px`;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.scale = Math.min(this.canvas.width / (x1 - x0), this.canvas.height / (y1 - y0));
    this.left = (this.canvas.width - this.scale * (x1 - x0)) / 2;
    this.context = this.canvas.getContext('2d');
    this.ratio = ratio;
  }
  at([x, y]) {
    return [this.left + (x - this.box[0]) * this.scale, (this.box[3] - y) * this.scale];
  }
  point(event) {
    const place = this.canvas.getBoundingClientRect();
    const ratio = this.canvas.width / place.width;
    return [this.box[0] + ((event.clientX - place.left) * ratio - this.left) / this.scale, this.box[3] - ((event.clientY - place.top) * ratio) / this.scale];
  }
  path(points, { fill, stroke, width = 1.5, closed = true, dash = [] }) {
    const context = this.context;
    context.beginPath();
    for (const ring of points) {
      ring.forEach((p, k) => context[k === 0 ? 'moveTo' : 'lineTo'](...this.at(p)));
      if (closed) context.closePath();
    }
    context.setLineDash(dash);
    if (fill) {
      context.fillStyle = fill;
      context.fill('evenodd');
    }
    if (stroke) {
      context.lineWidth = width * this.ratio;
      context.strokeStyle = stroke;
      context.stroke();
    }
  }
  dot(p, color) {
    const context = this.context;
    context.beginPath();
    context.arc(...this.at(p), 4.5 * this.ratio, 0, 7);
    context.fillStyle = color;
    context.fill();
  }
}

const pairs = (ring) => Array.from({ length: ring.length / 2 }, (_, k) => [ring[2 * k], ring[2 * k + 1]]);

class Explorer {
  constructor(page, field) {
    this.page = page;
    this.field = field;
    const { origin, cell, columns, rows } = page;
    this.sheet = new Sheet([origin[0], origin[1], origin[0] + cell * columns, origin[1] + cell * rows], 'The distance field; move the pointer over it');
    this.rings = page.rings.map(pairs);
    this.makeRaster();
    this.told = h('output', { class: 'told' }, 'Move the pointer over the field, or tap it.');
    const top = this.high;
    this.slider = h('input', { type: 'range', min: this.low, max: top, step: (top - this.low) / 400, value: 0.4 * page.band, 'aria-label': 'Contour', input: () => this.draw() });
    this.shown = h('output', { class: 'clock' });
    this.cells = h('input', { type: 'checkbox', change: () => this.draw() });
    this.element = h('section', { class: 'player' }, this.sheet.canvas, h('div', { class: 'controls' }, h('span', {}, 'contour at'), this.slider, this.shown, h('label', {}, this.cells, ' cells')), this.told);
    this.sheet.canvas.addEventListener('pointermove', (event) => { this.pointer = this.sheet.point(event); this.draw(); });
    this.sheet.canvas.addEventListener('pointerdown', (event) => { this.pointer = this.sheet.point(event); this.draw(); });
  }
  makeRaster() {
    const [x0, y0, x1, y1] = this.sheet.box;
    const step = Math.max(x1 - x0, y1 - y0) / kRaster;
    this.width = Math.max(1, Math.round((x1 - x0) / step));
    this.height = Math.max(1, Math.round((y1 - y0) / step));
    this.step = step;
    this.distances = new Float64Array(this.width * this.height);
    [this.low, this.high] = [Infinity, -Infinity];
    for (let j = 0; j < this.height; ++j)
      for (let i = 0; i < this.width; ++i) {
        const d = this.field.sample(x0 + (i + 0.5) * step, y1 - (j + 0.5) * step).distance;
        this.distances[j * this.width + i] = d;
        this.low = Math.min(this.low, d);
        this.high = Math.max(this.high, d);
      }
    this.image = new ImageData(this.width, this.height);
    this.small = document.createElement('canvas');
    [this.small.width, this.small.height] = [this.width, this.height];
    this.distances.forEach((d, k) => {
      const [near, far] = d < 0 ? kInside : kOutside;
      const t = Math.sqrt(Math.min(1, d < 0 ? d / this.low : d / this.high));
      this.image.data.set([...near.map((v, c) => v + t * (far[c] - v)), 255], 4 * k);
    });
    this.small.getContext('2d').putImageData(this.image, 0, 0);
  }
  /** Marching squares over the raster: segments of the curve at a distance. */
  contour(level) {
    const [x0, , , y1] = this.sheet.box;
    const { width, height, step, distances } = this;
    const segments = [];
    for (let j = 0; j + 1 < height; ++j)
      for (let i = 0; i + 1 < width; ++i) {
        const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([a, b]) => [x0 + (a + 0.5) * step, y1 - (b + 0.5) * step, distances[b * width + a] - level]);
        const cuts = [];
        for (let k = 0; k < 4; ++k) {
          const [p, q] = [corners[k], corners[(k + 1) % 4]];
          if (p[2] < 0 === q[2] < 0) continue;
          const t = p[2] / (p[2] - q[2]);
          cuts.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
        }
        for (let k = 0; k + 1 < cuts.length; k += 2) segments.push([cuts[k], cuts[k + 1]]);
      }
    return segments;
  }
  draw() {
    const { sheet } = this;
    const { context, canvas } = sheet;
    context.fillStyle = '#fff';
    context.fillRect(0, 0, canvas.width, canvas.height);
    const [left, top] = sheet.at([sheet.box[0], sheet.box[3]]);
    context.imageSmoothingEnabled = true;
    context.drawImage(this.small, left, top, this.width * this.step * sheet.scale, this.height * this.step * sheet.scale);
    if (this.cells.checked) this.drawCells();
    sheet.path(this.rings, { stroke: kInk, width: 2 });
    const level = Number(this.slider.value);
    this.shown.textContent = `${short(level)} m`;
    sheet.path(this.contour(level), { stroke: '#111', width: 1.5, closed: false, dash: [5, 3] });
    if (this.pointer) this.drawVector();
  }
  drawCells() {
    const { origin, cell, columns, rows, cells } = this.page;
    const { sheet } = this;
    for (let j = 0; j < rows; ++j)
      for (let i = 0; i < columns; ++i) {
        const kept = cells[j * columns + i];
        const [x, y] = [origin[0] + i * cell, origin[1] + j * cell];
        const many = Array.isArray(kept) ? Math.min(0.65, 0.12 + 0.1 * kept.length) : 0;
        sheet.path([[[x, y], [x + cell, y], [x + cell, y + cell], [x, y + cell]]], { fill: many ? `rgba(0,0,0,${many})` : null, stroke: 'rgba(0,0,0,0.25)', width: 0.5 });
      }
  }
  drawVector() {
    const sample = this.field.sample(...this.pointer);
    this.sample = sample;
    const { sheet } = this;
    sheet.path([[this.pointer, sample.closest]], { stroke: kColors[3], width: 2.5, closed: false });
    sheet.dot(this.pointer, kColors[3]);
    sheet.dot(sample.closest, kInk);
    const cell = Array.isArray(sample.cell) ? `a cell that keeps ${sample.cell.length} edge${sample.cell.length === 1 ? '' : 's'}` : sample.cell === null ? 'beyond the cells' : 'a cell far from the boundary';
    this.told.textContent = `(${short(this.pointer[0])}, ${short(this.pointer[1])}): distance ${short(sample.distance)} m, normal (${short(sample.normal[0])}, ${short(sample.normal[1])}), translation vector (${short(sample.closest[0] - this.pointer[0])}, ${short(sample.closest[1] - this.pointer[1])}); ${cell}, closest is ${sample.vertex ? 'a vertex' : `edge ${sample.edge}`}`;
  }
}

class Pair {
  constructor(page) {
    const hull = convexHull(pairs(page.rings[0]));
    const xs = hull.map((p) => p[0]);
    const ys = hull.map((p) => p[1]);
    const size = Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
    const center = [(Math.max(...xs) + Math.min(...xs)) / 2, (Math.max(...ys) + Math.min(...ys)) / 2];
    this.size = size;
    const moved = (points, x, y) => points.map((p) => [p[0] + x, p[1] + y]);
    const pentagon = Array.from({ length: 5 }, (_, k) => [0.4 * size * Math.cos((2 * Math.PI * k) / 5), 0.4 * size * Math.sin((2 * Math.PI * k) / 5)]);
    this.polygons = [moved(hull, -center[0] - 0.65 * size, -center[1]), moved(pentagon, 0.75 * size, 0.25 * size)];
    this.sheet = new Sheet([-1.6 * size, -0.9 * size, 1.6 * size, 0.9 * size], 'Two polygons; drag them');
    this.told = h('output', { class: 'told' });
    this.element = h('section', { class: 'player' }, this.sheet.canvas, this.told);
    const { canvas } = this.sheet;
    canvas.addEventListener('pointerdown', (event) => {
      const p = this.sheet.point(event);
      this.held = this.polygons.findIndex((polygon) => overlapOf(polygon, [p, [p[0] + 1e-9 * size, p[1]], [p[0], p[1] + 1e-9 * size]]));
      this.last = p;
      if (this.held >= 0) canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!(this.held >= 0)) return;
      const p = this.sheet.point(event);
      this.move(this.held, p[0] - this.last[0], p[1] - this.last[1]);
      this.last = p;
    });
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, () => { this.held = -1; });
    canvas.addEventListener('keydown', (event) => {
      const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
      if (!steps[event.key]) return;
      event.preventDefault();
      this.move(1, ...steps[event.key].map((v) => 0.02 * size * v));
    });
  }
  move(which, dx, dy) {
    this.polygons[which] = this.polygons[which].map((p) => [p[0] + dx, p[1] + dy]);
    this.draw();
  }
  draw() {
    const { sheet } = this;
    const [a, b] = this.polygons;
    sheet.context.fillStyle = '#fff';
    sheet.context.fillRect(0, 0, sheet.canvas.width, sheet.canvas.height);
    const overlap = overlapOf(a, b);
    const closest = overlap ? null : closestFeatures(a, b);
    this.result = overlap ?? closest;
    const colors = [kColors[0], kColors[4]];
    if (closest) [closest.a, closest.b].forEach((feature, k) => sheet.path([voronoiRegion(this.polygons[k], feature, 4 * this.size)], { fill: `${colors[k]}2e`, stroke: `${colors[k]}88`, width: 1, dash: [4, 4] }));
    this.polygons.forEach((polygon, k) => sheet.path([polygon], { fill: `${colors[k]}88`, stroke: kInk }));
    if (closest) {
      sheet.path([[closest.a.at, closest.b.at]], { stroke: kInk, width: 2.5, closed: false });
      for (const feature of [closest.a, closest.b]) sheet.dot(feature.at, kInk);
      this.told.textContent = `${short(closest.distance)} m apart: ${closest.a.kind} ${closest.a.index} of the hull and ${closest.b.kind} ${closest.b.index} of the pentagon; each lies in the other's Voronoi region`;
    } else {
      this.told.textContent = `overlapping: moving the pentagon by (${short(overlap.depth * overlap.normal[0])}, ${short(overlap.depth * overlap.normal[1])}) m parts them`;
    }
  }
}

export async function showField(page, root) {
  const field = new Field(page);
  const explorer = new Explorer(page, field);
  const pair = new Pair(page);
  root.append(h('header', {}, h('h1', {}, page.title), h('p', {}, `${field.edges.length} edges, ${page.columns} × ${page.rows} cells of ${short(page.cell)} m, exact within ${short(page.band)} m of the boundary and, asked for all edges, everywhere`)),
    explorer.element, h('h2', {}, 'Closest features'), h('p', { class: 'note' }, 'The convex hull of the shape and a pentagon: drag them, or move the pentagon with the arrows. Shaded is the Voronoi region of the feature that is closest to the other polygon.'),
    pair.element, h('details', {}, h('summary', {}, 'Libraries in this page'), h('pre', {}, page.notices)));
  const fit = () => [explorer, pair].forEach((part) => { part.sheet.fit(); part.draw(); });
  fit();
  window.addEventListener('resize', fit);
  return { page, field, explorer, pair };
}
