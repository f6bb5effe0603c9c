// What people asked the page for, point by point: on a wide screen and on a phone, light and dark, by mouse and by keys.
// Each point is tested in one of two combinations, in turn, which together have each of these once. With
// REMESHD_PAGE_ALL, as `./dev page-points` sets it, each point is tested in all eight.
import assert from "node:assert/strict";
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { PNG } from "pngjs";
import {
  bracket,
  chosenPart,
  differsFrom,
  difference,
  eventually,
  isDrawn,
  openPage,
  pageTests,
  partOf,
  stage,
  violations,
} from "./support.mjs";

const set = stage();
const { folder } = set;
const onPage = pageTests(set);

const kScreens = [
  { width: 1440, height: 900 },
  { width: 390, height: 844 },
];
const kCombinations = process.env.REMESHD_PAGE_ALL
  ? kScreens.flatMap((screen) =>
      ["light", "dark"].flatMap((scheme) => ["mouse", "keys"].map((by) => ({ ...screen, scheme, by }))),
    )
  : [
      { ...kScreens[0], scheme: "light", by: "mouse" },
      { ...kScreens[1], scheme: "dark", by: "keys" },
    ];
const kMark = { light: [216, 27, 96], dark: [255, 79, 139] };

/** How a person uses controls. */
function hands({ page }, by) {
  const isMouse = by === "mouse";
  return {
    async press(selector) {
      if (isMouse) return page.click(selector);
      await page.focus(selector);
      await page.keyboard.press("Space");
    },
    async choose(selector, value) {
      if (isMouse) return page.select(selector, value);
      await page.focus(selector);
      await page.keyboard.press("Home");
      const count = await page.$eval(selector, (select) => select.options.length);
      const chosen = () => page.$eval(selector, (select) => select.value);
      for (let i = 0; i < count && (await chosen()) !== value; ++i) await page.keyboard.press("ArrowDown");
      assert.equal(await chosen(), value);
    },
    /** Moves a slider to about this part of its length. */
    async slide(selector, part) {
      if (!isMouse) {
        await page.focus(selector);
        await page.keyboard.press("Home");
        const steps = await page.$eval(selector, (slider) => Number(slider.max));
        for (let i = 0; i < Math.round(part * steps); ++i) await page.keyboard.press("ArrowRight");
        return;
      }
      const slider = await page.$(selector);
      await slider.scrollIntoView();
      const { x, y, width, height } = await slider.boundingBox();
      await page.mouse.click(x + part * width, y + height / 2);
    },
  };
}

let points = 0;

/** A test with a page of its own: for the combination whose turn it is, or for all of them. */
function onAll(name, run) {
  const combinations = process.env.REMESHD_PAGE_ALL ? kCombinations : [kCombinations[points++ % kCombinations.length]];
  for (const { by, ...options } of combinations) {
    onPage(
      `${name} (${options.width}, ${options.scheme}, ${by})`,
      (visitor) => run({ ...visitor, ...options, ...hands(visitor, by), by }),
      options,
    );
  }
}

async function analyzed(file, options) {
  const response = await fetch(`${set.daemon.origin}/v1/analyze?${new URLSearchParams(options)}`, {
    method: "POST",
    body: readFileSync(file),
  });
  return (await response.json()).report;
}

/** Faces of a prism over a polygon, from 1, of which the vertices are given twice: below and above. */
function prism(outline, height, first) {
  const n = outline.length;
  const at = (i) => first + (i % n);
  const below = outline.map(([x, y]) => `v ${x} ${y} 0`);
  const above = outline.map(([x, y]) => `v ${x} ${y} ${height}`);
  const side = Array.from({ length: n }, (_, i) => `f ${at(i)} ${at(i + 1)} ${n + at(i + 1)} ${n + at(i)}`);
  const floor = `f ${Array.from({ length: n }, (_, i) => at(n - 1 - i)).join(" ")}`;
  const lid = `f ${Array.from({ length: n }, (_, i) => n + at(i)).join(" ")}`;
  return { vertices: [...below, ...above], faces: [...side, floor, lid] };
}

const kRadius = 5;
const kSteps = 48;

/**
 * A shaft with 48 sides, an open box, a wedge with a sharp corner, and two squares that cross: everything that is to be
 * found, with groups and materials.
 */
