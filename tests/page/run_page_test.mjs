// The page of a run in a real browser. Usage: node run_page_test.mjs ROOT PROGRAM [PICTURES]
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { check, colorsOfCanvas, finish, froude, openBrowser, openPage, python, temporaryFolder } from './browser.mjs';

const [root, program, pictures] = process.argv.slice(2);
const browser = await openBrowser(root);
const out = temporaryFolder();

/** Runs a shipped scene, coarse and short. */
function run(scene, ...words) {
  const folder = join(out, scene);
  froude(program, ['run', join(root, 'scenes', `${scene}.toml`), '-o', folder, '--quiet', ...words]);
  return folder;
}
const shoot = (page, name) => pictures && page.screenshot({ path: join(pictures, `${name}.png`), fullPage: true });
const position = (page) => page.evaluate(() => ({ index: window.froude.player.index, drawn: window.froude.player.drawn, zoom: window.froude.player.painter.zoom, playing: window.froude.player.playing }));

/** What the page unpacked of a frame: id → x, y in metres, speed byte; fluid, bullets, soft. */
const unpacked = (page, k) => page.evaluate(async (index) => {
  const { store, page: data } = window.froude;
  const frame = await store.get(index);
  const [x0, y0, x1, y1] = data.box;
  return frame.species.map((s) => Array.from(s.id, (id, i) => [id, x0 + (s.x[i] / 65535) * (x1 - x0), y0 + (s.y[i] / 65535) * (y1 - y0), s.speed[i]]));
}, k);

const kFrameOfH5 = `
import h5py, json, sys
f = h5py.File(sys.argv[1] + '/frames.h5', 'r')
g = f['frame_%05d' % int(sys.argv[2])]
print(json.dumps({'count': len(f), 'time': float(g.attrs['time']), 'position': g['position'][:].tolist(), 'velocity': g['velocity'][:].tolist(),
  'species': g['species'][:].tolist(), 'id': g['id'][:].tolist(), 'bodies': g['bodies'][:].tolist()}))`;

/** Positions in the page are those of frames.h5, as far as 16 bits tell. */
async function compareWithFrames(page, folder, k) {
  const there = python(kFrameOfH5, [folder, String(k)]);
  if (!there) return console.log('skip python3 has no h5py: positions are not compared with frames.h5');
  const here = await unpacked(page, k);
  const box = await page.evaluate(() => window.froude.page.box);
  const error = [(box[2] - box[0]) / 131070, (box[3] - box[1]) / 131070].map((half) => 1.01 * half + 1e-6);
  const top = await page.evaluate(() => window.froude.page.scales[0]?.high ?? 1);
  const found = here.map((list) => new Map(list.map((row) => [row[0], row])));
  let far = 0;
  let slow = 0;
  there.id.forEach((id, i) => {
    const row = found[there.species[i]].get(id);
    if (!row || Math.abs(row[1] - there.position[i][0]) > error[0] || Math.abs(row[2] - there.position[i][1]) > error[1]) ++far;
    else if (Math.abs(row[3] - Math.min(255, (255 * Math.hypot(...there.velocity[i])) / top)) > 0.51) ++slow;
  });
  check(here.flat().length === there.id.length && far === 0, `frame ${k}: ${there.id.length} positions are those of frames.h5`);
  check(slow === 0, `frame ${k}: and so are the speeds`);
}

const folder = run('dam_break', '--set', 'model.spacing=0.004', '--until', '0.5', '--frames', 'h5');
const page = await openPage(browser, join(folder, 'index.html'));
const summary = JSON.parse(readFileSync(join(folder, 'summary.json'), 'utf8'));

// It draws, and what it draws changes.
const first = await colorsOfCanvas(page);
check(first.colors > 2 && first.inked > 0.02, `the first frame is not blank: ${first.colors} colours on ${(100 * first.inked).toFixed(1)} % of the canvas`);
check((await page.evaluate(() => window.froude.store.count)) === summary.frames, `all ${summary.frames} frames are there`);
await page.click('.play');
await page.waitForFunction(() => window.froude.player.drawn > 12, null, { timeout: 60000 });
check((await position(page)).playing, 'a click plays');
await page.click('.play');
const played = await colorsOfCanvas(page);
check(played.sum !== first.sum && played.colors > 8, `a later frame is another picture, of ${played.colors} colours`);

