// Runs the tests of the page; 77 where there is no browser.
// Usage: node run.mjs REMESHD TEST_FILE...
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";

const [remeshd, ...files] = process.argv.slice(2);
const candidates = [
  process.env.CHROMIUM_PATH,
  "/usr/bin/chromium",
  "/usr/bin/chromium-browser",
  "/usr/bin/google-chrome",
];
const chromium = candidates.find((path) => path && existsSync(path));
if (!chromium) {
  console.error(
    "SKIPPED: there is no Chromium here, so the page was NOT tested. Install Debian's chromium (./dev setup does), or set CHROMIUM_PATH.",
  );
  process.exit(77);
}
const { status } = spawnSync(process.execPath, ["--test", ...files], {
  stdio: "inherit",
  env: { ...process.env, REMESHD_PATH: remeshd, CHROMIUM_PATH: chromium },
});
process.exit(status ?? 1);