function everything() {
  const circle = Array.from({ length: kSteps }, (_, i) => {
    const angle = (2 * Math.PI * i) / kSteps;
    return [kRadius * Math.cos(angle), kRadius * Math.sin(angle)];
  });
  const square = (x) => [
    [x, 0],
    [x + 4, 0],
    [x + 4, 4],
    [x, 4],
  ];
  const shaft = prism(circle, 10, 1);
  const box = prism(square(10), 4, 1 + shaft.vertices.length);
  const wedge = prism(
    [
      [20, 0],
      [30, 0],
      [30, 1],
    ],
    2,
    1 + shaft.vertices.length + box.vertices.length,
  );
  const first = 1 + shaft.vertices.length + box.vertices.length + wedge.vertices.length;
  const cross = [
    [-14, 10, 0],
    [-10, 10, 0],
    [-10, 10, 4],
    [-14, 10, 4],
    [-12, 8, 1],
    [-12, 12, 1],
    [-12, 12, 5],
    [-12, 8, 5],
  ];
  const square2 = (from) => `f ${[0, 1, 2, 3].map((i) => first + from + i).join(" ")}`;
  return folder.write(
    "everything.obj",
    [
      ...[shaft, box, wedge].flatMap(({ vertices }) => vertices),
      ...cross.map((p) => `v ${p.join(" ")}`),
      "g turned",
      "usemtl steel",
      ...shaft.faces,
      "g boxes",
      "usemtl brass",
      ...box.faces.slice(0, -1),
      ...wedge.faces,
      square2(0),
      square2(4),
    ].join("\n"),
  );
}
/** 48 sides and two ends, a box without its lid, a wedge, two squares. */
const kFaces = new RegExp(`^${kSteps + 2 + 5 + 5 + 2} faces$`);
/** The rim of the box, and two squares. */
const kOpenEdges = 4 + 8;

onAll("options come with what is in force, and with the number of faces to expect", async (on) => {
  const { page, open, text, waitForText, choose, slide } = on;
  const file = everything();
  await open(file, kFaces);
  const order = await page.$$eval("#options .option [id^=option-]:is(input, select)", (all) => all.map(({ id }) => id));
  assert.deepEqual(order.slice(0, 2), ["option-preset", "option-elements_per_circle"]);
  await choose("#option-preset", "volume");
  // What the documents say of this preset.
  await waitForText("#option-elements_per_circle-note", /^In force: 16, from the preset volume\./);
  assert.equal(await page.$eval("#option-elements_per_circle", (input) => input.placeholder), "16");
  assert.equal(await page.$eval("#option-proximity", (input) => input.placeholder), "0.25");
  const expected = async (options) => {
    const { predicted_faces: faces } = await analyzed(file, options);
    await waitForText(
      "#forecast",
      new RegExp(`^About ${faces.toLocaleString("en")} faces expected, of at most 50,000,000`),
    );
    return faces;
  };
  await expected({ preset: "volume" });
  assert.match(await text("#option-elements_per_circle-note"), /Faces to expect: [\d,]+ with 8, .* with 36\.$/);
  await slide('[aria-label="Target faces, slider"]', 0.5);
  const target = await page.$eval("#option-target_faces", (input) => Number(input.value));
  // The middle of 100 to a million, by factors.
  assert.ok(target > 5_000 && target < 20_000, `${target}`);
  const faces = await expected({ preset: "volume", target_faces: target });
  assert.ok(Math.abs(faces - target) < 0.1 * target, `${faces} for ${target}`);
  assert.deepEqual(await violations(page), []);
});

