// The page of a distance field in a real browser, against `froude field --at`. Usage: node field_page_test.mjs ROOT PROGRAM [PICTURES]
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { check, colorsOfCanvas, finish, froude, openBrowser, openPage, temporaryFolder } from './browser.mjs';

const [root, program, pictures] = process.argv.slice(2);
const browser = await openBrowser(root);
const out = temporaryFolder();
let seed = 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;

for (const [shape, ending] of [['gear', 'toml'], ['spiral', 'toml'], ['needle', 'toml'], ['kite', 'csv']]) {
  const source = join(root, 'scenes/shapes', `${shape}.${ending}`);
  const file = join(out, `${shape}.html`);
  froude(program, ['field', source, '-o', file]);
  const page = await openPage(browser, file);
  const bounds = await page.evaluate(() => window.froude.field.bounds);

  // Points near and far, and the vertices themselves moved by a little.
  const [x0, x1, y0, y1] = bounds;
  const size = Math.max(x1 - x0, y1 - y0);
  const points = Array.from({ length: 400 }, () => [x0 + (2 * random() - 0.5) * (x1 - x0), y0 + (2 * random() - 0.5) * (y1 - y0)]);
  for (let k = 0; k < 20; ++k) points.push([x0 + 40 * (random() - 0.5) * size, y0 + 40 * (random() - 0.5) * size]);
  const vertices = await page.evaluate(() => window.froude.field.edges.map((edge) => edge.slice(0, 2)));
  for (const [x, y] of vertices.slice(0, 60)) points.push([x + 1e-3 * size * (random() - 0.5), y + 1e-3 * size * (random() - 0.5)]);
  const table = join(out, 'points.csv');
  writeFileSync(table, points.map((p) => p.join()).join('\n') + '\n');
  const right = froude(program, ['field', source, '--at', table]).trim().split('\n').slice(1).map((line) => line.split(',').map(Number));
  const here = await page.evaluate((list) => list.map(([x, y]) => { const s = window.froude.field.sample(x, y); return [x, y, s.distance, ...s.normal, ...s.closest]; }), points);
  let worst = 0;
  let turned = 0;
  right.forEach((row, k) => {
    const scale = Math.max(size, Math.abs(row[0]), Math.abs(row[1]));
    worst = Math.max(worst, Math.abs(row[2] - here[k][2]) / scale);
    // Where two features are equally near, either is right: the closest point may be another, its distance may not.
    const other = Math.hypot(row[5] - here[k][5], row[6] - here[k][6]) > 1e-9 * scale;
    if (!other && Math.abs(row[2]) > 1e-6 * scale && Math.hypot(row[3] - here[k][3], row[4] - here[k][4]) > 1e-6) ++turned;
    if (other && Math.abs(Math.hypot(row[0] - here[k][5], row[1] - here[k][6]) - Math.abs(row[2])) > 1e-12 * scale) ++turned;
  });
  check(right.length === points.length && worst < 1e-14, `${shape}: ${points.length} distances are those of froude field --at, within ${worst.toExponential(1)} of its size`);
  check(turned === 0, `${shape}: so are normals and closest points`);

  // The pointer, the slider, the cells.
  const before = await colorsOfCanvas(page);
  check(before.colors > 50, `${shape}: the field is drawn, in ${before.colors} colours`);
  const box = await page.locator('canvas').first().boundingBox();
  await page.mouse.move(box.x + 0.3 * box.width, box.y + 0.4 * box.height);
  const told = await page.evaluate(() => ({ pointer: window.froude.explorer.pointer, sample: window.froude.explorer.sample, text: document.querySelector('.told').textContent }));
  writeFileSync(table, `${told.pointer.join()}\n`);
  const asked = froude(program, ['field', source, '--at', table]).trim().split('\n')[1].split(',').map(Number);
  check(Math.abs(asked[2] - told.sample.distance) < 1e-14 * size && told.text.includes('translation vector'), `${shape}: under the pointer stands ${told.text.slice(0, 60)}`);
  const slide = async (share) => {
    await page.evaluate((t) => { const slider = window.froude.explorer.slider; slider.value = Number(slider.min) + t * (slider.max - slider.min); slider.dispatchEvent(new Event('input')); }, share);
    return colorsOfCanvas(page);
  };
  const [one, two] = [await slide(0.55), await slide(0.8)];
  check(one.sum !== two.sum, `${shape}: the slider moves the contour`);
  const off = await page.evaluate(() => {
    const { explorer, field } = window.froude;
    const level = Number(explorer.slider.value);
    return { worst: Math.max(...explorer.contour(level).flat().map((p) => Math.abs(field.sample(...p).distance - level))), step: explorer.step };
  });
  check(off.worst < 0.5 * off.step, `${shape}: the contour lies where the distance is, within ${(off.worst / off.step).toFixed(3)} pixels`);
  await page.check('input[type=checkbox]');
  check((await colorsOfCanvas(page)).sum !== two.sum, `${shape}: cells are drawn`);

  // Two polygons: apart, dragged together, parted by the vector.
  const apart = await page.evaluate(() => window.froude.pair.result.distance);
  check(apart > 0, `${shape}: two polygons are ${apart.toPrecision(3)} m apart`);
  const sampled = await page.evaluate(() => {
    // The least distance between points along both outlines, never less than what is told.
    const [a, b] = window.froude.pair.polygons;
    const along = (polygon) => polygon.flatMap((p, k) => { const q = polygon[(k + 1) % polygon.length]; return Array.from({ length: 200 }, (_, t) => [p[0] + (t / 200) * (q[0] - p[0]), p[1] + (t / 200) * (q[1] - p[1])]); });
    let least = Infinity;
    const [pa, pb] = [along(a), along(b)];
    for (const p of pa) for (const q of pb) least = Math.min(least, Math.hypot(p[0] - q[0], p[1] - q[1]));
    return least;
  });
  check(sampled >= apart - 1e-12 && sampled < apart + 0.02 * size, `${shape}: points along their outlines say ${sampled.toPrecision(3)} m`);
  const stage = await page.locator('canvas').nth(1).boundingBox();
  const drag = (fromX, toX) => page.mouse.move(stage.x + fromX * stage.width, stage.y + fromX * 0 + 0.36 * stage.height).then(() => page.mouse.down()).then(() => page.mouse.move(stage.x + toX * stage.width, stage.y + 0.45 * stage.height, { steps: 5 })).then(() => page.mouse.up());
  if (pictures) await page.screenshot({ path: join(pictures, `field_${shape}.png`), fullPage: true });
  await page.locator('canvas').nth(1).scrollIntoViewIfNeeded();
  Object.assign(stage, await page.locator('canvas').nth(1).boundingBox());
  await drag(0.734, 0.3);
  const depth = await page.evaluate(() => window.froude.pair.result.depth);
  check(depth > 0, `${shape}: dragged into each other they overlap by ${Number(depth).toPrecision(3)} m`);
  const parted = await page.evaluate(() => {
    const { pair } = window.froude;
    const { depth: by, normal } = pair.result;
    pair.move(1, 1.001 * by * normal[0], 1.001 * by * normal[1]);
    return pair.result.distance;
  });
  check(parted > 0 && parted < 0.01 * size, `${shape}: and the vector parts them`);
  check(page.complaints.length === 0, `${shape}: the console is silent ${page.complaints.join('; ')}`);
  await page.context().close();
}

const phone = await openPage(browser, join(out, 'gear.html'), { width: 375, height: 740 });
const width = await phone.evaluate(() => document.documentElement.scrollWidth);
check(width <= 375, `a phone's width is enough: ${width} of 375 pixels`);
await browser.close();
finish();
