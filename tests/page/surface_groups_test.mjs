// Tests what the page makes of the surfaces in a report: groups, words and colours. It needs no browser and no daemon.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { pageModules, temporaryFolder } from "./support.mjs";

const folder = temporaryFolder();
let page;
before(async () => (page = await pageModules(folder, ["surfaces/groups", "surfaces/colours", "surfaces/facts"])));
after(() => folder.remove());

const box = { min: [0, 0, 0], max: [100, 60, 10] };
const curved = {
  axis: [0, 0, 1],
  point: [20, 30, 0],
  side: "concave",
  sweep_deg: 360,
  input_chord_height: 0.01,
  input_turn_deg: 15,
  tolerance: 0.01,
  bound: 0.008,
  fit_tolerance: 1e-5,
  fit_deviation: 4e-6,
};

/** Surfaces as a report has them: `parts` tells what is special of each. */
function report(...parts) {
  return parts.map((part, id) => ({ id, patches: 24, faces: 48, area: 100, bounding_box: box, ...part }));
}
const times = (n, make) => Array.from({ length: n }, (_, i) => make(i));
const cylinder = (radius, more = {}) => ({ kind: "cylinder", radius, ...curved, ...more });
const cone = (half_angle_deg) => ({ kind: "cone", half_angle_deg, ...curved });
const torus = (major_radius, minor_radius) => ({ kind: "torus", major_radius, minor_radius, ...curved });
const plane = (area) => ({
  kind: "plane",
  normal: [0, 0, 1],
  offset: 0,
  point: [0, 0, 0],
  area,
  fit_tolerance: 1e-5,
  bound: 0,
});
const free = (reason, area) => ({ kind: "free", reason, nearest_kind: null, nearest_deviation: null, area, bound: 0 });

/** The order of a report's list means nothing to a reader. */
function shuffled(items) {
  let seed = 11;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
  return [...items]
    .map((item) => [random(), item])
    .sort(([a], [b]) => a - b)
    .map(([, item]) => item);
}
const plate = report(
  ...times(6, (i) => plane(1000 * (i + 1))),
  ...times(8, (i) => cylinder(2.5 + i * 1e-7)),
  ...times(6, (i) => cylinder(3.175 - i * 1e-7)),
  ...times(28, (i) => cone(45 + (i - 14) * 1e-6)),
  torus(20, 3),
);

test("equal surfaces stand together, and a sentence tells how many there are", () => {
  const groups = page.groupSurfaces(plate);
  assert.equal(
    page.summaryOf(groups),
    "14 cylinders: 8 of r 2.5, 6 of r 3.175; 28 cones of 45°; 1 torus of r 20 and 3; 6 planes",
  );
  assert.deepEqual(groups.map(page.nameOfGroup), [
    "8 cylinders of r 2.5",
    "6 cylinders of r 3.175",
    "28 cones of 45°",
    "1 torus of r 20 and 3",
    "6 planes",
  ]);
  assert.deepEqual(
    groups.at(-1).surfaces.map(({ area }) => area),
    [6000, 5000, 4000, 3000, 2000, 1000],
  );
});

test("the order of the report's list changes nothing, and no surface is lost", () => {
  const groups = page.groupSurfaces(plate);
  assert.deepEqual(page.groupSurfaces(shuffled(plate)), groups);
  const ids = groups.flatMap(({ surfaces }) => surfaces.map(({ id }) => id));
  assert.deepEqual(
    ids.sort((a, b) => a - b),
    plate.map(({ id }) => id),
  );
});

test("radii that a file's rounding tells apart are one size, and radii that a drawing tells apart are two", () => {
  const sizes = (...parts) => page.groupSurfaces(report(...parts)).map(({ surfaces }) => surfaces.length);
  assert.deepEqual(sizes(cylinder(2.5), cylinder(2.5001)), [2]);
  assert.deepEqual(sizes(cylinder(2.5), cylinder(2.51)), [1, 1]);
  // An arc of 20 degrees leaves a radius open to 66 times the tolerance.
  const fillet = { sweep_deg: 20, fit_tolerance: 1e-5 };
  assert.deepEqual(sizes(cylinder(2.5, fillet), cylinder(2.501, fillet)), [2]);
  assert.deepEqual(sizes(cylinder(2.5), cylinder(2.501)), [1, 1]);
  // However little an arc says, sizes that differ by a hundredth are two.
  const sliver = { sweep_deg: 0.1, fit_tolerance: 1e-3 };
  assert.deepEqual(sizes(cylinder(2.5, sliver), cylinder(2.6, sliver)), [1, 1]);
  // Equal tori need not be next to each other in the order of their major radii.
  assert.deepEqual(sizes(torus(20, 3), torus(20 + 1e-7, 5), torus(20 + 2e-7, 3)), [2, 1]);
  assert.deepEqual(sizes(cone(45), cone(41)), [1, 1]);
});

