// Makes the pictures of pages in docs/images from shipped scenes. Usage: node bench/gallery.mjs PROGRAM [PICTURE...]
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { froude, openBrowser, openPage, temporaryFolder } from '../tests/page/browser.mjs';

const root = join(dirname(fileURLToPath(import.meta.url)), '..');
const [program, ...wanted] = process.argv.slice(2);
const browser = await openBrowser(root);
const out = temporaryFolder();
const scene = (name) => join(root, 'scenes', `${name}.toml`);

/** Runs a scene and shows the frame at a time. */
async function run(name, until, ...words) {
  froude(program, ['run', scene(name), '-o', join(out, name), '--frames', 'h5', '--until', String(until), '--quiet', ...words]);
  const page = await openPage(browser, join(out, name, 'index.html'), { width: 1100, height: 860 });
  await page.evaluate(() => window.froude.player.show(window.froude.store.count - 1));
  return page;
}

const pictures = {
  page_run: () => run('gate', 1.2, '--set', 'output.every=0.05'),
  page_soft: () => run('soft_and_fluid', 0.6, '--set', 'output.every=0.05'),
  page_batch: async () => {
    const folder = join(out, 'dams');
    froude(program, ['batch', scene('dam_break'), '-o', folder, '--sweep', 'model.spacing=0.006,0.004,0.003', '--sweep', 'gravity=[0,-9.81],[0,-4.9]', '--until', '0.15', '--frames', 'h5', '--quiet']);
    return openPage(browser, join(folder, 'index.html'), { width: 1100, height: 860 });
  },
  page_field: async () => {
    froude(program, ['field', join(root, 'scenes/shapes/gear.toml'), '-o', join(out, 'gear.html')]);
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
