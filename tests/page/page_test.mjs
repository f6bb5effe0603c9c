// The page as a person uses it, in a real browser against the real daemon.
import assert from "node:assert/strict";
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import {
  bracket,
  chosenPart,
  difference,
  differsFrom,
  drawn,
  eventually,
  isDrawn,
  pageTests,
  partOf,
  pause,
  shownNumber,
  stage,
  startDaemon,
  stripedPart,
  violations,
} from "./support.mjs";

const set = stage();
const { folder } = set;
const onPage = pageTests(set);

/** A prism over a thin triangle: corners below any bound. */
function wedge() {
  const vertices = [
    [0, 0, 0],
    [10, 0, 0],
    [10, 1, 0],
    [0, 0, 2],
    [10, 0, 2],
    [10, 1, 2],
  ];
  const faces = [
    [2, 1, 0],
    [3, 4, 5],
    [0, 1, 4, 3],
    [1, 2, 5, 4],
    [2, 0, 3, 5],
  ];
  return folder.write("wedge.json", JSON.stringify({ vertices, faces }));
}

onPage(
  "a dropped file is remeshed with an option changed, and both are drawn",
  async ({ page, open, type, run, view, text }) => {
    await open(bracket, /^4,800 faces$/);
    const alone = await view("before", isDrawn());
    await type("#option-min_angle_deg", "30");
    await run();
    const report = JSON.parse(await set.daemon.remesh(bracket, { min_angle_deg: 30, format: "json" })).report;
    assert.equal(await text("#after-count"), `${report.output.faces.toLocaleString("en")} faces`);
    const isColoured = (picture) => {
      isDrawn()(picture);
      assert.ok(drawn(picture).colours > 200, `colours: ${drawn(picture).colours}`);
    };
    const before = await view("before", (picture) => {
      isColoured(picture);
      assert.ok(difference(alone, picture) > 0.05, "the input was not coloured by its patches");
    });
    await view("after", (picture) => {
      isColoured(picture);
      assert.ok(difference(before, picture) > 0.1, "the result has the input's triangles");
    });
    // Without them it is the same surface in the same patches, from the same side.
    await page.click("#lines");
    await eventually(async () => {
      const differs = difference(await view("before"), await view("after"));
      assert.ok(differs < 0.03, `before and after differ in ${differs}`);
    });
  },
);

onPage("the numbers are those of the report", async ({ open, run, tab, cell, text }) => {
  await open(bracket, /^4,800 faces$/);
  await run();
  const { report } = JSON.parse(await set.daemon.remesh(bracket, { format: "json" }));
  await tab("report");
  for (const [column, statistics] of [
    ["before", report.input],
    ["after", report.output],
  ]) {
    assert.equal(await cell("Faces", column), statistics.faces.toLocaleString("en"));
    assert.equal(await cell("Vertices", column), statistics.vertices.toLocaleString("en"));
    assert.equal(await cell("Area", column), shownNumber(statistics.area));
    assert.equal(await cell("Volume", column), shownNumber(statistics.volume));
    assert.equal(await cell("Euler number", column), String(statistics.euler));
    assert.equal(await cell("Closed", column), statistics.closed ? "yes" : "no");
    const { min, mean, max } = statistics.quality.radius_edge_ratio;
    assert.equal(await cell("Radius-edge ratio", column), [min, mean, max].map(shownNumber).join(" / "));
  }
  assert.equal(await cell("Smallest angle", "after"), `${report.output.quality.min_angle_deg.toFixed(1)}°`);
  assert.equal(await cell("Patches", "before"), String(report.patches.length));
  assert.equal(await cell("Verified: conforming", "before"), "holds");
  assert.doesNotMatch(await text("#report"), /NaN|undefined|null/);
  await tab("quality");
  const counts = report.output.quality.angle_histogram_deg.counts;
  assert.match(await text("#quality .histogram table"), new RegExp(`50 – 60[\\d,]*?${counts[5].toLocaleString("en")}`));
});