test("free regions are put together by their reasons, and come after what was recognised", () => {
  const groups = page.groupSurfaces(
    report(plane(10), free("no_kind_fits", 5), free("few_facets", 9), free("no_kind_fits", 7), cylinder(1)),
  );
  assert.deepEqual(groups.map(page.nameOfGroup), [
    "1 cylinder of r 1",
    "1 free region: too few facets",
    "2 free regions: no kind fits",
    "1 plane",
  ]);
  assert.equal(page.summaryOf(groups), "1 cylinder of r 1; 3 free regions; 1 plane");
});

test("a sentence does not list more sizes than one can read", () => {
  const groups = page.groupSurfaces(report(...times(40, (i) => cylinder(i + 1))));
  assert.match(page.summaryOf(groups), /^40 cylinders: 1 of r 1, .*1 of r 6, and 34 more sizes$/);
});

test("every surface has a colour of its own, and the hue tells the kind", () => {
  const one = { kind: "sphere", radius: 1 };
  const outline = {
    kind: "revolution",
    profile: [
      [1, 0],
      [2, 1],
    ],
  };
  const kinds = [plane(1), cylinder(1), cone(45), one, torus(2, 1), outline, free("no_kind_fits", 1)];
  const surfaces = report(...kinds.flatMap((part) => times(9, () => part)));
  const colours = page.coloursOf(page.groupSurfaces(surfaces));
  const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
  for (const a of surfaces) {
    for (const b of surfaces.slice(a.id + 1)) {
      const between = distance(page.colourOf(colours, a), page.colourOf(colours, b));
      assert.ok(between > (a.kind === b.kind ? 0 : 24), `${a.kind} ${a.id}, ${b.kind} ${b.id}: ${between}`);
    }
    // Planes are muted: they have less colour than all others.
    const range = Math.max(...page.colourOf(colours, a)) - Math.min(...page.colourOf(colours, a));
    assert.equal(range < 20, a.kind === "plane", `${a.kind}: ${page.colourOf(colours, a)}`);
  }
});

test("patches get the colours of their surfaces, and those of chosen surfaces are marked", () => {
  const surfaces = report(cylinder(1), plane(4));
  const colours = page.coloursOf(page.groupSurfaces(surfaces));
  const table = page.patchTable(Uint32Array.of(1, 0, 1), colours, new Set([0]));
  const [round, flat] = surfaces.map((surface) => page.colourOf(colours, surface));
  assert.deepEqual([...table], [...flat, 0, ...round, 255, ...flat, 0]);
});

test("the numbers of a surface are those of the report, and rounding is not shown as a number", () => {
  const [hole, tip, ball, tube, vase] = report(
    cylinder(2.5, { axis: [1e-17, -0, 1], point: [20, 3e-9, 0], sweep_deg: 90 }),
    { kind: "cone", half_angle_deg: 41, ...curved },
    { kind: "sphere", radius: 3, ...curved, side: "convex" },
    torus(20, 3),
    {
      kind: "revolution",
      profile: [
        [1, 0],
        [4, 2],
        [2, 5],
      ],
      ...curved,
      side: "both",
    },
  ).map((surface) => Object.fromEntries(page.factsOf(surface)));
  assert.deepEqual(hole, {
    Radius: "2.5",
    Diameter: "5",
    Axis: "0, 0, 1",
    Through: "20, 0, 0",
    Sweep: "90.0°",
    Side: "concave (hole, fillet)",
    "Chord height": "0.01",
    "Turn of an edge": "15.0°",
    Faces: "48",
    Patches: "24",
    Area: "100",
    Extent: "100 × 60 × 10",
    "Deviation of corners": "4e-6",
    "Fit tolerance": "1e-5",
    "Surface tolerance": "0.01",
    "Proven distance": "0.008",
  });
  assert.equal(tip["Half angle"], "41° (82° across)");
  assert.equal(tip["Apex"], "20, 30, 0");
  assert.deepEqual([ball["Centre"], ball["Side"], ball["Sweep"]], ["20, 30, 0", "convex (ball)", undefined]);
  assert.deepEqual([tube["Radius of the ring"], tube["Radius of the tube"]], ["20", "3"]);
  assert.deepEqual([vase["Profile"], vase["Side"]], ["3 points, radius 1 to 4, height 0 to 5", "both sides"]);
});

test("a free region says why it is of no kind", () => {
  const why = (reason, nearest_kind, nearest_deviation = null) =>
    page.whyFree({ ...report(free(reason, 1))[0], nearest_kind, nearest_deviation });
  assert.equal(
    why("no_kind_fits", "torus", 0.012),
    "No kind of surface passes through all vertices. The nearest one is a torus, which it misses by 0.012.",
  );
  assert.equal(why("no_kind_fits", null), "No kind of surface passes through all vertices.");
  assert.equal(why("few_facets", "cylinder"), "A cylinder fits, but so few facets prove nothing.");
  assert.match(why("uneven_facets", "cylinder"), /^A cylinder fits, but .* meant to be flat\.$/);
});
