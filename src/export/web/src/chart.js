// The page of a chart: time against error for every case, both logarithmic, with what each point is under the pointer.
import uPlot from 'uplot';
import { h, kColors, short } from './dom.js';

const kNear = 14; // pixels between the pointer and a point that it tells about
const kHeight = 300;
const kFront = '#fad25a';
const kLeastError = 1e-7; // an error below it is drawn there

const lengthLabel = (metres) => (metres >= 1 ? `${short(metres)} m` : metres >= 0.01 ? `${short(metres * 100)} cm` : `${short(metres * 1000)} mm`);
const stepLabel = (point) => (point.courant > 0 ? `courant ${point.courant}` : 'own step');
const costOf = (point) => point.wall_seconds / point.simulated_seconds;

/** Ticks at decades alone are labelled. */
const decades = (plot, ticks) => ticks.map((tick) => (Math.abs(Math.log10(tick) - Math.round(Math.log10(tick))) < 1e-9 ? short(tick) : ''));

const drawn = (points) => points.filter((point) => point.error !== null && point.wall_seconds !== null);

/** Curves of a panel: points of one model with one step, from coarse to fine. */
function curvesOf(panel, colors) {
  const curves = new Map();
  for (const point of drawn(panel.points)) {
    const key = `${point.model}, ${stepLabel(point)}`;
    if (!curves.has(key)) curves.set(key, { label: key, color: colors.get(point.model), dash: point.courant > 0 ? [4, 3] : undefined, points: [] });
    curves.get(key).points.push(point);
  }
  for (const curve of curves.values()) curve.points.sort((a, b) => costOf(a) - costOf(b));
  return [...curves.values()];
}

/** Draws the front as steps below everything else: what is reached for a time, until the next point. */
function frontSteps(panel) {
  const front = panel.points.filter((point) => point.front).sort((a, b) => costOf(a) - costOf(b));
  return (plot) => {
    if (front.length === 0) return;
    const context = plot.ctx;
    const at = (point) => [plot.valToPos(costOf(point), 'x', true), plot.valToPos(Math.max(point.error, kLeastError), 'y', true)];
    context.save();
    context.beginPath();
    context.rect(plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height);
    context.clip();
    context.strokeStyle = kFront;
    context.lineWidth = 7 * devicePixelRatio;
    context.lineJoin = 'round';
    context.beginPath();
    front.forEach((point, i) => {
      const [x, y] = at(point);
      if (i > 0) context.lineTo(x, at(front[i - 1])[1]);
      context.lineTo(x, y);
    });
    context.lineTo(plot.bbox.left + plot.bbox.width, at(front.at(-1))[1]);
    context.stroke();
    const target = panel.points.find((point) => point.target > 0);
    if (target) {
      const y = plot.valToPos(target.target, 'y', true);
      context.strokeStyle = '#666';
      context.lineWidth = devicePixelRatio;
      context.setLineDash([2 * devicePixelRatio, 3 * devicePixelRatio]);
      context.beginPath();
      context.moveTo(plot.bbox.left, y);
      context.lineTo(plot.bbox.left + plot.bbox.width, y);
      context.stroke();
    }
    context.restore();
  };
}

/** Words about the point next to the pointer. */
function tips(points) {
  let tip = null;
  return {
    hooks: {
      init: (plot) => {
        tip = h('div', { class: 'tip', hidden: true });
        plot.over.append(tip);
      },
      setCursor: (plot) => {
        const { left, top } = plot.cursor;
        let [nearest, distance] = [null, kNear];
        for (const point of points) {
          const d = Math.hypot(plot.valToPos(costOf(point), 'x') - left, plot.valToPos(Math.max(point.error, kLeastError), 'y') - top);
          if (d < distance) [nearest, distance] = [point, d];
        }
        tip.hidden = nearest === null;
        if (nearest === null) return;
        tip.textContent = `${nearest.model}, ${lengthLabel(nearest.spacing)}, ${stepLabel(nearest)}: error ${short(nearest.error)}, ${short(costOf(nearest))} s a simulated second, ${short(nearest.particles)} particles, ${short(nearest.steps_per_second / 1e6)} million particle-steps/s${nearest.front ? '; on the front' : ''}`;
        tip.style.left = `${Math.min(left, Math.max(0, plot.over.clientWidth - 240))}px`;
        tip.style.top = `${top + 12}px`;
      },
    },
  };
}