onPage("the histograms show what the report counts", async ({ page, open, run }) => {
  await open(bracket, /^4,800 faces$/);
  await run();
  const { report } = JSON.parse(await set.daemon.remesh(bracket, { format: "json" }));
  const heights = await page.$$eval("#quality .histogram:first-of-type .bar-after", (bars) =>
    bars.map((bar) => Number(bar.getAttribute("height"))),
  );
  const counts = report.output.quality.angle_histogram_deg.counts.filter((n) => n > 0);
  assert.equal(heights.length, counts.length);
  const scale = heights[0] / counts[0];
  counts.forEach((n, i) => assert.ok(Math.abs(heights[i] - n * scale) < 0.5 || heights[i] === 1, `bar ${i}`));
});

onPage("every format is downloaded, and reads back", async ({ page, open, run, tab, waitForText }) => {
  await open(bracket, /^4,800 faces$/);
  await run();
  await tab("download");
  for (const format of ["json", "obj", "stl", "ply", "off", "vtu", "msh", "mesh", "smesh", "glb"]) {
    await page.click(`#download [data-format="${format}"]`);
    await waitForText("#download section p", new RegExp(`Saved as bracket-remeshed\\.${format}`));
    const path = join(folder.path, `bracket-remeshed.${format}`);
    const got = await eventually(() => readFileSync(path));
    const expected = await set.daemon.remesh(bracket, { format });
    if (format === "json") assert.deepEqual(JSON.parse(got).mesh, JSON.parse(expected).mesh);
    else assert.ok(got.equals(expected), `${format} differs from what curl gets`);
  }
  const faces = JSON.parse(await set.daemon.remesh(bracket, { format: "json" })).mesh.faces.length.toLocaleString("en");
  for (const format of ["obj", "stl", "ply", "off", "json"]) {
    await open(join(folder.path, `bracket-remeshed.${format}`), new RegExp(`^${faces} faces$`));
  }
});

onPage("the curl line does the same", async ({ page, open, type, tab, text }) => {
  await open(bracket, /^4,800 faces$/);
  await type("#option-min_angle_deg", "28");
  await page.click("#option-refine");
  await tab("download");
  assert.equal(
    await text("#curl"),
    "curl --fail-with-body --data-binary @bracket.obj " +
      `'${set.daemon.origin}/v1/remesh?refine=false&min_angle_deg=28&format=obj' -o bracket-remeshed.obj`,
  );
});

onPage(
  "a broken file is told in words, with the place",
  async ({ open, drop, page, waitForText, text }) => {
    await open(bracket, /^4,800 faces$/);
    await drop(folder.write("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"));
    await waitForText("#unreadable", /A face refers to a point that does not exist/);
    await page.click("#run");
    await waitForText("#problem", /Index out of range.*9/i);
    assert.match(await text("#problem"), /line 4/);
    assert.equal(await page.$eval("#problem", (element) => element.getAttribute("role")), "alert");
    await open(bracket, /^4,800 faces$/);
    assert.equal(await page.$eval("#problem", (element) => element.hidden), true);
  },
  { mayComplain: true },
);

onPage(
  "an option out of its range is told before anything is sent",
  async ({ page, open, type, text, waitForText }) => {
    await open(bracket, /^4,800 faces$/);
    await type("#option-min_angle_deg", "50");
    await waitForText("#option-min_angle_deg-note", /^This takes a number, 0 to 33; or auto/);
    await page.click("#run");
    assert.equal(await text("#status"), "An option is out of its range.");
    await type("#option-min_angle_deg", "20");
    assert.equal(await page.$eval("#option-max_radius_edge_ratio", (input) => input.disabled), true);
    await page.click("#reset");
    assert.equal(await page.$eval("#option-min_angle_deg", (input) => input.value), "");
  },
);