onAll("what is reported is marked completely, with a legend, and gone through", async (on) => {
  const { page, open, text, press, tab, view, scheme, waitForText, drop } = on;
  await open(everything(), kFaces);
  await press("#run");
  await waitForText("#status", /^Remeshed in/);
  // On a narrow screen, too, what came of it is seen without scrolling.
  const box = await (await page.$("#after")).boundingBox();
  assert.ok(box.y < on.height * 0.7 && box.y + box.height > 0, `the result is at ${box.y}`);
  const marked = (png) => partOf(png, kMark[scheme], 12);
  const isUnmarked = (png) => assert.ok(marked(png) < 0.0002, `marked: ${marked(png)}`);
  for (const side of ["before", "after"]) await view(side, isUnmarked);

  const openGroup = async (name) => {
    const button = await page.waitForSelector(`::-p-xpath(//*[@class="groups"]//button[starts-with(., "${name}")])`);
    await button.evaluate((element, text) => element.setAttribute("data-chosen", text), name);
    await press(`[data-chosen="${name}"]`);
  };
  await press("#tab-findings");
  await openGroup("Open boundary");
  assert.match(
    await text(".mark-legend"),
    new RegExp(`^All ${kOpenEdges} open edges are marked in this colour in the view before`),
  );
  await view("before", (png) => assert.ok(marked(png) > 0.0005, `marked: ${marked(png)}`));
  await press(".steps button:last-of-type");
  assert.equal(await text(".steps span"), `1 of ${kOpenEdges}`);
  await press(".steps button:first-of-type");
  assert.equal(await text(".steps span"), `${kOpenEdges} of ${kOpenEdges}`);
  await page.waitForSelector("#before-numbers:not([hidden])");

  await openGroup("Self intersection");
  // One pair of squares, each of which is drawn as two triangles; the line where they cross is 3 long.
  assert.match(await text(".mark-legend"), /^All \d lines where two faces cross are marked in this colour/);
  await press(".steps button:last-of-type");
  await view("before", (png) => assert.ok(marked(png) + chosenPart(png) > 0.0005, "the crossing is not marked"));

  await openGroup("Triangles below 25°");
  const { report } = JSON.parse(await set.daemon.remesh(join(folder.path, "everything.obj"), { format: "json" }));
  const missed = report.unrefined.reduce((sum, { count }) => sum + count, 0);
  assert.match(
    await text(".mark-legend"),
    new RegExp(`^All ${missed} triangles are marked in this colour in the view after`),
  );
  await press(".steps button:last-of-type");
  assert.ok(Number.parseFloat(await text("#after-numbers dl dd")) < 25);
  assert.deepEqual(await violations(page), []);
  // In other tabs nothing is marked, and nothing of it is there in the next run.
  await tab("quality");
  await page.focus("#after");
  await page.keyboard.press("Escape");
  await page.keyboard.press("Home");
  await view("after", isUnmarked);
  await tab("findings");
  await drop(folder.write("triangle.obj", "v 0 0 0\nv 4 0 0\nv 2 3 0\nf 1 2 3\n"));
  await waitForText("#before-count", /^1 face$/);
  await view("before", isUnmarked);
});

onAll("advice is a button, and the distance is a figure and a colour", async (on) => {
  const { page, open, text, press, choose, view, waitForText } = on;
  const file = everything();
  await open(file, kFaces);
  await (on.by === "mouse" ? on.unfold(".more") : press(".more summary"));
  await page.focus("#option-elements_per_circle");
  await page.keyboard.type("none");
  await press("#run");
  await waitForText("#status", /^Remeshed in/);
  await waitForText("#measured-distance", /^none, to rounding$/);
  const before = await analyzed(file, { elements_per_circle: "none" });
  const remedies = before.diagnostics.flatMap((diagnostic) => diagnostic.remedies.map(({ options }) => options));
  assert.ok(remedies.includes("elements_per_circle=16"), remedies.join());
  await press('#quality [data-options="elements_per_circle=16"]');
  assert.equal(await page.$eval("#option-elements_per_circle", (input) => input.value), "16");
  assert.equal(await page.evaluate(() => document.activeElement.id), "run");
  await waitForText("#status", /^Set: elements per circle = 16\./);
  await press("#run");
  await waitForText("#status", /^Remeshed in/);
  await waitForText("#measured-distance", /mean/);
  // A chord of a sixteenth of the turn, measured against facets of a forty-eighth.
  const height = (n) => kRadius * (1 - Math.cos(Math.PI / n));
  const measured = Number.parseFloat(await text("#measured-distance"));
  assert.ok(measured > 0.95 * (height(16) - height(kSteps)) && measured < 1.01 * height(16), `${measured}`);
  const proven = Number.parseFloat((await text("#quality")).replace(/^.*at most /, ""));
  assert.ok(measured <= proven, `${measured} is beyond ${proven}`);
  const byPatch = await view("after", isDrawn(0.02));
  await choose("#colouring", "distance");
  await view("after", differsFrom(byPatch, 0.01));
  assert.ok((await text("#legend")).startsWith(`0${Number(measured.toPrecision(3))}open or`));
  await choose("#colouring", "size");
  // The longest edges are at most as long as the whole, and the shortest are not none.
  const [least, most] = await page.$$eval("#legend > span:not(.legend-kind)", (ends) =>
    ends.map((end) => Number(end.textContent)),
  );
  assert.ok(least > 0 && most > least && most < 40, `${least} to ${most}`);
  await choose("#colouring", "group");
  assert.match(await text("#legend"), /^turnedboxesopen or non-manifold edges$/);
  const byGroup = await view("before", isDrawn(0.02));
  await choose("#colouring", "material");
  assert.match(await text("#legend"), /^steelbrassopen/);
  // The same faces have them, so that the colours are the same.
  await view("before", (png) => assert.ok(difference(byGroup, png) < 0.002));
  assert.deepEqual(await violations(page), []);
});

