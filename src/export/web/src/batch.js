// The page of a batch: the table of its runs, plots over parameters, and the gauges of all runs side by side.
import { h, parseCsv, short } from './dom.js';
import { chart } from './plots.js';

const kFirstColumns = ['status', 'particles', 'simulated_seconds', 'wall_seconds', 'leaks', 'max_density_error', 'volume_error', 'energy_drift'];
const kMostMultiples = 48;

const isNumber = (cell) => cell !== '' && Number.isFinite(Number(cell));

/** Bounds of the finite values with some room on both sides. */
function padded(values) {
  const finite = values.filter(Number.isFinite);
  const low = finite.reduce((a, b) => Math.min(a, b), Infinity);
  const high = finite.reduce((a, b) => Math.max(a, b), -Infinity);
  const pad = high > low ? 0.05 * (high - low) : Math.abs(high) || 1;
  return [low - pad, high + pad];
}

class Table {
  constructor(page, header, rows) {
    this.page = page;
    this.header = header;
    this.rows = rows;
    this.order = rows.map((_, i) => i);
    this.sortedBy = null;
    this.all = false;
    this.filter = '';
    this.place = h('div', { class: 'wide' });
    const more = h('input', { type: 'checkbox', change: () => { this.all = more.checked; this.show(); } });
    const search = h('input', { type: 'search', placeholder: 'filter runs', 'aria-label': 'Filter runs', input: () => { this.filter = search.value; this.show(); } });
    this.element = h('section', {}, h('div', { class: 'choices' }, search, h('label', {}, more, ' all columns')), this.place);
    this.show();
  }
  columns() {
    const firsts = ['run', ...this.page.parameters, ...kFirstColumns];
    return this.all ? this.header.map((_, k) => k) : firsts.map((name) => this.header.indexOf(name)).filter((k) => k >= 0);
  }
  sort(column) {
    this.down = this.sortedBy === column && !this.down;
    this.sortedBy = column;
    const value = (i) => this.rows[i][column];
    const numbers = this.rows.every((row) => row[column] === '' || isNumber(row[column]));
    const compare = (a, b) => {
      if (value(a) === '' || value(b) === '') return (value(a) === '') - (value(b) === '');
      const order = numbers ? Number(value(a)) - Number(value(b)) : value(a).localeCompare(value(b), 'en', { numeric: true });
      return this.down ? -order : order;
    };
    this.order = this.rows.map((_, i) => i).sort((a, b) => compare(a, b) || a - b);
    this.show();
  }
  show() {
    const columns = this.columns();
    const heads = columns.map((k) => {
      const sorted = this.sortedBy === k ? (this.down ? 'descending' : 'ascending') : 'none';
      const arrow = { none: '', ascending: ' \u25B2', descending: ' \u25BC' }[sorted];
      return h('th', { scope: 'col', 'aria-sort': sorted }, h('button', { type: 'button', 'data-column': this.header[k], click: () => this.sort(k) }, this.header[k] + arrow));
    });
    const names = ['run', 'status', ...this.page.parameters].map((name) => this.header.indexOf(name));
    const shown = this.order.filter((i) => names.map((k) => this.rows[i][k]).join(' ').toLowerCase().includes(this.filter.toLowerCase()));
    const cell = (row, k) => {
      const name = this.header[k];
      if (name === 'run') return h('td', {}, h('a', { href: `${row[k].split('/').map(encodeURIComponent).join('/')}/index.html` }, row[k]));
      const reason = row[this.header.indexOf('reason')];
      if (name === 'status') return h('td', { class: `status ${row[k]}`, title: reason }, row[k]);
      return h('td', { class: isNumber(row[k]) ? 'number' : '', title: row[k] }, short(row[k]));
    };
    this.place.replaceChildren(h('table', { class: 'runs' }, h('thead', {}, h('tr', {}, heads)),
      h('tbody', {}, shown.map((i) => h('tr', {}, columns.map((k) => cell(this.rows[i], k)))))));
  }
}

function choice(label, names, chosen, onChange) {
  const box = h('select', { 'aria-label': label, change: () => onChange(box.value) }, names.map((name) => h('option', { value: name, selected: name === chosen }, name)));
  return h('label', {}, `${label} `, box);
}