onPage("a run that would be large says how many faces are expected, and asks", async (on) => {
  const { page, open, type, text, waitForText } = on;
  await open(bracket, /^4,800 faces$/);
  await type("#option-max_edge_length", "0.12");
  await page.click("#run");
  await page.waitForSelector("#large-dialog[open]");
  const options = { max_edge_length: "0.12" };
  const analysis = await fetch(`${set.daemon.origin}/v1/analyze?${new URLSearchParams(options)}`, {
    method: "POST",
    body: readFileSync(bracket),
  });
  const { predicted_faces } = (await analysis.json()).report;
  const told = Number((await text("#large-text")).replace(/^.*about ([\d,]+) faces.*$/, "$1").replaceAll(",", ""));
  assert.equal(told, predicted_faces);
  await page.click("#large-back");
  await page.waitForSelector("#large-dialog:not([open])");
  assert.equal(await page.$eval("#progress", (element) => element.hidden), true);
  assert.equal(await text("#after-count"), "");
  // One beyond the service's limit is not offered at all, but something smaller is.
  await type("#option-max_edge_length", "0.01");
  await page.click("#run");
  await page.waitForSelector("#large-dialog[open]");
  assert.match(await text("#large-text"), /[\d,]+ faces are expected\. This service makes at most 50,000,000\./);
  assert.equal(await page.$eval("#large-run", (button) => button.hidden), true);
  await page.click('#large-advice [data-options="target_faces=100000"]');
  await page.waitForSelector("#large-dialog:not([open])");
  // The options are set when the browser has told the page that the dialog is closed.
  await page.waitForFunction(() => document.querySelector("#option-target_faces").value === "100000");
  assert.equal(await page.$eval("#option-max_edge_length", (input) => input.value), "");
  assert.equal(await page.evaluate(() => document.activeElement.id), "run");
  await type("#option-target_faces", "");
  // A run that is not large is not asked about.
  await type("#option-max_edge_length", "50");
  await page.click("#run");
  await waitForText("#status", /^Remeshed in/);
});

onPage(
  "a long run shows its stages and is cancelled",
  async ({ page, open, type, text, waitForText }) => {
    await open(bracket, /^4,800 faces$/);
    await type("#option-max_edge_length", "0.12");
    await page.click("#run");
    await page.waitForSelector("#large-dialog[open]");
    await page.click("#large-run");
    await waitForText("#stages .current", /^Refinement$/);
    const passed = await page.$$eval("#stages .done", (stages) => stages.map((stage) => stage.textContent));
    assert.deepEqual(passed.slice(0, 4), ["Send", "Queued", "Read", "Weld"]);
    assert.match(await text("#progress-time"), /s(, about .* left)?$/);
    await page.click("#cancel");
    await waitForText("#status", /^Cancelled$/);
    assert.equal(await page.$eval("#progress", (element) => element.hidden), true);
    await eventually(async () => {
      const metrics = await (await fetch(`${set.daemon.origin}/metrics`)).text();
      assert.match(metrics, /code="499"/);
    });
    // And the page goes on.
    await type("#option-max_edge_length", "");
    await page.click("#run");
    await waitForText("#status", /^Remeshed in/);
  },
  { mayComplain: true },
);

onPage("a click tells a triangle's numbers, and where it comes from", async ({ page, open, run, view, text }) => {
  await open(bracket, /^4,800 faces$/);
  await run();
  const answer = JSON.parse(await set.daemon.remesh(bracket, { format: "json" }));
  const plain = await view("after", isDrawn());
  const box = await (await page.$("#after")).boundingBox();
  await page.mouse.click(box.x + box.width * 0.5, box.y + box.height * 0.65);
  await page.waitForSelector("#after-numbers:not([hidden])");
  const face = Number((await text("#after-numbers h3")).replace(/\D/g, ""));
  const corners = answer.mesh.faces[face];
  const rows = await page.$$eval("#after-numbers tbody tr", (all) =>
    all.map((row) => [...row.children].map((cell) => cell.textContent)),
  );
  rows.forEach((row, i) => {
    assert.equal(row[0], corners[i].toLocaleString("en"));
    assert.deepEqual(row.slice(1, 4), answer.mesh.vertices[corners[i]].map(shownNumber));
  });
  const [a, b, c] = corners.map((v) => answer.mesh.vertices[v]);
  const minus = (p, q) => p.map((x, i) => x - q[i]);
  const angle = (p, q, r) => {
    const [u, v] = [minus(q, p), minus(r, p)];
    return (
      (Math.acos(u.reduce((sum, x, i) => sum + x * v[i], 0) / Math.hypot(...u) / Math.hypot(...v)) * 180) / Math.PI
    );
  };
  assert.deepEqual(
    rows.map((row) => row[4]),
    [angle(a, b, c), angle(b, c, a), angle(c, a, b)].map((x) => `${x.toFixed(1)}°`),
  );
  assert.match(await text("#after-numbers dl"), new RegExp(`Patch${answer.mesh.face_patch[face]}`));
  await view("after", (picture) => assert.ok(chosenPart(picture) > chosenPart(plain), "it is not shown"));
  // To the face of the input that it lies on.
  await page.click("#after-numbers .link");
  assert.equal(Number((await text("#before-numbers h3")).replace(/\D/g, "")), answer.mesh.face_source[face]);
  await page.click("#before-numbers .close");
  assert.equal(await page.$eval("#before-numbers", (element) => element.hidden), true);
});