/** Where a view's triad has the end of an axis, from the middle. */
const axisEnd = (page, side, axis) =>
  page.$eval(`#${side} .axis-${axis} line`, (line) =>
    ["x2", "y2"].map((name) => Math.round(Number(line.getAttribute(name)) - 32)),
  );

onAll("standard views, an up axis, the overlay, a picture, and a reload", async (on) => {
  const { page, open, text, press, choose, view, waitForText } = on;
  await open(bracket, /^4,800 faces$/);
  await choose("#option-preset", "volume");
  await press("#run");
  await waitForText("#status", /^Remeshed in/);
  const first = await view("after", isDrawn(0.05));
  await choose("#look", "top");
  await view("after", differsFrom(first, 0.05));
  for (const side of ["before", "after"]) {
    // From above, x points to the right and y upwards, and z at the eye.
    assert.deepEqual(await axisEnd(page, side, "x"), [20, 0]);
    assert.deepEqual(await axisEnd(page, side, "y"), [0, -20]);
    assert.deepEqual(await axisEnd(page, side, "z"), [0, 0]);
  }
  await choose("#up-axis", "y");
  await choose("#look", "front");
  await eventually(async () => assert.deepEqual(await axisEnd(page, "after", "y"), [0, -20]));
  assert.deepEqual(await axisEnd(page, "after", "x"), [20, 0]);
  await page.focus("#after");
  await page.keyboard.press("4");
  // From the right, z comes to point to the left where y is upwards.
  await eventually(async () => assert.deepEqual(await axisEnd(page, "after", "z"), [-20, 0]));
  await page.keyboard.press("7");
  const alone = await view("after", isDrawn(0.05));
  await press("#overlay");
  await view("after", differsFrom(alone, 0.02));
  assert.deepEqual(await violations(page), []);

  rmSync(join(folder.path, "bracket.png"), { force: true });
  await press("#picture");
  await waitForText("#status", /^Saved as bracket\.png$/);
  const png = await eventually(() => PNG.sync.read(readFileSync(join(folder.path, "bracket.png"))));
  const canvas = await page.$eval("#canvas", ({ width, height }) => [width, height]);
  assert.deepEqual([png.width, png.height], canvas);
  isDrawn(0.1)(png);

  await page.reload();
  await waitForText("#before-count", /^4,800 faces$/);
  assert.equal(await page.$eval("#option-preset", (select) => select.value), "volume");
  await press("#forget");
  await waitForText("#status", /^It is no longer kept/);
  await page.reload();
  await page.waitForSelector("#option-refine");
  assert.equal(await text("#before-count"), "");
  assert.equal(await page.$eval("#option-preset", (select) => select.value), "none");
});

