// The page of a chart in a real browser. Usage: node chart_page_test.mjs ROOT PROGRAM [PICTURES]
// A build with assertions measures no times, so the points are made up here; page and program are those of a run.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { check, finish, froude, openBrowser, openPage, temporaryFolder } from './browser.mjs';

const [root, program, pictures] = process.argv.slice(2);
const browser = await openBrowser(root);
const out = temporaryFolder();

const point = (model, spacing, courant, error, wall, front) => ({ model, spacing, courant, particles: 100, error, target: 0.02, wall_seconds: wall, simulated_seconds: 2, steps_per_second: 1e6, state: error === null ? 'unstable: speed' : 'done', front });
const data = {
  kind: 'chart',
  title: 'Speed against accuracy',
  caption: 'a machine',
  panels: [
    { flow: 'splash', subject: 'dam', points: [point('pbf', 0.02, 0, 0.1, 1, true), point('pbf', 0.01, 0, 0.05, 8, false), point('apic', 0.02, 1, 0.004, 4, true), point('wcsph', 0.02, 0, null, null, false)] },
    { flow: 'soft', subject: 'csm1', points: [point('stvk', 0.02, 0, 0, 1, true)] },
    { flow: 'soft', subject: 'csm2', points: [point('stvk', 0.02, 0, null, 1, false)] },
  ],
  standings: [{ model: 'pbf', fronts: 1, cases: 1, where: ['dam'] }],
  notices: 'notices',
};

froude(program, ['run', join(root, 'scenes/dam_break.toml'), '-o', join(out, 'run'), '--quiet', '--until', '0.01', '--set', 'model.spacing=0.05', '--frames', 'none']);
const html = readFileSync(join(out, 'run/index.html'), 'utf8');
const chart = join(out, 'chart.html');
writeFileSync(chart, html.replace(/(<script type="application\/json" id="data">)[^]*?(<\/script>)/, (_, head, tail) => head + JSON.stringify(data).replaceAll('<', '\\u003c') + tail));

for (const viewport of [{ width: 1280, height: 900 }, { width: 390, height: 800 }]) {
  const page = await openPage(browser, chart, viewport);
  check(await page.locator('figure.chart').count() === 3, 'every case has a diagram');
  check(await page.locator('figure.chart canvas').count() === 2, 'a case in which no run ended has words instead of curves');
  check((await page.locator('figure.chart').nth(2).textContent()).includes('no run of this case ended'), 'and says so');
  const inside = await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth);
  check(inside, `nothing is wider than ${viewport.width} pixels`);
  const at = await page.evaluate(() => {
    const { plot } = document.querySelector('figure.chart');
    const box = plot.over.getBoundingClientRect();
    return [box.left + plot.valToPos(2, 'x'), box.top + plot.valToPos(0.004, 'y')];
  });
  await page.mouse.move(at[0] + 2, at[1] + 2);
  await page.waitForFunction(() => [...document.querySelectorAll('.tip')].some((tip) => !tip.hidden));
  const tip = await page.evaluate(() => [...document.querySelectorAll('.tip')].find((t) => !t.hidden).textContent);
  check(tip.startsWith('apic, 2 cm, courant 1: error 0.004, 2 s a simulated second') && tip.endsWith('on the front'), `the pointer tells what a point is: ${tip}`);
  const table = await page.locator('table').last().textContent();
  check(table.includes('wcsph') && table.includes('unstable: speed'), 'what did not end is listed with its reason');
  check(page.complaints.length === 0, `no complaint: ${page.complaints}`);
  if (pictures) await page.screenshot({ path: join(pictures, `chart_${viewport.width}.png`), fullPage: true });
}
await browser.close();
finish();
