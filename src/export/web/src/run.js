// The page of a run: player, gauges, summary, scene.
import { h, parseCsv, short } from './dom.js';
import { FrameStore } from './frames.js';
import { Player } from './player.js';
import { chart, gaugesOf } from './plots.js';

const kCards = [
  ['status', 'status', ''], ['particles', 'particles', ''], ['simulated_seconds', 'simulated', 's'], ['wall_seconds', 'wall time', 's'],
  ['particle_steps_per_second', 'particle-steps', '/s'], ['leaks', 'leaks', ''], ['max_density_error', 'largest compression', ''],
  ['volume_error', 'volume error', ''], ['energy_drift', 'energy drift', ''],
];

/** Keys and values of a summary, nested ones with their path. */
export function flatten(object, before = '') {
  return Object.entries(object).flatMap(([key, value]) =>
    value !== null && typeof value === 'object' && !Array.isArray(value) ? flatten(value, `${before}${key}.`) : [[before + key, value]]);
}

const textOf = (value) => (Array.isArray(value) ? value.join('; ') : value === null ? '' : String(value));

function cards(summary) {
  return h('div', { class: 'cards' }, kCards.filter(([key]) => key in summary).map(([key, label, unit]) =>
    h('div', { class: `card ${key} ${summary[key]}` }, h('span', {}, label), h('b', { 'data-card': key }, `${short(summary[key])} ${unit}`.trim()))));
}

function summaryTable(summary) {
  return h('details', { class: 'summary', open: true }, h('summary', {}, 'Summary'),
    h('dl', { class: 'numbers' }, flatten(summary).map(([key, value]) =>
      h('div', {}, h('dt', {}, key), h('dd', { 'data-key': key, 'data-value': JSON.stringify(value) }, textOf(value))))));
}

function gaugeCharts(page, time) {
  const rows = parseCsv(page.gauges);
  if (rows.length < 2) return [];
  const { times, gauges } = gaugesOf(rows);
  return [...gauges].map(([name, columns]) => {
    const units = [...new Set(columns.map(({ column }) => page.summary.gauges?.[column] ?? ''))];
    const curves = columns.map(({ part, values }) => ({ label: part || name, values }));
    return chart({ title: name, x: times, xLabel: 't (s)', yLabel: units.length === 1 && units[0] ? units[0] : '', curves, mark: time });
  });
}

function details(title, text) {
  return h('details', {}, h('summary', {}, title), h('pre', {}, text));
}

export async function showRun(page, root) {
  const { summary } = page;
  const store = new FrameStore(page.frames, [...document.querySelectorAll('script.frames')]);
  root.append(h('header', {}, h('h1', {}, page.title), h('p', {}, `${summary.model ?? ''} · Froude ${summary.froude_version ?? ''}`)), cards(summary));
  if (summary.reason) root.append(h('p', { class: 'reason' }, summary.reason));
  let player = null;
  let shownTime = null;
  const charts = [];
  if (store.count > 0) {
    try {
      player = new Player(page, store, (time) => {
        shownTime = time;
        for (const figure of charts) figure.showAt(time);
      });
      root.append(player.element, h('p', { class: 'note keys' }, 'Space plays, arrows step (with Shift ten frames), + and − zoom, 0 shows all; drag and wheel move and zoom.'));
    } catch (error) {
      root.append(h('p', { class: 'reason' }, `The player cannot be shown: ${error.message}.`));
    }
  } else {
    root.append(h('p', { class: 'note' }, 'The run wrote no frames.'));
  }
  charts.push(...gaugeCharts(page, () => shownTime));
  if (charts.length > 0) root.append(h('h2', {}, 'Gauges'), h('div', { class: 'charts' }, charts));
  root.append(summaryTable(summary), details('Scene', page.scene), details('Libraries in this page', page.notices));
  if (player) await player.start();
  return { page, store, player, charts };
}
