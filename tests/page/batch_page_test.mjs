// The page of a batch in a real browser. Usage: node batch_page_test.mjs ROOT PROGRAM [PICTURES]
import { existsSync, readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, colorsOfCanvas, finish, froude, openBrowser, openPage, temporaryFolder } from './browser.mjs';

const [root, program, pictures] = process.argv.slice(2);
const browser = await openBrowser(root);
const folder = join(temporaryFolder(), 'dams');
// The fourth spacing leaves a block of the scene without a single particle: that run is refused.
froude(program, ['batch', join(root, 'scenes/dam_break.toml'), '-o', folder, '--sweep', 'model.spacing=0.006,0.004,0.003,0.2', '--sweep', 'gravity=[0,-9.81],[0,-4.9]',
  '--until', '0.15', '--frames', 'h5', '--quiet'], 5);
const page = await openPage(browser, join(folder, 'index.html'));
const lines = readFileSync(join(folder, 'results.csv'), 'utf8').trim().split('\n');

const column = (name) => page.evaluate((wanted) => {
  const heads = [...document.querySelectorAll('.runs th button')].map((button) => button.dataset.column);
  const k = heads.indexOf(wanted);
  return [...document.querySelectorAll('.runs tbody tr')].map((row) => row.children[k].title || row.children[k].textContent);
}, name);
check((await column('run')).length === lines.length - 1 && lines.length === 9, `all ${lines.length - 1} runs are in the table`);
check((await column('status')).length === 8 && (await page.locator('td.status.refused').count()) === 2, 'what was refused is there');
for (const name of ['particles', 'wall_seconds', 'model.spacing']) {
  for (const down of [false, true]) {
    await page.click(`button[data-column="${name}"]`);
    const numbers = (await column(name)).filter((cell) => cell !== '').map(Number);
    const right = [...numbers].sort((a, b) => (down ? b - a : a - b));
    check(numbers.length >= 6 && JSON.stringify(numbers) === JSON.stringify(right), `sorted by ${name}, ${down ? 'falling' : 'rising'}: ${numbers.join(' ')}`);
  }
}
const hashes = new Set(await page.evaluate(() => window.froude.table.rows.map((row) => row[window.froude.table.header.indexOf('state_hash')]).filter(Boolean)));
check([...hashes].every((hash) => lines.some((line) => line.includes(hash))) && hashes.size === 6, 'the table is that of results.csv');
await page.fill('input[type=search]', '0.004');
check((await column('run')).length === 2, 'the filter leaves two runs');
await page.fill('input[type=search]', '');
await page.check('input[type=checkbox]');
check((await page.locator('.runs th').count()) === (await page.evaluate(() => window.froude.table.header.length)), 'all columns can be shown');
await page.uncheck('input[type=checkbox]');

check((await page.locator('.multiples .chart').count()) === 6, 'a small plot for each run that has gauges');
for (const [label, value] of [['x', 'model.spacing'], ['y', 'max_density_error'], ['gauge', 'energy.kinetic']]) await page.selectOption(`select[aria-label="${label}"]`, value);
const title = await page.textContent('.over figcaption');
check(title === 'max_density_error over model.spacing', `the plot over a parameter: ${title}`);
await page.waitForTimeout(300);
const over = await colorsOfCanvas(page, '.over canvas');
check(over.colors > 10, `it is drawn, in ${over.colors} colours`);
const small = await colorsOfCanvas(page, '.multiples canvas');
check(small.colors > 10, `so are the small ones, in ${small.colors}`);

const links = await page.evaluate(() => [...document.querySelectorAll('td:has(+ td) a')].map((a) => a.href));
const there = links.filter((link) => existsSync(fileURLToPath(link)));
check(there.length === 6, `${there.length} pages of runs are there to be followed`);
if (pictures) await page.screenshot({ path: join(pictures, 'batch.png'), fullPage: true });
check(page.complaints.length === 0, `the console is silent ${page.complaints.join('; ')}`);
await page.click(`a[href*="${encodeURIComponent('spacing=0.004')}"]`);
await page.waitForFunction(() => window.froude?.player);
check((await page.title()).startsWith('Dam break'), `a click leads to ${dirname(page.url()).split('/').pop()}`);

const phone = await openPage(browser, join(folder, 'index.html'), { width: 375, height: 740 });
const width = await phone.evaluate(() => document.documentElement.scrollWidth);
check(width <= 375, `a phone's width is enough: ${width} of 375 pixels`);
if (pictures) await phone.screenshot({ path: join(pictures, 'batch_phone.png') });
await browser.close();
finish();
