// The surfaces that a mesh was made from, as a person sees and chooses them: a real browser and the real daemon.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import {
  difference,
  drawn,
  isDrawn,
  pageTests,
  partWhere,
  sharedMesh,
  shownNumber,
  stage,
  turned,
} from "./support.mjs";

const set = stage();
const { folder } = set;
const onPage = pageTests(set);

/** A shaft with a shoulder: radii 6 and 3, and a cone of 45 degrees between. */
const shaft = () =>
  turned(folder, "shaft.json", [
    [0, 0],
    [6, 0],
    [6, 10],
    [3, 13],
    [3, 20],
    [0, 20],
  ]);

/** Clicks a view, at parts of its width and height from above. */
async function clickView(page, side, x, y) {
  const box = await (await page.$(`#${side}`)).boundingBox();
  await page.mouse.click(box.x + box.width * x, box.y + box.height * y);
  await page.waitForSelector(`#${side}-numbers:not([hidden])`);
}
/** Parts of a picture's pixels by what they show where surfaces are coloured: blue cylinders, orange cones, yellow. */
const bluePart = (png) => partWhere(png, (at) => png.data[at + 2] - png.data[at] > 60);
const orangePart = (png) => partWhere(png, (at) => png.data[at] - png.data[at + 1] > 72 && png.data[at + 2] < 120);
const yellowPart = (png) =>
  partWhere(png, (at) => png.data[at + 1] - png.data[at + 2] > 60 && png.data[at] - png.data[at + 1] < 60);
const facts = (page, selector) =>
  page.$$eval(`${selector} .surface-facts dl > div`, (all) =>
    Object.fromEntries(all.map((fact) => [...fact.children].map((child) => child.textContent))),
  );
const row = (name) => `::-p-xpath(//*[@class="surface-list"]//button[.="${name}"])`;

onPage("surfaces are a table, and a click on a row shows its faces", async ({ page, open, run, tab, view, text }) => {
  await open(shaft(), /^120 faces$/);
  await run();
  await tab("surfaces");
  assert.equal(await text(".surface-summary"), "2 cylinders: 1 of r 3, 1 of r 6; 1 cone of 45°; 2 planes.");
  const rows = await page.$$eval(".surface-list tbody tr", (all) =>
    all.map((one) => [...one.children].map((cell) => cell.textContent)),
  );
  assert.deepEqual(
    rows.map((cells) => cells.slice(0, 4)),
    [
      ["1 cylinder of r 3", "convex", "full turn", "24"],
      ["1 cylinder of r 6", "convex", "full turn", "24"],
      ["1 cone of 45°", "convex", "full turn", "24"],
      ["2 planes", "", "", "48"],
    ],
  );
  // The side of a prism of 24 edges around which the circle of radius 3 goes.
  const chord = 2 * 3 * Math.sin(Math.PI / 24);
  assert.equal(rows[0][4], shownNumber(24 * chord * 7));
  await page.select("#colouring", "surface");
  for (const side of ["before", "after"]) await view(side, (png) => assert.ok(yellowPart(png) < 0.002));
  await (await page.waitForSelector(row("1 cone of 45°"))).click();
  for (const side of ["before", "after"]) {
    await view(side, (png) => assert.ok(yellowPart(png) > 0.03, `yellow in ${side}: ${yellowPart(png)}`));
  }
  const cone = await facts(page, ".surface-details");
  assert.equal(cone["Half angle"], "45° (90° across)");
  assert.deepEqual([cone["Axis"], cone["Apex"], cone["Faces"]], ["0, 0, -1", "0, 0, 16", "24"]);
  // A second click gives it up.
  await (await page.waitForSelector(row("1 cone of 45°"))).click();
  await view("after", (png) => assert.ok(yellowPart(png) < 0.002));
  // One of two planes is chosen among them.
  await (await page.waitForSelector(row("2 planes"))).click();
  const both = await view("after", (png) => assert.ok(yellowPart(png) > 0.006));
  const lid = await page.waitForSelector(`::-p-xpath(//*[@class="surface-details"]//button[.="0, 0, 0"])`);
  await lid.click();
  assert.equal((await facts(page, ".surface-details"))["Offset"], "0");
  await view("after", (png) => assert.ok(yellowPart(png) < yellowPart(both)));
});