function diagram(panel, colors) {
  const curves = curvesOf(panel, colors);
  const place = h('figure', { class: 'chart' }, h('figcaption', {}, `${panel.subject} (${panel.flow})`));
  const points = drawn(panel.points);
  if (points.length === 0) {
    place.append(h('p', { class: 'note' }, 'no run of this case ended'));
    return place;
  }
  const x = [...new Set(points.map(costOf))].sort((a, b) => a - b);
  const row = new Map(x.map((value, i) => [value, i]));
  const series = curves.map((curve) => {
    const values = x.map(() => null);
    for (const point of curve.points) values[row.get(costOf(point))] = Math.max(point.error, kLeastError);
    return values;
  });
  const axis = (label, size) => ({ label, size, labelSize: 18, gap: 3, stroke: '#444', font: '11px sans-serif', labelFont: '11px sans-serif', grid: { stroke: '#e6e8eb', width: 1 }, ticks: { stroke: '#c9ccd1', width: 1 }, values: decades });
  const wide = (plot, low, high) => [10 ** Math.floor(Math.log10(low) - 0.02), 10 ** Math.ceil(Math.log10(high) + 0.02)];
  const plot = new uPlot({
    width: 320,
    height: kHeight,
    scales: { x: { time: false, distr: 3, range: wide }, y: { distr: 3, range: wide } },
    axes: [axis('wall time of a simulated second [s]', 30), axis('error', 58)],
    legend: { live: false },
    cursor: { points: { show: false }, drag: { x: true, y: true } },
    plugins: [tips(points)],
    hooks: { drawAxes: [frontSteps(panel)] },
    series: [{ label: 'wall time' }, ...curves.map((curve) => ({ label: curve.label, stroke: curve.color, width: 1.5, dash: curve.dash, spanGaps: true, points: { show: true, size: 7, fill: curve.color } }))],
  }, [x, ...series], place);
  new ResizeObserver(() => {
    const width = Math.floor(place.clientWidth);
    if (width > 0 && width !== plot.width) plot.setSize({ width, height: kHeight });
  }).observe(place);
  place.plot = plot;
  return place;
}

/** What did not end, and why. */
function failures(panels) {
  const rows = panels.flatMap((panel) => panel.points.filter((point) => point.error === null).map((point) => [panel.subject, point.model, lengthLabel(point.spacing), stepLabel(point), point.state]));
  if (rows.length === 0) return null;
  return h('section', { class: 'wide' }, h('h2', {}, 'Runs that did not end'), h('table', { class: 'runs plain' },
    h('thead', {}, h('tr', {}, ['case', 'model', 'spacing', 'step', 'what happened'].map((name) => h('th', { scope: 'col' }, name)))),
    h('tbody', {}, rows.map((row) => h('tr', {}, row.map((cell) => h('td', {}, cell)))))));
}

function standings(page) {
  return h('section', { class: 'wide' }, h('h2', {}, 'On the front'), h('table', { class: 'runs plain' },
    h('thead', {}, h('tr', {}, ['model', 'fronts', 'of cases', 'where'].map((name) => h('th', { scope: 'col' }, name)))),
    h('tbody', {}, page.standings.map((own) => h('tr', {}, [own.model, own.fronts, own.cases, own.where.join(', ')].map((cell) => h('td', {}, String(cell))))))));
}

export async function showChart(page, place) {
  const models = [...new Set(page.panels.flatMap((panel) => panel.points.map((point) => point.model)))].sort();
  const colors = new Map(models.map((model, i) => [model, kColors[i % kColors.length]]));
  const diagrams = page.panels.map((panel) => diagram(panel, colors));
  place.append(...[
    h('h1', {}, page.title),
    h('p', {}, page.caption),
    h('p', { class: 'note' }, 'Lower left is better. Yellow: the front, which no other point of the case beats in both error and time. Dashed curves: a shorter step. Dotted: the target. Point at a mark to see what it is; a click on the legend hides a curve.'),
    h('section', { class: 'charts' }, diagrams),
    standings(page),
    failures(page.panels),
    h('details', {}, h('summary', {}, 'Notices'), h('pre', {}, page.notices)),
  ].filter((part) => part !== null));
  return { diagrams };
}