// Scrubbing, keys, colours.
await page.evaluate(() => { const slider = document.querySelector('input[type=range]'); slider.value = '40'; slider.dispatchEvent(new Event('input')); });
await page.waitForFunction(() => window.froude.player.frame && document.querySelector('.clock').textContent === `${window.froude.store.times[40].toFixed(3)} s`);
check((await position(page)).index === 40, 'the slider scrubs');
await page.focus('canvas');
const press = async (key) => { await page.keyboard.press(key); await page.waitForTimeout(50); return position(page); };
check((await press('ArrowRight')).index === 41, 'an arrow steps on');
check((await press('Shift+ArrowLeft')).index === 31, 'and with Shift ten frames back');
const wide = (await position(page)).zoom;
check((await press('+')).zoom > wide, 'plus zooms in');
check(Math.abs((await press('-')).zoom - wide) < 1e-9, 'minus zooms out');
check((await press(' ')).playing, 'space plays');
check(!(await press(' ')).playing, 'and stops');
for (const by of ['pressure', 'phase', 'speed']) {
  await page.selectOption('select[aria-label=Colour]', by);
  check((await colorsOfCanvas(page)).inked > 0.02, `coloured by ${by}`);
}
await compareWithFrames(page, folder, 0);
await compareWithFrames(page, folder, 37);

// The numbers are those of the summary.
const shown = await page.evaluate(() => Object.fromEntries([...document.querySelectorAll('[data-key]')].map((cell) => [cell.dataset.key, JSON.parse(cell.dataset.value)])));
const flat = (object, before = '') => Object.entries(object).flatMap(([key, value]) => value && typeof value === 'object' && !Array.isArray(value) ? flat(value, `${before}${key}.`) : [[before + key, value]]);
const wrong = flat(summary).filter(([key, value]) => JSON.stringify(shown[key]) !== JSON.stringify(value));
check(Object.keys(shown).length > 40 && wrong.length === 0, `${Object.keys(shown).length} numbers are those of summary.json ${wrong.join(' ')}`);
check((await page.textContent('[data-key=state_hash]')) === summary.state_hash, 'the state hash is spelled out');

// The gauges are those of gauges.csv.
const [header, ...rows] = readFileSync(join(folder, 'gauges.csv'), 'utf8').trim().split('\n').map((line) => line.split(','));
const curves = await page.evaluate(() => window.froude.charts.map((figure) => ({ title: figure.querySelector('figcaption').textContent, data: figure.plot.data })));
const names = [...new Set(header.slice(1).map((name) => name.split('.')[0]))];
check(curves.length === names.length && curves.length > 0, `${names.length} gauges, ${curves.length} plots`);
const lastOf = (values) => values[values.length - 1];
check(rows.length === curves[0].data[0].length && Number(lastOf(rows)[0]) === lastOf(curves[0].data[0]), 'a plot has every row');
await page.evaluate(() => window.froude.player.show(window.froude.store.count - 1));
await page.waitForTimeout(200);
await shoot(page, 'dam_break');
check(page.complaints.length === 0, `the console is silent ${page.complaints.join('; ')}`);

// On a phone.
const phone = await openPage(browser, join(folder, 'index.html'), { width: 375, height: 740 });
const width = await phone.evaluate(() => document.documentElement.scrollWidth);
check(width <= 375, `a phone's width is enough: ${width} of 375 pixels`);
check((await colorsOfCanvas(phone)).inked > 0.02, 'and it draws there');
await shoot(phone, 'phone');
check(phone.complaints.length === 0, `the console is silent ${phone.complaints.join('; ')}`);

// Soft bodies and ropes, bullets and sinks, free bodies: whatever a scene has.
for (const [scene, until, frame] of [['jelly_stack', '0.5', 20], ['rope_bridge', '0.3', 10], ['fountain', '1.0', 45], ['soft_and_fluid', '0.3', 10], ['tumbler', '0.2', 5]]) {
  const words = ['--until', until, '--frames', 'h5', ...(scene === 'soft_and_fluid' ? ['--set', 'model.spacing=0.04'] : [])];
  const where = run(scene, ...words);
  const other = await openPage(browser, join(where, 'index.html'));
  await other.evaluate((k) => window.froude.player.show(k), frame);
  const picture = await colorsOfCanvas(other);
  check(picture.colors >= 3 && picture.inked > 0.01, `${scene}: ${picture.colors} colours on ${(100 * picture.inked).toFixed(1)} % of the canvas`);
  await compareWithFrames(other, where, Math.min(frame, (await other.evaluate(() => window.froude.store.count)) - 1));
  check(other.complaints.length === 0, `${scene}: the console is silent ${other.complaints.join('; ')}`);
  await shoot(other, scene);
  await other.context().close();
}

// Without frames there is no player, and a run that has none says so.
const bare = await openPage(browser, join(run('still_tank', '--frames', 'none', '--until', '0.02'), 'index.html'));
check((await bare.locator('canvas').count()) < 1 || (await bare.locator('.player').count()) === 0, 'a run without frames has no player');
check(bare.complaints.length === 0, `the console is silent ${bare.complaints.join('; ')}`);

await browser.close();
finish();
