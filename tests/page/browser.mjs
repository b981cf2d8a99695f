// What the tests of pages share: the program, a browser, and complaints.
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

export const kSkipped = 77;

/** Ends the test as skipped. */
export function skip(reason) {
  console.log(`skipped: ${reason}`);
  process.exit(kSkipped);
}

/** Playwright and Chromium, or the test is skipped. */
export async function openBrowser(root) {
  let playwright;
  try {
    playwright = createRequire(resolve(root, 'src/export/web/package.json'))('playwright-core');
  } catch {
    skip('playwright-core is not installed: npm --prefix src/export/web ci');
  }
  const program = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find((file) => file && existsSync(file));
  if (!program) skip('there is no Chromium (Debian: chromium)');
  return playwright.chromium.launch({
    executablePath: program,
    args: ['--no-sandbox', '--disable-gpu', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync', '--mute-audio'],
  });
}

/** A folder that is removed at the end of the process. */
export function temporaryFolder() {
  const folder = mkdtempSync(join(tmpdir(), 'froude-page-'));
  process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/** Runs the program; its output, or an exception where it fails with another status than `status`. */
export function froude(program, words, status = 0) {
  const result = spawnSync(program, words, { encoding: 'utf8', maxBuffer: 1 << 28 });
  if (result.status !== status) throw new Error(`froude ${words.join(' ')}: ${result.status}\n${result.stdout}\n${result.stderr}`);
  return result.stdout;
}

/** Opens a page from its file, offline; what the console says is kept in `page.complaints`. */
export async function openPage(browser, file, viewport = { width: 1280, height: 900 }) {
  const context = await browser.newContext({ viewport, offline: true });
  const page = await context.newPage();
  page.complaints = [];
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && !/ReadPixels/.test(message.text()) && page.complaints.push(message.text()));
  page.on('pageerror', (error) => page.complaints.push(String(error)));
  page.on('request', (request) => !/^(file|data|blob):/.test(request.url()) && page.complaints.push(`asks for ${request.url()}`));
  await page.goto(pathToFileURL(file).href, { timeout: 120000 });
  await page.evaluate(() => window.froude.ready.then(() => true));
  return page;
}

let failures = 0;
export function check(condition, text) {
  if (!condition) ++failures;
  console.log(`${condition ? 'ok  ' : 'FAIL'} ${text}`);
}
export function finish() {
  console.log(`${failures} failures`);
  process.exit(failures === 0 ? 0 : 1);
}

/** Different colours on the canvas, and the part of it that is not white. */
export function colorsOfCanvas(page, selector = 'canvas') {
  return page.evaluate((where) => {
    const canvas = document.querySelector(where);
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const pixels = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
    const seen = new Map();
    let inked = 0;
    let sum = 0;
    for (const pixel of pixels) {
      seen.set(pixel, (seen.get(pixel) ?? 0) + 1);
      if (pixel !== 0xffffffff) ++inked;
      sum = (Math.imul(sum, 31) + pixel) | 0;
    }
    return { colors: seen.size, inked: inked / pixels.length, sum };
  }, selector);
}

/** A script in Python with h5py, or null where there is none. */
export function python(script, words) {
  const program = ['/usr/bin/python3', 'python3'].find((name) => spawnSync(name, ['-c', 'import h5py']).status === 0);
  return program ? JSON.parse(execFileSync(program, ['-c', script, ...words], { encoding: 'utf8', maxBuffer: 1 << 28 })) : null;
}
