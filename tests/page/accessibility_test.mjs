// What axe finds in every state of the page, in both colour schemes.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { bracket, openPage, stage, startDaemon, violations } from "./support.mjs";

const set = stage();
let keyed;
before(async () => {
  keyed = await startDaemon("--api-key-file", set.folder.write("axe-keys", "a-key-of-the-axe-test\n"));
});
after(() => keyed?.stop());

for (const scheme of ["light", "dark"]) {
  test(`axe finds nothing, ${scheme}`, async () => {
    const { page, open, run, tab, drop, waitForText, type, unfold, close } = await openPage(set.browser, keyed.origin, {
      scheme,
    });
    const check = async (state) => assert.deepEqual(await violations(page), [], `${state}, ${scheme}`);
    try {
      await page.waitForSelector("#key-dialog[open]");
      await check("the key is asked for");
      await page.type("#key", "a-key-of-the-axe-test");
      await page.keyboard.press("Enter");
      await page.waitForSelector("#option-refine");
      await check("nothing is there yet");
      await unfold(".more");
      await type("#option-min_angle_deg", "80");
      await check("an option is wrong");
      await type("#option-min_angle_deg", "30");
      await open(bracket, /^4,800 faces$/);
      await run();
      await page.select("#section-axis", "1");
      await page.select("#colouring", "angle");
      const box = await (await page.$("#after")).boundingBox();
      await page.mouse.click(box.x + box.width * 0.5, box.y + box.height * 0.65);
      for (const name of ["quality", "report", "findings", "download"]) {
        await tab(name);
        await check(`results: ${name}`);
      }
      await tab("surfaces");
      await check("results: surfaces");
      await page.select("#colouring", "surface");
      await page.click('.surface-list tr[data-kind="cylinder"] button');
      await check("surfaces are chosen in the table");
      await page.mouse.click(box.x + box.width * 0.5, box.y + box.height * 0.65);
      await page.waitForSelector("#after-numbers .surface-facts");
      await check("a surface is chosen in a view");
      await drop(set.folder.write("broken.obj", "v 0 0 0\nf 1 2 3\n"));
      await waitForText("#unreadable", /./);
      await page.click("#run");
      await waitForText("#problem", /./);
      await check("an error is shown");
    } finally {
      await close();
    }
  });
}

test("everything is reached by the Tab key, in the order in which it is read", async () => {
  const { page, close } = await openPage(set.browser, keyed.origin, {});
  try {
    await page.waitForSelector("#key-dialog[open]");
    await page.type("#key", "a-key-of-the-axe-test");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#option-refine");
    const reached = [];
    await page.evaluate(() => document.activeElement.blur());
    for (let i = 0; i < 40; ++i) {
      await page.keyboard.press("Tab");
      reached.push(await page.evaluate(() => document.activeElement.id || document.activeElement.textContent.trim()));
    }
    const expected = [
      "file",
      "Bracket",
      "option-refine",
      "option-min_angle_deg",
      "More options",
      "colouring",
      "fit",
      "before",
      "after",
      "tab-quality",
    ];
    assert.deepEqual(reached.filter((id) => expected.includes(id)).slice(0, expected.length), expected);
  } finally {
    await close();
  }
});
