// Curves over time or over a parameter, by uPlot.
import uPlot from 'uplot';
import { h, kColors, short } from './dom.js';

export const kMostCurves = 8;

/** Marks the time that a player shows. */
function timeMark(time) {
  return {
    hooks: {
      draw: (plot) => {
        const t = time();
        if (t === null) return;
        const x = plot.valToPos(t, 'x', true);
        if (x < plot.bbox.left || x > plot.bbox.left + plot.bbox.width) return;
        const context = plot.ctx;
        context.save();
        context.strokeStyle = '#555';
        context.setLineDash([4, 4]);
        context.beginPath();
        context.moveTo(x, plot.bbox.top);
        context.lineTo(x, plot.bbox.top + plot.bbox.height);
        context.stroke();
        context.restore();
      },
    },
  };
}

const axisValues = (plot, ticks) => ticks.map((tick) => short(Number(tick.toPrecision(12))));

/** A chart that is as wide as its place. `curves`: [{ label, values, dash? }]; `x` rises. */
export function chart({ title, x, xLabel, yLabel, curves, points = false, height = 220, mark = null, legend = true, range = null, xRange = null }) {
  const place = h('figure', { class: 'chart' }, h('figcaption', {}, title));
  const shown = curves.slice(0, kMostCurves);
  if (shown.length < curves.length) place.append(h('p', { class: 'note' }, `${shown.length} of ${curves.length} curves`));
  const axis = (label, size) => ({ label, size, labelSize: 18, gap: 3, stroke: '#444', font: '11px sans-serif', labelFont: '11px sans-serif', grid: { stroke: '#e6e8eb', width: 1 }, ticks: { stroke: '#c9ccd1', width: 1 }, values: axisValues });
  const options = {
    width: 320,
    height,
    scales: { x: xRange ? { time: false, range: () => xRange } : { time: false }, y: range ? { range: () => range } : {} },
    axes: [axis(xLabel, 30), axis(yLabel, 58)],
    legend: { show: legend },
    cursor: { drag: { x: true, y: false } },
    plugins: mark ? [timeMark(mark)] : [],
    series: [
      { label: xLabel, value: (plot, value) => short(value) },
      ...shown.map((curve, k) => ({
        label: curve.label,
        stroke: kColors[k % kColors.length],
        width: points ? 1 : 1.75,
        dash: curve.dash,
        spanGaps: true,
        points: points ? { show: true, size: 8, fill: kColors[k % kColors.length] } : { show: false },
        value: (plot, value) => short(value),
      })),
    ],
  };
  const plot = new uPlot(options, [x, ...shown.map((curve) => curve.values)], place);
  new ResizeObserver(() => {
    const width = Math.floor(place.clientWidth);
    if (width > 0 && width !== plot.width) plot.setSize({ width, height });
  }).observe(place);
  place.plot = plot;
  // The legend tells the values where the player stands; without a row yet, those of the last one before.
  place.showAt = (time) => {
    let row = 0;
    while (row + 1 < x.length && x[row + 1] <= time) ++row;
    plot.setLegend({ idx: row }, false);
    plot.redraw(false);
  };
  return place;
}

/** The columns of gauges.csv by gauge: Map of name → [{ part, values }], and the times. Empty cells are null. */
export function gaugesOf(rows) {
  const [header, ...lines] = rows;
  const numbers = (k) => lines.map((line) => (line[k] === '' || line[k] === undefined ? null : Number(line[k])));
  const times = numbers(0);
  const gauges = new Map();
  header.slice(1).forEach((name, k) => {
    const [gauge, ...part] = name.split('.');
    if (!gauges.has(gauge)) gauges.set(gauge, []);
    gauges.get(gauge).push({ column: name, part: part.join('.'), values: numbers(k + 1) });
  });
  return { times, gauges };
}