onAll("two places are measured", async (on) => {
  const { page, open, press, choose, text, waitForText, by } = on;
  const box = prism(
    [
      [0, 0],
      [4, 0],
      [4, 2],
      [0, 2],
    ],
    3,
    1,
  );
  await open(folder.write("box.obj", [...box.vertices, ...box.faces].join("\n")), /^6 faces$/);
  await choose("#look", "front");
  await press("#measure");
  await waitForText("#measured", /^Click two places/);
  await (await page.$("#before")).scrollIntoView();
  const { x, y, width, height } = await (await page.$("#before")).boundingBox();
  const half = (16 * Math.PI) / 180;
  const distance = 1.02 / Math.sin(Math.min(half, Math.atan((Math.tan(half) * width) / height)));
  const radius = Math.hypot(4, 2, 3) / 2;
  // Where a perspective from the front has a corner of the front face.
  const scale = height / 2 / Math.tan(half) / (distance - 1 / radius);
  const at = (dx, dz) => [x + width / 2 + (scale * dx) / radius, y + height / 2 - (scale * dz) / radius];
  if (by === "mouse") {
    await page.mouse.click(...at(-1.97, -1.47));
    await waitForText("#measured", /^Click the second place/);
    await page.mouse.click(...at(1.97, 1.47));
    await waitForText("#measured", /^Distance/);
    assert.equal(await text("#measured"), "Distance 5 (x 4, y 0, z 3)");
  } else {
    await page.focus("#before");
    await page.keyboard.press("Enter");
    await waitForText("#measured", /^Click the second place/);
    await page.keyboard.down("Shift");
    await page.keyboard.press("ArrowUp");
    await page.keyboard.up("Shift");
    await page.keyboard.press("Enter");
    await waitForText("#measured", /^Distance/);
    // A step is six hundredths of the view's height, at the depth of the middle; the front face is nearer by 1.
    const step = 0.06 * 2 * distance * Math.tan(half) * radius;
    const [, length, , , dz] = /^Distance ([\d.]+) \(x (-?[\d.e-]+), y (-?[\d.e-]+), z (-?[\d.]+)\)$/.exec(
      await text("#measured"),
    );
    assert.ok(Math.abs(Number(length) - step) < 1e-3 * step, `${length} instead of ${step}`);
    assert.ok(Math.abs(Math.abs(Number(dz)) - step) < 1e-3 * step);
  }
  assert.deepEqual(await violations(page), []);
  await press("#measure");
  assert.equal(await page.$eval("#measured", (element) => element.hidden), true);
});

onAll("a chosen surface leaves the other colours, and is let go", async (on) => {
  const { page, open, run, press, choose, view, waitForText } = on;
  await open(everything(), kFaces);
  await run();
  // The notes of options grow when the forecast comes, and move what is below them on a narrow screen.
  await waitForText("#forecast", /^About/);
  await choose("#colouring", "surface");
  await press("#tab-surfaces");
  const free = await view("after", isDrawn(0.02));
  const row = '.surface-list tr[data-kind="cylinder"] button';
  const isChosen = (png) => assert.ok(chosenPart(png) > chosenPart(free) + 0.005, "it is not shown");
  const letGo = {
    "the row once more": () => press(row),
    "a button": () => press(".let-go"),
    Escape: async () => {
      await page.focus("#surfaces");
      await page.keyboard.press("Escape");
    },
    "another tab": async () => {
      await press("#tab-quality");
      await press("#tab-surfaces");
    },
  };
  for (const [name, act] of Object.entries(letGo)) {
    await press(row);
    const chosen = await view("after", isChosen);
    // Nothing changes but what was chosen, and what is seen of it through the rest.
    assert.ok(difference(free, chosen) < 2 * chosenPart(chosen) + 0.03, `differs in ${difference(free, chosen)}`);
    await act();
    await view("after", (png) => {
      assert.ok(chosenPart(png) < chosenPart(free) + 0.001, `${name}: ${chosenPart(png)} is still yellow`);
    });
  }
});

for (const { by, ...options } of kCombinations) {
  test(`an error is told in the status and in sight (${options.width}, ${options.scheme}, ${by})`, async () => {
    const visitor = await openPage(set.browser, set.daemon.origin, options);
    const { page, open, waitForText, text } = visitor;
    const { press } = hands(visitor, by);
    try {
      await open(everything(), kFaces);
      await page.$eval(".more", (details) => (details.open = true));
      await page.focus("#option-reference_axis");
      await page.keyboard.type("north");
      await press("#run");
      await waitForText("#problem", /[Rr]eference_axis/);
      assert.match(await text("#status"), /[Rr]eference_axis/);
      const { top, bottom } = await page.$eval("#problem", (element) => {
        const box = element.getBoundingClientRect();
        return { top: box.top, bottom: box.bottom };
      });
      // Both are there: the message, and the option that it blames.
      assert.equal(await page.evaluate(() => document.activeElement.id), "option-reference_axis");
      assert.ok(bottom > top);
    } finally {
      await visitor.close();
    }
  });
}
