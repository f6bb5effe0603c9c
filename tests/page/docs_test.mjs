// The API reference in a browser: all of the contract is there, and its examples are sent to the real daemon.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after } from "node:test";
import { pageTests, stage, startDaemon, violations } from "./support.mjs";

const set = stage();
const onPage = pageTests(set);
let daemon;
after(() => daemon?.stop());

const onReference = (name, combination, run) =>
  onPage(name, run, async () => {
    daemon ??= await startDaemon("--state-dir", join(set.folder.path, "state"));
    return { ...combination, origin: daemon.origin, path: "/docs", ready: "#operation-remesh" };
  });

/** Sends the form of an operation by the keyboard. Output: the last text of the answer. */
async function sent({ page, waitForText, text }, id, status) {
  const answer = `#operation-${id} .answer`;
  await page.focus(`#operation-${id} .trial [type="submit"]`);
  await page.keyboard.press("Enter");
  await waitForText(answer, status);
  await page.waitForSelector(`#operation-${id} .trial [type="submit"]:enabled`);
  return text(`${answer} > :is(pre:last-of-type, .notice)`);
}

onReference(
  "the reference shows every operation and schema, and sends the examples",
  { width: 1440, height: 900, scheme: "light" },
  async (visitor) => {
    const { page, text } = visitor;
    const contract = await (await fetch(`${daemon.origin}/openapi.json`)).json();
    const operations = Object.entries(contract.paths).flatMap(([path, item]) =>
      Object.entries(item).flatMap(([method, { operationId }]) =>
        operationId ? [[`operation-${operationId}`, `${method.toUpperCase()}${path}`]] : [],
      ),
    );
    assert.ok(operations.length > 10, `${operations.length} operations`);
    const schemas = Object.keys(contract.components.schemas).map((name) => [`schema-${name}`, name]);
    const shown = await page.$$eval(".operation, .schema", (all) =>
      all.map((section) => [section.id, section.querySelector("h3").textContent]),
    );
    assert.deepEqual(shown.sort(), [...operations, ...schemas].sort());
    // No link of the page leads nowhere.
    const lost = await page.$$eval('a[href^="#"]', (links) =>
      links.map((link) => link.getAttribute("href").slice(1)).filter((id) => !document.getElementById(id)),
    );
    assert.deepEqual(lost, []);
    const rows = await page.$$eval("#operation-remesh .parameter", (all) => all.length);
    assert.equal(rows, contract.paths["/v1/remesh"].post.parameters.length);

    // A square of side 2.
    const answer = JSON.parse(await sent(visitor, "remesh", /^200/));
    assert.equal(answer.report.output.area, 4);
    await page.click("#operation-remesh details summary");
    await page.select("#remesh-format", "obj");
    assert.match(await text("#operation-remesh .line"), /remesh\?format=obj/);
    assert.match(await sent(visitor, "remesh", /^200/), /^# remeshd/);
    assert.equal(JSON.parse(await sent(visitor, "compare", /^200/)).a_to_b.distance, 0);
    // A job's id goes into the forms that ask for one.
    const { id } = JSON.parse(await sent(visitor, "submitJob", /^202/));
    assert.equal(JSON.parse(await sent(visitor, "getJob", /^200/)).id, id);
    assert.match(await sent(visitor, "watchJob", /^200[^]*event: end/), /event: end/);
    assert.equal(JSON.parse(await sent(visitor, "getJobReport", /^200/)).input.area, 4);
    assert.equal(await sent(visitor, "getRequest", /needed/), "id is needed.");
  },
);

onReference(
  "the reference fits a phone, and axe finds nothing",
  { width: 390, height: 844, scheme: "dark" },
  async (visitor) => {
    await sent(visitor, "isLive", /^200/);
    assert.ok(await visitor.page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "it is too wide");
    assert.deepEqual(await violations(visitor.page), []);
  },
);
