// Pictures of the page, for its README and for whoever looks after a failure. REMESHD_PAGE_PICTURES says where they go.
import assert from "node:assert/strict";
import { mkdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { openPage, pause, stage, turned } from "./support.mjs";

const kMostBytes = 200_000;

const set = stage();
const folder = process.env.REMESHD_PAGE_PICTURES ?? set.folder.path;
mkdirSync(folder, { recursive: true });

function picture(name, options, prepare) {
  test(name, async () => {
    const visitor = await openPage(set.browser, set.daemon.origin, { width: 1361, height: 850, ...options });
    try {
      await prepare(visitor);
      await visitor.waitForText("#forecast", /^About /);
      await pause(300);
      const path = join(folder, `${name}.jpg`);
      await visitor.page.screenshot({ path, type: "jpeg", quality: 84 });
      assert.ok(statSync(path).size < kMostBytes, `${statSync(path).size} bytes`);
      assert.deepEqual(visitor.faults, []);
    } finally {
      await visitor.close();
    }
  });
}

async function sample({ page, waitForText }, name) {
  const button = await page.waitForSelector(`::-p-xpath(//div[@id="samples"]/button[.="${name}"])`);
  await button.click();
  await waitForText("#before-count", /^[\d,]+ faces$/);
}

picture("remeshed", {}, async (visitor) => {
  await sample(visitor, "Bracket");
  await visitor.run();
});

picture("angles-dark", { scheme: "dark" }, async (visitor) => {
  const { page, type, run } = visitor;
  await sample(visitor, "Hub");
  await type("#option-max_edge_length", "4");
  await page.select("#colouring", "angle");
  await page.select("#section-axis", "1");
  await run();
  await visitor.tab("report");
});

picture("surfaces", {}, async (visitor) => {
  const { page, open, run, tab } = visitor;
  // A knob: a base with a chamfer, a fillet, a shaft, and a ball on it.
  const arc = (radius, height, r, from, to, steps) =>
    Array.from({ length: steps + 1 }, (_, i) => {
      const angle = ((from + ((to - from) * i) / steps) * Math.PI) / 180;
      return [radius + r * Math.cos(angle), height + r * Math.sin(angle)];
    });
  const ball = arc(0, 34, 10, (-Math.acos(0.6) * 180) / Math.PI, 90, 14).slice(0, -1);
  const outline = [[0, 0], [20, 0], [20, 8], [17, 11], ...arc(9, 14, 3, 270, 180, 8), ...ball, [0, 44]];
  await open(turned(set.folder, "knob.json", outline, 36), /faces$/);
  await run();
  await page.select("#colouring", "surface");
  await tab("surfaces");
  await page.click('.surface-list tr[data-kind="torus"] button');
});

picture("finding", {}, async (visitor) => {
  const { drop, page, run, tab, waitForText } = visitor;
  // A ramp that runs out to a sharp edge, in a box: corners below any bound.
  const vertices = [
    [0, 0, 0],
    [60, 0, 0],
    [60, 30, 0],
    [0, 30, 0],
    [60, 0, 12],
    [60, 30, 12],
  ];
  const faces = [
    [3, 2, 1, 0],
    [0, 1, 4],
    [3, 5, 2],
    [1, 2, 5, 4],
    [0, 4, 5, 3],
  ];
  await drop(set.folder.write("ramp.json", JSON.stringify({ vertices, faces })));
  await waitForText("#before-count", /^5 faces$/);
  await run();
  await tab("findings");
  await page.click('.targets [aria-label^="Places"] button');
});