onPage("surfaces have colours, and a click on a face chooses its surface", async (visitor) => {
  const { page, open, run, tab, view, text, waitForText } = visitor;
  const file = shaft();
  await open(file, /^120 faces$/);
  await run();
  await page.select("#colouring", "plain");
  await view("after", (png) => assert.ok(Math.max(bluePart(png), orangePart(png)) < 0.01));
  await page.select("#colouring", "surface");
  for (const side of ["before", "after"]) {
    await view(side, (png) => {
      assert.ok(bluePart(png) > 0.08, `cylinders in ${side}: ${bluePart(png)}`);
      assert.ok(orangePart(png) > 0.02, `the cone in ${side}: ${orangePart(png)}`);
    });
  }
  assert.match(await text("#legend"), /cylinder.*cone.*plane/);
  await clickView(page, "after", 0.5, 0.75);
  await waitForText("#after-numbers h3", /^Cylinder, r 6$/);
  const shown = await facts(page, "#after-numbers");
  assert.deepEqual(
    [shown["Radius"], shown["Axis"].replace("-", ""), shown["Sweep"], shown["Turn of an edge"], shown["Faces"]],
    ["6", "0, 0, 1", "full turn", "15.0°", "24"],
  );
  assert.equal(shown["Chord height"], shownNumber(6 * (1 - Math.cos(Math.PI / 24))));
  for (const side of ["before", "after"]) await view(side, (png) => assert.ok(yellowPart(png) > 0.06));
  await tab("surfaces");
  assert.equal(await text(".surface-list .chosen button"), "1 cylinder of r 6");
  // The face that was clicked belongs to that surface, as the answer tells.
  await page.click("#after-numbers .link");
  const face = Number((await text("#after-numbers h3")).replace(/\D/g, ""));
  const { mesh, report } = JSON.parse(await set.daemon.remesh(file, { format: "json" }));
  const { kind, radius } = report.surfaces[report.patches[mesh.face_patch[face]].surface];
  assert.equal(kind, "cylinder");
  assert.ok(Math.abs(radius - 6) < 1e-6);
  await (await page.waitForSelector('::-p-xpath(//*[@id="after-numbers"]//button[.="Cylinder, r 6"])')).click();
  await waitForText("#after-numbers h3", /^Cylinder, r 6$/);
  // A click beside the part gives it up.
  const box = await (await page.$("#after")).boundingBox();
  await page.mouse.click(box.x + box.width * 0.97, box.y + box.height * 0.5);
  await view("after", (png) => assert.ok(yellowPart(png) < 0.002));
  assert.equal(await page.$(".surface-list .chosen"), null);
});

onPage("a free region says why no kind fits", async ({ page, open, run, tab, text }) => {
  // A turned part is a surface of revolution; one whose edges are moved by some hundredths is nothing.
  const outline = [0, 1, 2, 3, 4, 5, 6].map((i) => [4 + Math.sin(i / 2), 2 * i]);
  const file = turned(folder, "vase.json", [[0, 0], ...outline, [0, 12]]);
  const { vertices, faces } = JSON.parse(readFileSync(file));
  vertices.forEach((p, i) => {
    if (p[2] > 0 && p[2] < 12) p.forEach((x, axis) => (p[axis] = x + 0.03 * Math.sin(7 * i + 3 * axis)));
  });
  const triangles = faces.flatMap(([a, b, c, d]) => (d === undefined ? [[a, b, c]] : [[a, b, c], [a, c, d]])); // prettier-ignore
  await open(folder.write("dented.json", JSON.stringify({ vertices, faces: triangles })), /faces$/);
  await run();
  await tab("surfaces");
  assert.match(await text(".surface-summary"), /free region/);
  await page.click('.surface-list tr[data-kind="free"] button');
  assert.match(await text(".surface-details"), /No kind of surface passes through all vertices\./);
});

onPage("an analysis tells the surfaces, and draws none", async ({ page, open, tab, waitForText, view, text }) => {
  await open(shaft(), /^120 faces$/);
  await page.click("#analyze");
  await waitForText("#status", /^Analyzed in/);
  await tab("surfaces");
  assert.match(await text(".surface-details"), /Remesh the mesh to see its surfaces in the views/);
  await page.select("#colouring", "surface");
  const before = await view("before", isDrawn());
  await (await page.waitForSelector(row("1 cylinder of r 3"))).click();
  assert.equal((await facts(page, ".surface-details"))["Diameter"], "6");
  assert.equal(difference(before, await view("before")), 0);
});

