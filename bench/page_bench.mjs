// How large the page of a run is, how soon it shows its first frame, and how many frames a second it plays.
// Usage: node bench/page_bench.mjs RUN_FOLDER [SECONDS]     (RUN_FOLDER: of a finished run; see docs/pages.md)
import { readFileSync, statSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { openBrowser } from '../tests/page/browser.mjs';

const root = join(dirname(fileURLToPath(import.meta.url)), '..');
const [folder, seconds = '10'] = process.argv.slice(2);
const file = join(folder, 'index.html');
const browser = await openBrowser(root);
const page = await (await browser.newContext({ viewport: { width: 1280, height: 900 }, offline: true })).newPage();
const complaints = [];
page.on('pageerror', (error) => complaints.push(String(error)));
page.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));

const begin = performance.now();
await page.goto(pathToFileURL(file).href, { timeout: 120000 });
await page.evaluate(() => window.froude.ready.then(() => true));
const load = (performance.now() - begin) / 1000;
const store = await page.evaluate(() => ({ frames: window.froude.store.count, particles: window.froude.store.particles.reduce((a, b) => a + b, 0), packed: window.froude.store.packedBytes }));

const scrubs = await page.evaluate(async () => {
  const { player, store } = window.froude;
  const times = [];
  for (const share of [0.93, 0.17, 0.61, 0.38, 0.79]) {
    const from = performance.now();
    await player.show(Math.floor(share * store.count));
    times.push(performance.now() - from);
  }
  return times.sort((a, b) => a - b);
});

// At a clock that asks for 33 other frames a second: a page that cannot, shows fewer.
const played = await page.evaluate(async (most) => {
  const { player, store } = window.froude;
  await player.show(0);
  player.speed = (store.times[store.count - 1] / store.count) * 33;
  const from = performance.now();
  const before = player.drawn;
  player.play();
  while (player.playing && performance.now() - from < 1000 * most) await new Promise((wait) => setTimeout(wait, 20));
  player.pause();
  return { frames: player.drawn - before, seconds: (performance.now() - from) / 1000 };
}, Number(seconds));
await browser.close();
const summary = JSON.parse(readFileSync(join(folder, 'summary.json'), 'utf8'));
console.log('page,particles,frames,bytes_per_particle_frame,page_bytes,load_seconds,frames_per_second,median_scrub_ms,console_errors,commit');
console.log([summary.scene, summary.particles, store.frames, (store.packed / store.particles).toFixed(3), statSync(file).size, load.toFixed(2),
  (played.frames / played.seconds).toFixed(1), scrubs[2].toFixed(0), complaints.length, summary.git_commit].join(','));
process.exit(complaints.length === 0 ? 0 : 1);