onPage(
  "keys turn, zoom and pick; the cameras go together until they are unlinked",
  async ({ page, open, run, view }) => {
    await open(bracket, /^4,800 faces$/);
    await run();
    const first = await view("after", isDrawn());
    await page.focus("#before");
    const unturned = await view("before", isDrawn());
    for (let i = 0; i < 4; ++i) await page.keyboard.press("ArrowRight");
    const turned = await view("before", differsFrom(unturned, 0.05));
    const follower = await view("after", differsFrom(first, 0.05));
    await page.keyboard.press("+");
    for (let i = 0; i < 9; ++i) await page.keyboard.press("ArrowUp");
    await page.keyboard.press("Enter");
    assert.equal(await page.$eval("#before-numbers", (element) => element.hidden), false);
    await page.keyboard.press("Escape");
    assert.equal(await page.$eval("#before-numbers", (element) => element.hidden), true);
    await page.click("#linked");
    const before = await view("before", differsFrom(turned, 0.05));
    const after = await view("after", differsFrom(follower, 0.05));
    await page.focus("#before");
    await page.keyboard.press("ArrowDown");
    // One canvas is behind both: where the one shows a new frame, the other does.
    await view("before", differsFrom(before, 0.05));
    assert.equal(difference(after, await view("after")), 0);
  },
);

onPage("dragging turns, the wheel zooms", async ({ page, open, view }) => {
  await open(bracket, /^4,800 faces$/);
  const first = await view("before", isDrawn());
  const box = await (await page.$("#before")).boundingBox();
  await page.mouse.move(box.x + 200, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 320, box.y + 230, { steps: 5 });
  await page.mouse.up();
  const turned = await view("before", differsFrom(first, 0.05));
  await page.mouse.wheel({ deltaY: -600 });
  await view("before", isDrawn(drawn(turned).part * 1.2));
});

onPage("colours, edges and the section change what is drawn", async ({ page, open, run, view }) => {
  await open(bracket, /^4,800 faces$/);
  await run();
  const byPatch = await view("after", isDrawn());
  await page.select("#colouring", "angle");
  const angles = await view("after", differsFrom(byPatch, 0.05));
  // Needles are red; the result has none, since no angle is below 25 degrees.
  const redPart = (picture) => partOf(picture, [138, 38, 36], 40);
  await view("before", (picture) => assert.ok(redPart(picture) > 4 * redPart(angles), `red: ${redPart(picture)}`));
  assert.match(await page.$eval("#legend", (element) => element.textContent), /0°.*60°/);
  await page.select("#colouring", "ratio");
  const ratios = await view("after", differsFrom(angles, 0.03));
  await page.select("#colouring", "plain");
  const plain = await view("after", differsFrom(ratios, 0.03));
  await page.click("#lines");
  const smooth = await view("after", (picture) => assert.ok(drawn(picture).colours < drawn(plain).colours / 2));
  await page.select("#section-axis", "1");
  const cut = await view("after", differsFrom(smooth, 0.05));
  await page.click("#section-flip");
  await view("after", differsFrom(cut, 0.05));
  await page.select("#section-axis", "");
  await view("after", (picture) => assert.equal(difference(smooth, picture), 0));
});

