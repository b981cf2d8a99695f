// Reads the data of the page and shows what kind of page it is.
import 'uplot/dist/uPlot.min.css';
import './style.css';
import { showBatch } from './batch.js';
import { showChart } from './chart.js';
import { showField } from './field.js';
import { showRun } from './run.js';

const kinds = { run: showRun, field: showField, batch: showBatch, chart: showChart };

const page = JSON.parse(document.getElementById('data').textContent);
document.title = page.title;
// What is on the page, for those who look at it from a console; `ready` once the first picture stands.
window.froude = { ready: kinds[page.kind](page, document.getElementById('page')).then((parts) => Object.assign(window.froude, parts)) };
