// The committed pages are what package-lock.json and the sources give, byte by byte. Usage: node rebuild_test.mjs ROOT
import { spawnSync } from 'node:child_process';
import { cpSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { check, finish, skip, temporaryFolder } from './browser.mjs';

const web = join(process.argv[2], 'src/export/web');
const copy = temporaryFolder();
for (const name of ['package.json', 'package-lock.json', 'build.mjs', 'src']) cpSync(join(web, name), join(copy, name), { recursive: true });
const install = spawnSync('npm', ['ci', '--no-audit', '--no-fund', '--ignore-scripts'], { cwd: copy, encoding: 'utf8' });
if (install.status !== 0) skip(`npm cannot install the packages: ${install.error ?? install.stderr}`);
const build = spawnSync(process.execPath, ['build.mjs'], { cwd: copy, encoding: 'utf8' });
check(build.status === 0, `the pages are built ${build.stderr}`);
const committed = readdirSync(join(web, 'dist')).sort();
check(committed.join() === readdirSync(join(copy, 'dist')).sort().join(), `dist holds ${committed.join(', ')}`);
for (const name of committed) check(readFileSync(join(web, 'dist', name)).equals(readFileSync(join(copy, 'dist', name))), `${name} is the same`);
finish();