onPage("findings are listed, marked, and flown to", async ({ page, open, run, tab, view, text }) => {
  await open(wedge(), /^5 faces$/);
  await run();
  const { report } = JSON.parse(await set.daemon.remesh(join(folder.path, "wedge.json"), { format: "json" }));
  assert.ok(report.unrefined.length > 0, "the wedge has no corner below the bound");
  await tab("findings");
  const listed = await page.$$eval(".groups .group-count", (all) => all.map((count) => Number(count.textContent)));
  // First all of them, which the page finds by itself; then by reasons, as the report has them.
  const counts = report.unrefined.map((part) => part.count);
  assert.deepEqual(listed, [counts.reduce((sum, count) => sum + count, 0), ...counts]);
  await (await page.$$(".groups button"))[1].click();
  const far = await view("after", (picture) =>
    assert.ok(partOf(picture, [216, 27, 96], 30) > 0.00005, "nothing is marked"),
  );
  await page.click('.targets [aria-label^="Places"] button');
  await view("after", differsFrom(far, 0.05));
  // The triangle there is below the bound, and lies where the report says.
  assert.ok(Number.parseFloat(await page.$eval("#after-numbers dl dd", (element) => element.textContent)) < 25);
  assert.match(await text(".targets p"), /sharper than the bound/);
});

onPage("a flight ends where a jump does", async ({ page, open, run, tab, view }) => {
  await open(wedge(), /^5 faces$/);
  await run();
  await tab("findings");
  const start = await view("after", isDrawn(0.02));
  await page.click('.targets [aria-label^="Places"] button');
  const jumped = await view("after", differsFrom(start, 0.02));
  await page.emulateMediaFeatures([{ name: "prefers-reduced-motion", value: "no-preference" }]);
  await page.click("#fit");
  await pause(900);
  await view("after", differsFrom(jumped, 0.02));
  await page.click('.targets [aria-label^="Places"] button');
  await pause(900);
  await view("after", (picture) => {
    const differs = difference(jumped, picture);
    assert.ok(differs < 0.001, `jump and flight differ in ${differs}`);
  });
});

onPage("patches that could not be remeshed are striped in both views, and flown to", async (visitor) => {
  const { page, open, run, tab, view, text } = visitor;
  // A flat strip that runs 450 degrees round, over itself.
  const steps = 15;
  const vertices = [];
  const faces = [];
  for (let i = 0; i <= steps; ++i) {
    const angle = (i * Math.PI) / 6;
    for (const radius of [1, 2]) vertices.push([radius * Math.cos(angle), radius * Math.sin(angle), 0]);
    if (i > 0) faces.push([2 * i - 2, 2 * i - 1, 2 * i + 1, 2 * i]);
  }
  const file = folder.write("strip.json", JSON.stringify({ vertices, faces }));
  await open(file, /^15 faces$/);
  await run();
  const { report } = JSON.parse(await set.daemon.remesh(file, { format: "json" }));
  const spared = report.patches.filter(({ status }) => status !== "remeshed");
  assert.ok(spared.length > 0, "all patches were remeshed");
  await tab("findings");
  assert.match(await text(".groups"), new RegExp(`Patches ${spared[0].status}`));
  await page.select("#colouring", "plain");
  const isStriped = (picture) => assert.ok(stripedPart(picture) > 0.002, "there are no stripes");
  await view("before", isStriped);
  const far = await view("after", isStriped);
  const button = await page.waitForSelector(`::-p-xpath(//*[@class="groups"]//button[contains(., "Patches")])`);
  await button.click();
  await page.click('.targets [aria-label^="Places"] button');
  await view("after", differsFrom(far, 0.02));
  assert.match(await text("#after-numbers dl"), new RegExp(`Patch${spared[0].id}, ${spared[0].status}`));
});