/** One number of the runs over another; a curve for each value of a third. */
function parameterPlot(page, header, rows) {
  const column = (name) => rows.map((row) => row[header.indexOf(name)]);
  const numeric = header.filter((name) => column(name).some(isNumber) && column(name).every((cell) => cell === '' || isNumber(cell)));
  const results = numeric.filter((name) => !page.parameters.includes(name));
  const parameters = page.parameters.filter((name) => numeric.includes(name));
  if (results.length === 0) return null;
  const others = page.parameters.filter((name) => new Set(column(name)).size > 1);
  const state = { x: parameters[0] ?? results[0], y: results.includes('wall_seconds') ? 'wall_seconds' : results[0], by: others.find((name) => name !== parameters[0]) ?? 'nothing' };
  const place = h('div', {});
  const draw = () => {
    const [xs, ys] = [column(state.x), column(state.y)];
    const groups = state.by === 'nothing' ? rows.map(() => state.y) : column(state.by);
    const points = rows.map((_, i) => i).filter((i) => isNumber(xs[i]) && isNumber(ys[i])).sort((a, b) => Number(xs[a]) - Number(xs[b]));
    // A place on the x axis holds one run of each curve; further ones of the same x and curve get places of their own.
    const places = [];
    for (const i of points) {
      let k = places.findIndex((place) => place.x === Number(xs[i]) && !place.ys.has(groups[i]));
      if (k < 0) k = places.push({ x: Number(xs[i]), ys: new Map() }) - 1;
      places[k].ys.set(groups[i], Number(ys[i]));
    }
    const curves = [...new Set(groups)].map((name) => ({ label: state.by === 'nothing' ? name : `${state.by} = ${name}`, values: places.map((place) => place.ys.get(name) ?? null) }));
    place.replaceChildren(chart({ title: `${state.y} over ${state.x}`, x: places.map((place) => place.x), xLabel: state.x, yLabel: state.y, curves, points: true, height: 300,
      xRange: padded(places.map((place) => place.x)), range: padded(points.map((i) => Number(ys[i]))) }));
  };
  const change = (key) => (value) => { state[key] = value; draw(); };
  draw();
  return h('section', { class: 'over' }, h('div', { class: 'choices' }, choice('x', [...parameters, ...results], state.x, change('x')), choice('y', results, state.y, change('y')),
    choice('curves by', ['nothing', ...others], state.by, change('by'))), place);
}

/** The same gauge of every run, in the same frame. */
function smallMultiples(page) {
  const names = [...new Set(page.runs.flatMap((run) => Object.keys(run.gauges)))];
  if (names.length === 0) return null;
  const place = h('div', { class: 'charts multiples' });
  const draw = (name) => {
    const having = page.runs.filter((run) => run.gauges[name]);
    const range = padded(having.flatMap((run) => run.gauges[name][1]));
    const shown = having.slice(0, kMostMultiples);
    place.replaceChildren(...shown.map((run) => chart({ title: run.name, x: run.gauges[name][0], xLabel: 't (s)', yLabel: page.units[name] ?? '', curves: [{ label: name, values: run.gauges[name][1] }], height: 150, legend: false, range })));
    if (shown.length < having.length) place.append(h('p', { class: 'note' }, `the first ${shown.length} of ${having.length} runs`));
  };
  draw(names[0]);
  return h('section', {}, h('div', { class: 'choices' }, choice('gauge', names, names[0], draw)), place);
}

export async function showBatch(page, root) {
  const [header, ...rows] = parseCsv(page.table);
  const statuses = rows.map((row) => row[header.indexOf('status')]);
  root.append(h('header', {}, h('h1', {}, page.title), h('p', {}, `${statuses.filter((word) => word === 'done').length} of ${rows.length} runs done`), h('p', { class: 'command' }, page.command)));
  const table = new Table(page, header, rows);
  const over = parameterPlot(page, header, rows);
  const multiples = smallMultiples(page);
  root.append(table.element);
  if (over) root.append(h('h2', {}, 'Over the parameters'), over);
  if (multiples) root.append(h('h2', {}, 'Gauges, run by run'), multiples);
  root.append(h('details', {}, h('summary', {}, 'Libraries in this page'), h('pre', {}, page.notices)));
  return { page, table };
}
