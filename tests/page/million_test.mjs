// Two hundred thousand and a million triangles in the page, drawn in software: slow there, but nothing may fail.
import assert from "node:assert/strict";
import { test } from "node:test";
import { differsFrom, isDrawn, openPage, pause, stage } from "./support.mjs";

const kPatience = 240_000;

const set = stage();

/** A box whose six sides are a grid of triangles each, 12 kSide^2 together, as binary STL. */
function box(kSide) {
  const count = 12 * kSide * kSide;
  const bytes = Buffer.alloc(84 + 50 * count);
  bytes.writeUInt32LE(count, 80);
  let at = 84;
  const corner = (side, i, j) => {
    const axis = side >> 1;
    const point = [0, 0, 0];
    point[axis] = (side & 1) * kSide;
    point[(axis + 1) % 3] = side & 1 ? i : j;
    point[(axis + 2) % 3] = side & 1 ? j : i;
    return point;
  };
  for (let side = 0; side < 6; ++side) {
    for (let i = 0; i < kSide; ++i) {
      for (let j = 0; j < kSide; ++j) {
        for (const triangle of [
          [
            [i, j],
            [i + 1, j],
            [i + 1, j + 1],
          ],
          [
            [i, j],
            [i + 1, j + 1],
            [i, j + 1],
          ],
        ]) {
          triangle.flatMap(([u, v]) => corner(side, u, v)).forEach((x, k) => bytes.writeFloatLE(x, at + 12 + 4 * k));
          at += 50;
        }
      }
    }
  }
  return bytes;
}

/** Frames a second while a view is dragged; each is drawn with both meshes. */
async function framesWhileTurning(page, steps) {
  const { x, y } = await (await page.$("#before")).boundingBox();
  await page.mouse.move(x + 150, y + 150);
  await page.mouse.down();
  const start = performance.now();
  for (let i = 0; i < steps; ++i) {
    await page.mouse.move(x + 150 + 12 * i, y + 150);
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  }
  await page.mouse.up();
  return (1000 * steps) / (performance.now() - start);
}

test("200,000 triangles turn", async () => {
  const { page, faults, drop, waitForText, view, close } = await openPage(set.browser, set.daemon.origin);
  try {
    await drop(set.folder.write("many.stl", box(129)));
    await waitForText("#before-count", /^199,692 faces$/, kPatience);
    const unturned = await view("before", isDrawn());
    console.log(`frames a second with 199,692 faces: ${(await framesWhileTurning(page, 20)).toFixed(1)}`);
    await view("before", differsFrom(unturned, 0.05));
    assert.deepEqual(faults, []);
  } finally {
    await close();
  }
});

test("a million triangles load, are remeshed into a million, turn, and are picked", async () => {
  const { page, faults, drop, waitForText, type, view, close } = await openPage(set.browser, set.daemon.origin);
  const since = (start) => `${((performance.now() - start) / 1000).toFixed(1)} s`;
  try {
    // How long the page itself stands still at most, and how long its frames take.
    await page.evaluate(() => {
      globalThis.longest = 0;
      new PerformanceObserver((list) => {
        for (const entry of list.getEntries()) globalThis.longest = Math.max(globalThis.longest, entry.duration);
      }).observe({ entryTypes: ["longtask"] });
    });
    let start = performance.now();
    await drop(set.folder.write("million.stl", box(288)));
    await waitForText("#before-count", /^995,328 faces$/, kPatience);
    console.log(`read and ready: ${since(start)}`);
    await view("before", isDrawn());
    console.log(`longest task of the page: ${(await page.evaluate(() => globalThis.longest)).toFixed(0)} ms`);

    // Equal pieces of a side: about as many again.
    await type("#option-max_edge_length", "1.1");
    start = performance.now();
    await page.click("#run");
    await page.waitForSelector("#large-dialog[open]", { timeout: kPatience });
    await page.click("#large-run");
    await waitForText("#status", /^Remeshed in/, kPatience);
    console.log(
      `${await page.$eval("#status", (element) => element.textContent)}; on the screen after ${since(start)}`,
    );
    assert.ok(
      Number((await page.$eval("#after-count", (element) => element.textContent)).replace(/\D/g, "")) > 700_000,
    );
    const unturned = await view("after", isDrawn());

    const box2 = await (await page.$("#after")).boundingBox();
    await page.mouse.move(box2.x + 150, box2.y + 150);
    await page.mouse.down();
    start = performance.now();
    const kSteps = 10;
    for (let i = 0; i < kSteps; ++i) {
      await page.mouse.move(box2.x + 150 + 12 * i, box2.y + 150);
      await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    }
    console.log(`a frame of both views while turning: ${((performance.now() - start) / kSteps).toFixed(0)} ms`);
    await page.mouse.up();
    await pause(3000);
    await view("after", differsFrom(unturned, 0.05));
    await page.mouse.click(box2.x + box2.width / 2, box2.y + box2.height / 2);
    await page.waitForSelector("#after-numbers:not([hidden])", { timeout: kPatience });
    await page.select("#colouring", "angle");
    await page.select("#section-axis", "0");
    await view("after", isDrawn(0.05));
    assert.deepEqual(faults, []);
  } finally {
    await close();
  }
});