onPage(
  "the browser refuses what the page may not do",
  async ({ page }) => {
    const refused = await page.evaluate(async () => {
      const found = [];
      document.addEventListener("securitypolicyviolation", (event) => found.push(event.effectiveDirective));
      const script = document.createElement("script");
      script.textContent = "globalThis.wasRun = true";
      document.head.append(script);
      document.body.setAttribute("style", "color: red");
      await fetch("http://127.0.0.1:9/").catch(() => {});
      // They are told one by one, later; what nobody forbids is never told, and then the test fails.
      const pause = () => new Promise((resolve) => setTimeout(resolve, 100));
      for (let i = 0; i < 600 && found.length < 3; ++i) await pause();
      await pause();
      return [globalThis.wasRun === true, ...found.sort()];
    });
    assert.deepEqual(refused, [false, "connect-src", "script-src-elem", "style-src-attr"]);
  },
  { mayComplain: true },
);

onPage("diagnostics lead to the faces of the input", async ({ page, drop, waitForText, tab, view, text }) => {
  // A cube without its lid: open edges.
  const open = [
    "v 0 0 0",
    "v 1 0 0",
    "v 1 1 0",
    "v 0 1 0",
    "v 0 0 1",
    "v 1 0 1",
    "v 1 1 1",
    "v 0 1 1",
    "f 4 3 2 1",
    "f 1 2 6 5",
    "f 2 3 7 6",
    "f 3 4 8 7",
    "f 4 1 5 8",
  ].join("\n");
  await drop(folder.write("open.obj", open));
  await waitForText("#before-count", /^5 faces$/);
  await page.click("#analyze");
  await waitForText("#status", /^Analyzed in/);
  await tab("findings");
  assert.match(await text(".groups"), /Open boundary/);
  const groups = await page.$$(".groups button");
  await groups.at(-1).click();
  await view("before", (picture) => assert.ok(partOf(picture, [216, 27, 96], 30) > 0.002, "the edges are not marked"));
  await page.click('.targets [aria-label^="Places"] button');
  assert.equal(await text("#before-numbers h3"), "Face 1");
});

onPage(
  "where a key is needed, it is asked for and kept in memory only",
  async ({ page, waitForText, open, run, tab, text }) => {
    await page.waitForSelector("#key-dialog[open]");
    await page.type("#key", "not-the-key-at-all");
    await page.keyboard.press("Enter");
    await waitForText("#key-wrong", /does not know this key/);
    await page.type("#key", "a-key-of-the-page-test");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#option-refine");
    await open(bracket, /^4,800 faces$/);
    await run();
    await tab("download");
    assert.match(await text("#curl"), /Bearer \$REMESHD_API_KEY/);
    const kept = await page.evaluate(
      () =>
        JSON.stringify([{ ...localStorage }, { ...sessionStorage }, document.cookie]) +
        document.documentElement.outerHTML,
    );
    assert.ok(!kept.includes("a-key-of-the-page-test"));
  },
  async () => {
    keyed ??= await startDaemon("--api-key-file", folder.write("keys", "a-key-of-the-page-test\n"));
    return { origin: keyed.origin, mayComplain: true };
  },
);
let keyed;
after(() => keyed?.stop());

let withJobs;
after(() => withJobs?.stop());

