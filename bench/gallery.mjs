// Makes the pictures of pages in docs/images from shipped scenes. Usage: node bench/gallery.mjs PROGRAM [PICTURE...]
import { symlinkSync } from 'node:fs';
import { delimiter, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { froude, openBrowser, openPage, temporaryFolder } from '../tests/page/browser.mjs';

const root = join(dirname(fileURLToPath(import.meta.url)), '..');
const [built, ...wanted] = process.argv.slice(2);
const browser = await openBrowser(root);
const out = temporaryFolder();
// Pages show their command: it is to read as a user's, whatever machine draws the pictures.
symlinkSync(resolve(built), join(out, 'froude'));
symlinkSync(join(root, 'scenes'), join(out, 'scenes'));
process.chdir(out);
process.env.PATH = `${out}${delimiter}${process.env.PATH}`;
const program = 'froude';
const scene = (name) => `scenes/${name}.toml`;

/** Runs a scene and shows the frame at a time. */
async function run(name, until, ...words) {
  froude(program, ['run', scene(name), '-o', name, '--frames', 'h5', '--until', String(until), '--quiet', ...words]);
  const page = await openPage(browser, join(out, name, 'index.html'), { width: 1100, height: 860 });
  await page.evaluate(() => window.froude.player.show(window.froude.store.count - 1));
  return page;
}

const pictures = {
  page_run: () => run('gate', 1.2, '--set', 'output.every=0.05'),
  page_soft: () => run('soft_and_fluid', 0.6, '--set', 'output.every=0.05'),
  page_batch: async () => {
    froude(program, ['batch', scene('dam_break'), '-o', 'dams', '--sweep', 'model.spacing=0.006,0.004,0.003', '--sweep', 'gravity=[0,-9.81],[0,-4.9]', '--until', '0.15', '--frames', 'h5', '--quiet']);
    return openPage(browser, join(out, 'dams/index.html'), { width: 1100, height: 860 });
  },
  page_field: async () => {
    froude(program, ['field', 'scenes/shapes/gear.toml', '-o', 'gear.html']);
    const page = await openPage(browser, join(out, 'gear.html'), { width: 900, height: 1250 });
    await page.check('input[type=checkbox]');
    const box = await page.locator('canvas').first().boundingBox();
    await page.mouse.move(box.x + 0.22 * box.width, box.y + 0.4 * box.height);
    return page;
  },
};

for (const [name, make] of Object.entries(pictures)) {
  if (wanted.length > 0 && !wanted.includes(name)) continue;
  const page = await make();
  await page.waitForTimeout(300);
  await page.screenshot({ path: join(root, 'docs/images', `${name}.png`) });
  console.log(`docs/images/${name}.png`);
}
await browser.close();
