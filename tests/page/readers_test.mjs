// The page's own readers and numbers, without a browser: held against what the daemon says of the same files.
import assert from "node:assert/strict";
import { readFileSync, readdirSync, statSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { bracket, pageModules, sharedMesh, startDaemon, temporaryFolder } from "./support.mjs";

const kModules = [
  "mesh/read",
  "mesh/drawable",
  "mesh/surface",
  "mesh/quality",
  "mesh/scanner",
  "mesh/triangulate",
  "mesh/nearest",
  "mesh/deviation",
  "mesh/line_sets",
  "mesh/face_labels",
  "samples",
  "service/curl",
  "ui/words",
  "ui/options_form",
];
const folder = temporaryFolder();
let daemon;
let page;

before(async () => {
  [daemon, page] = await Promise.all([startDaemon(), pageModules(folder, kModules)]);
});
after(() => {
  daemon?.stop();
  folder.remove();
});

async function analyzed(bytes) {
  const response = await fetch(`${daemon.origin}/v1/analyze`, { method: "POST", body: bytes });
  return { status: response.status, body: await response.json() };
}

async function compare(name, bytes) {
  const { status, body } = await analyzed(bytes);
  if (status !== 200) return false;
  const { input } = body.report;
  const surface = await page.readMesh(new Uint8Array(bytes));
  assert.equal(page.faceCount(surface), input.faces, `${name}: faces`);
  assert.equal(surface.points.length / 3, input.vertices, `${name}: vertices`);
  const draft = new page.Draft(surface);
  const size = input.bounding_box.max.map((x, axis) => x - input.bounding_box.min[axis]);
  draft.size.forEach((x, axis) =>
    assert.ok(Math.abs(x - size[axis]) <= 1e-12 * Math.hypot(...size), `${name}: extent`),
  );
  return true;
}

test("every format of the bracket is read as the daemon reads it", async () => {
  const bytes = readFileSync(bracket);
  assert.ok(await compare("bracket.obj", bytes));
  for (const format of ["obj", "json", "stl", "ply", "off"]) {
    assert.ok(await compare(format, await daemon.remesh(bracket, { format, refine: false })), format);
  }
});

test("every part of the corpus is read as the daemon reads it", async (t) => {
  const corpus = sharedMesh(t, "");
  if (corpus === null) return;
  let compared = 0;
  const wrong = [];
  for (const name of readdirSync(corpus, { recursive: true }).map(String).sort()) {
    const path = join(corpus, name);
    const isMesh = /\.(obj|stl|ply|off|json)(\.gz)?$/i.test(name) && statSync(path).size < 400_000;
    try {
      if (isMesh && (await compare(name, readFileSync(path)))) ++compared;
    } catch (error) {
      wrong.push(`${name}: ${error.message}`);
    }
  }
  assert.deepEqual(wrong, []);
  assert.ok(compared > 60, `only ${compared} were compared`);
});

test("text STL of the wild is read as the daemon reads it", async () => {
  const facet = (end) => `Facet Normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e0 +0 0\nvertex 0 1 0\n${end}`;
  for (const text of [
    `solid vertex 1 2 3\n${facet("end loop\nEND  FACET")}\nend solid endloop\n`,
    `solid\n${facet("endloop\nendfacet")}\nsolid b\n${facet("endloop\nendfacet")}\n`,
    `# endloop\n\nsolid ${"facet ".repeat(300)}\n; vertex\nmade by vertex\n${facet("endloop # end\nendfacet")}\nendsolid\n`,
  ]) {
    assert.ok(await compare("wild.stl", new TextEncoder().encode(text)), text);
  }
});

test("what is no mesh is told in words", async () => {
  const read = (text) => page.readMesh(new TextEncoder().encode(text));
  for (const [text, words] of [
    ["f 1 2 3\n", /does not exist/],
    ["v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", /number from 1/],
    ["v 0 0 0\n", /no face/],
    ["v 0 0 x\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", /not a finite number/],
    ["hello", /not a mesh/],
    ["", /not a mesh/],
    ['{"vertices": [', /not valid JSON/],
    ['{"a": 1}', /no vertices/],
    ["OFF\n3 1 0\n0 0 0\n", /ends too early/],
    ["ply\nformat ascii 1.0\nelement vertex 1\n", /no end/],
  ]) {
    await assert.rejects(
      read(text),
      (error) => error instanceof page.UnreadableMesh && words.test(error.message),
      text,
    );
  }
  await assert.rejects(page.readMesh(Uint8Array.of(0x1f, 0x8b, 1, 2)), /gzip/);
});

test("numbers are read to the last bit", () => {
  let seed = 7;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
  const texts = [
    "0",
    "-0",
    "1",
    "+1.5",
    ".5",
    "5.",
    "1e5",
    "1E-5",
    "-1.25e+3",
    "0.1",
    "123456789012345678901234567890",
    "1e400",
    "1e-400",
    "4.9e-324",
  ];
  for (let i = 0; i < 20_000; ++i)
    texts.push(((random() - 0.5) * 10 ** (random() * 60 - 30)).toPrecision(1 + Math.floor(random() * 17)));
  const scanner = new page.Scanner(new TextEncoder().encode(texts.join(" ")));
  for (const text of texts) assert.ok(Object.is(scanner.number(), Number(text)), text);
  for (const text of ["", "x", "1x", "--1", "e5", "."])
    assert.ok(Number.isNaN(new page.Scanner(new TextEncoder().encode(text)).number()), text);
});

test("the samples are closed parts that the daemon takes without a word", async () => {
  assert.equal(page.kSamples.length, 3);
  for (const { name, obj } of page.kSamples) {
    const { report } = (await analyzed(obj())).body;
    assert.ok(report.input.closed && report.input.volume > 0 && report.volume_ready.ready, name);
    const defects = report.diagnostics.filter(({ code }) => code !== "curved_surface");
    assert.deepEqual(defects, [], name);
    assert.ok(report.input.quality.min_angle_deg < 1, `${name} has nothing to mend`);
  }
});

test("the smallest angle and the worst ratio of a mesh are the report's", async () => {
  const { report } = (await analyzed(readFileSync(bracket))).body;
  const draft = new page.Draft(await page.readMesh(new Uint8Array(readFileSync(bracket))));
  const { values } = draft.drawable(null);
  let [least, most] = [180, 0];
  for (let t = 0; t < values.length; t += 4) {
    least = Math.min(least, values[t]);
    most = Math.max(most, values[t + 1]);
  }
  const near = (a, b) => Math.abs(a - b) < 1e-4 * b;
  assert.ok(near(least, report.input.quality.min_angle_deg), `${least}`);
  assert.ok(near(most, report.input.quality.radius_edge_ratio.max), `${most}`);
  // One triangle by itself, where the answer is known: 3, 4, 5.
  const right = page.measureTriangle(Float64Array.of(0, 0, 0, 3, 0, 0, 0, 4, 0), 0, 3, 6);
  assert.deepEqual(right.lengths, [5, 4, 3]);
  assert.equal(right.area, 6);
  assert.ok(near(right.radiusEdgeRatio, 2.5 / 3) && near(right.minAngle, (Math.atan(3 / 4) * 180) / Math.PI));
});

test("a concave polygon with a bent outline is filled, and nothing else", () => {
  const points = [
    [0, 0],
    [4, 0],
    [4, 4],
    [2, 1],
    [0, 4],
  ];
  for (const lift of [([x, y]) => [x, y, 0], ([x, y]) => [0, x, y], ([x, y]) => [y, 0, x], ([x, y]) => [x, y, x + y]]) {
    const builder = new page.SurfaceBuilder();
    for (const p of points) builder.addPoint(...lift(p));
    points.forEach((_, i) => builder.addCorner(i));
    builder.endFace();
    const surface = builder.finish();
    const { corners, diagonals, face } = page.triangulate(surface);
    assert.equal(face.length, 3);
    const area = (ids) => {
      const [a, b, c] = ids.map((i) => points[i]);
      return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    };
    const areas = [0, 1, 2].map((t) => area([...corners.slice(3 * t, 3 * t + 3)]));
    assert.ok(
      areas.every((a) => a > 0),
      "turned over",
    );
    assert.equal(
      areas.reduce((sum, a) => sum + a, 0),
      10,
    );
    // Two diagonals, seen from both sides.
    assert.equal(
      [...diagonals]
        .join("")
        .replaceAll(/[1-7]/g, (bits) => "x".repeat([0, 1, 1, 2, 1, 2, 2, 3][bits]))
        .replaceAll("0", "").length,
      4,
    );
  }
});

test("edges of one, two and three triangles are told apart", () => {
  const builder = new page.SurfaceBuilder();
  // Three triangles around one edge, each with points of its own, as STL has them.
  for (const tip of [
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
  ]) {
    const first = builder.pointCount;
    for (const p of [[-1, 0, 0], [1, 0, 0], tip]) builder.addPoint(...p);
    for (let i = 0; i < 3; ++i) builder.addCorner(first + i);
    builder.endFace();
  }
  const drawable = new page.Draft(builder.finish()).drawable(null);
  assert.equal(drawable.openEdges, 6);
  assert.equal(drawable.nonManifoldEdges, 3);
});

test("a curl line survives any file name", () => {
  assert.equal(page.shellWord("part-1.obj"), "part-1.obj");
  assert.equal(page.shellWord("it's a $(part).obj"), `'it'\\''s a $(part).obj'`);
  assert.equal(page.resultName("Part.v2.stl.gz", "obj"), "Part.v2-remeshed.obj");
  const line = page.curlLine("http://h:1", "a b.stl", [["barriers", "object,group"]], "ply", "ply", true);
  assert.equal(
    line,
    `curl --fail-with-body -H "Authorization: Bearer $REMESHD_API_KEY" --data-binary '@a b.stl' ` +
      `'http://h:1/v1/remesh?barriers=object,group&format=ply' -o 'a b-remeshed.ply'`,
  );
  assert.match(
    page.curlLine("http://h:1", "a.obj", [], "stl_ascii", "stl", false),
    /format=stl_ascii' -o a-remeshed.stl$/,
  );
});

test("the bounds of an option are the ones that the service names", async () => {
  const { options } = await (await fetch(`${daemon.origin}/v1/capabilities`)).json();
  for (const spec of options.filter(({ type }) => type === "number" || type === "integer")) {
    for (const text of ["-1", "0", "0.5", "1", "2", "33", "34", "1e3", "x"]) {
      // This one means nothing by itself.
      const beside = spec.name === "max_hole_edges" ? "&repair=%2Bholes" : "";
      const response = await fetch(`${daemon.origin}/v1/analyze?${spec.name}=${text}${beside}`, {
        method: "POST",
        body: "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
      });
      const isRefused = response.status === 400 && (await response.json()).option === spec.name;
      assert.equal(page.faultOfNumber(spec, text) !== null, isRefused, `${spec.name}=${text}`);
    }
  }
});

/** The surface of a ball as triangles, by quadrilaterals of latitude and longitude. */
function ball(radius, steps) {
  const at = (i, j) => {
    const [polar, turn] = [(Math.PI * i) / steps, (2 * Math.PI * j) / steps];
    return [Math.sin(polar) * Math.cos(turn), Math.sin(polar) * Math.sin(turn), Math.cos(polar)].map((x) => radius * x);
  };
  const positions = [];
  for (let i = 0; i < steps; ++i) {
    for (let j = 0; j < steps; ++j) {
      positions.push(
        ...at(i, j),
        ...at(i + 1, j),
        ...at(i + 1, j + 1),
        ...at(i, j),
        ...at(i + 1, j + 1),
        ...at(i, j + 1),
      );
    }
  }
  return Float32Array.from(positions);
}

test("the nearest triangle of a ball is as far as its surface", () => {
  const steps = 60;
  const tree = new page.NearestTriangles(ball(1, steps));
  const sag = 1 - Math.cos((Math.PI * Math.SQRT2) / steps);
  for (let i = 0; i < 500; ++i) {
    const p = [1, 2, 3].map((k) => 2 * Math.sin(i * k + 0.3 * k * k));
    const expected = Math.abs(Math.hypot(...p) - 1);
    assert.ok(Math.abs(tree.distance(...p) - expected) <= sag, `${p}: ${tree.distance(...p)} instead of ${expected}`);
  }
  assert.equal(new page.NearestTriangles(new Float32Array()).distance(0, 0, 0), Infinity);
});

test("two balls of one middle are apart by the difference of their radii", () => {
  const deviation = page.deviationOf(ball(1, 32), ball(0.75, 24));
  const sag = 1 - Math.cos((Math.PI * Math.SQRT2) / 24);
  assert.ok(
    Math.abs(deviation.max - 0.25) < 2 * sag && Math.abs(deviation.mean - 0.25) < sag,
    JSON.stringify(deviation.mean),
  );
  const same = page.deviationOf(ball(1, 40), ball(1, 40));
  assert.deepEqual([same.max, same.mean], [0, 0]);
});

test("lines are the edges that a report counts", async () => {
  const fan = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n";
  const bytes = new TextEncoder().encode(fan);
  const { input } = (await analyzed(bytes)).body.report;
  const fanned = new page.Draft(await page.readMesh(bytes)).drawable(null);
  assert.equal(page.openEdges(fanned).triangle.length, input.boundary_edges);
  // One edge, seen from each of its three faces.
  assert.equal(input.non_manifold_edges, 1);
  assert.equal(page.nonManifoldEdges(fanned).triangle.length, 3);
  const crossed = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -1\nv 1 1 2\nv 9 9 2\nf 1 2 3\nf 4 5 6\n";
  const drawable = new page.Draft(await page.readMesh(new TextEncoder().encode(crossed))).drawable(null);
  const { segments } = page.crossings(drawable, [[0, 1]]);
  const { centre, radius } = drawable.frame;
  const ends = [0, 3].map((at) => [0, 1, 2].map((axis) => segments[at + axis] * radius + centre[axis]));
  // The second one stands over the diagonal, passes the first one's plane from (1, 1) and leaves it at (2, 2).
  ends.sort((p, q) => p[0] - q[0]);
  [
    [1, 1, 0],
    [2, 2, 0],
  ].forEach((p, i) => p.forEach((x, axis) => assert.ok(Math.abs(ends[i][axis] - x) < 1e-5, `${ends}`)));
});

test("the values of presets are read from what the service says of them", async () => {
  const { options } = await (await fetch(`${daemon.origin}/v1/capabilities`)).json();
  const preset = options.find(({ name }) => name === "preset");
  for (const word of preset.values) {
    const values = page.presetValues(preset, word);
    assert.ok(values.size > 0, word);
    const answer = JSON.parse(await daemon.remesh(bracket, { format: "json", preset: word }));
    for (const [name, value] of values) assert.equal(String(answer.report.options[name]), value, name);
  }
  assert.equal(page.presetValues(preset, null).size, 0);
});

test("a label of patches is that of their faces, and none where they differ", () => {
  const mesh = { face_patch: [0, 0, 1, 1], labels: { group: { names: ["a", "b"], of_face: [1, 1, 0, 1] } } };
  const [labels] = page.labelsOf(mesh);
  assert.deepEqual([labels.kind, ...labels.ofPatch], ["group", 1, -1]);
  assert.deepEqual(page.labelsOf({ face_patch: [0, 1], face_groups: [7, 3] })[0].names, ["3", "7"]);
});