onPage(
  "jobs are kept in the browser, followed, saved, forgotten and deleted",
  async ({ page, open, text, waitForText }) => {
    const send = async (count) => {
      await page.click("#send-job");
      await waitForText("#tab-jobs", new RegExp(`^Jobs ${count}$`));
      assert.match(await text("#status"), /^bracket\.obj is job [0-9a-f]{32}$/);
      return (await text("#status")).slice(-32);
    };
    const statusOfResult = async (id) => (await fetch(`${withJobs.origin}/v1/jobs/${id}/result`)).status;
    const press = (id, name) => page.click(`[data-job="${id}"] button[aria-label^="${name}"]`);
    const listed = () => page.$$eval("[data-job]", (rows) => rows.map((row) => row.dataset.job));
    await open(bracket, /^4,800 faces$/);
    const first = await send(1);
    const second = await send(2);
    await waitForText(`[data-job="${first}"]`, /Succeeded/);
    await waitForText(`[data-job="${second}"]`, /Succeeded/);
    assert.deepEqual(await violations(page), []);
    // They are there after a reload, and lead to what the service says of them.
    await page.reload();
    await page.waitForSelector("#option-refine");
    assert.equal(await text("#tab-jobs"), "Jobs 2");
    await page.click("#tab-jobs");
    assert.deepEqual(await listed(), [second, first]);
    const link = await page.$eval(`[data-job="${first}"] a`, ({ href }) => href);
    assert.equal(JSON.parse(await (await fetch(link)).text()).id, first);
    await waitForText(`[data-job="${first}"]`, /Succeeded/);
    rmSync(join(folder.path, "bracket-remeshed.obj"), { force: true });
    await press(first, "Save");
    await waitForText("#jobs", /Saved as bracket-remeshed\.obj/);
    const expected = Buffer.from(await (await fetch(`${link}/result`)).arrayBuffer());
    await eventually(() => assert.ok(readFileSync(join(folder.path, "bracket-remeshed.obj")).equals(expected)));
    await press(first, "Forget");
    assert.deepEqual(await listed(), [second]);
    assert.equal(await statusOfResult(first), 200);
    await press(second, "Delete");
    await waitForText("#jobs", /is then listed here/);
    assert.equal(await statusOfResult(second), 410);
    assert.equal(await page.evaluate(() => localStorage.length), 0);
    // Without a key there is no list but this one, and the service says why.
    assert.match(await (await fetch(`${withJobs.origin}/v1/jobs`)).text(), /no API keys.*the only secret/);
  },
  async () => {
    withJobs = await startDaemon("--state-dir", join(folder.path, "jobs"));
    return { origin: withJobs.origin };
  },
);

test("the page is small, comes from one place, and may load nothing else", async () => {
  const index = await fetch(set.daemon.origin);
  const policy = index.headers.get("content-security-policy");
  for (const part of [
    "default-src 'none'",
    "script-src 'self'",
    "worker-src 'self'",
    "style-src 'self'",
    "connect-src 'self'",
    "frame-ancestors 'none'",
  ]) {
    assert.ok(policy.includes(part), part);
  }
  assert.doesNotMatch(policy, /unsafe|\*|https?:/);
  const html = await index.text();
  assert.doesNotMatch(html, /<script(?![^>]*src=)|<style|\son\w+=|\sstyle=/);
  const files = new Set([...html.matchAll(/"(assets\/[^"]+)"/g)].map((match) => match[1]));
  for (const path of files) {
    const body = await (await fetch(`${set.daemon.origin}/${path}`)).text();
    for (const match of body.matchAll(/"(assets\/[\w.-]+)"/g)) files.add(match[1]);
  }
  assert.equal(files.size, 4);
  let total = 0;
  for (const path of ["", ...files]) {
    const response = await fetch(`${set.daemon.origin}/${path}`, {
      method: "HEAD",
      headers: { "Accept-Encoding": "gzip" },
    });
    assert.equal(response.status, 200);
    assert.equal(response.headers.get("content-encoding"), "gzip");
    total += Number(response.headers.get("content-length"));
  }
  assert.ok(total < 300_000, `${total} bytes`);
});

onPage("a face that had a corner twice in a row is found as a face", async ({ page, drop, waitForText, tab, text }) => {
  const mesh = ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0", "f 1 2 3", "f 1 3 3 4"].join("\n");
  await drop(folder.write("repeated.obj", mesh));
  await waitForText("#before-count", /^2 faces$/);
  await page.click("#analyze");
  await waitForText("#status", /^Analyzed in/);
  await tab("findings");
  const groups = await page.$$(".groups button");
  await groups.at(-1).click();
  assert.match(await text(".targets"), /had a corner twice in a row/);
  await page.click('.targets [aria-label^="Places"] button');
  assert.equal(await text("#before-numbers h3"), "Face 1");
});