onPage("with a feature angle of 0 each facet is a surface of its own", async (visitor) => {
  const { page, open, type, run, tab, text } = visitor;
  await open(shaft(), /^120 faces$/);
  await visitor.unfold(".more");
  assert.match(await text("#option-feature_angle_deg-note"), /features.*curved surface.*\(0 to 180\)/);
  await type("#option-feature_angle_deg", "0");
  await run();
  await tab("surfaces");
  assert.equal(await text(".surface-summary"), "74 planes.");
});

onPage("options of curved surfaces are hinted at, checked and sent", async (visitor) => {
  const { page, open, type, run, tab, text, waitForText } = visitor;
  await open(shaft(), /^120 faces$/);
  await visitor.unfold(".more");
  const elements = "#option-elements_per_circle";
  assert.match(
    await text(`${elements}-note`),
    /16 is usual before volume meshing; none: .* than 32 facets per turn get 24 \(3 to 1,000\)\./, // and what is to be expected, once that is known
  );
  const usual = await page.$eval(elements, (input) => [...input.list.options].map(({ value }) => value));
  assert.equal(usual.join(), "8,12,16,24,36");
  const sliders = (id) => page.$eval(id, (input) => input.closest(".option").querySelectorAll("[type=range]").length);
  assert.deepEqual([await sliders(elements), await sliders("#option-feature_angle_deg")], [0, 1]);
  await type(elements, "2");
  await waitForText(`${elements}-note`, /^This takes a number, 3 to 1,000; or none/);
  await type(elements, "16");
  assert.equal(await page.$eval("#option-surface_tolerance", (input) => input.placeholder), "auto");
  await type("#option-surface_tolerance", "0.1");
  assert.equal(await page.$eval("#option-surface_tolerance_fraction", (input) => input.disabled), true);
  await page.select("#option-preset", "exact");
  assert.equal(await page.$eval("#option-circle_fit", (select) => select.value), "inscribed");
  await page.select("#option-circle_fit", "volume");
  await tab("download");
  assert.match(
    await text("#curl"),
    /\?preset=exact&surface_tolerance=0\.1&elements_per_circle=16&circle_fit=volume&format=/,
  );
  await run();
  await page.click("#reset");
  assert.equal(await page.$eval("#option-preset", (select) => select.value), "none");
  assert.equal(await page.$eval(elements, (input) => input.value), "");
});

onPage("the surfaces of a plate with holes are those of its drawing", async (visitor, t) => {
  const { page, open, run, tab, view, text, waitForText } = visitor;
  const plate = sharedMesh(t, "planar-cad/plate_holes.STL");
  if (plate === null) return;
  await open(plate, /^1,252 faces$/);
  await run();
  await tab("surfaces");
  await page.select("#colouring", "surface");
  // Holes of 0.266 and 7/16 inches, and corners of 2 and of 1/2 inches, in millimetres.
  assert.match(
    await text(".surface-summary"),
    /^14 cylinders: 5 of r 3\.3782, 1 of r 5\.5563, 4 of r 6\.35, 4 of r 25\.4; /,
  );
  const { report } = JSON.parse(await set.daemon.remesh(plate, { format: "json" }));
  for (const kind of new Set(report.surfaces.map((surface) => surface.kind))) {
    const named = await page.$$eval(`.surface-list tr[data-kind="${kind}"] button`, (all) =>
      all.reduce((sum, button) => sum + Number.parseInt(button.textContent), 0),
    );
    assert.equal(named, report.surfaces.filter((surface) => surface.kind === kind).length, kind);
  }
  // The hole in the middle, seen from above.
  const far = await view("after", (png) => assert.ok(yellowPart(png) < 0.0002, `yellow: ${yellowPart(png)}`));
  await clickView(page, "after", 0.505, 0.484);
  await waitForText("#after-numbers h3", /^Cylinder, r 5\.5563$/);
  assert.equal(await text(".surface-list .chosen button"), "1 cylinder of r 5.5563");
  assert.equal((await facts(page, "#after-numbers"))["Side"], "concave (hole, fillet)");
  await page.keyboard.press("Escape");
  await (await page.waitForSelector(row("4 cylinders of r 25.4"))).click();
  await view("after", (png) => assert.ok(yellowPart(png) > 0.001, `yellow: ${yellowPart(png)}`));
  assert.ok(drawn(far).colours > 50);
});
