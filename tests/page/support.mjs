// A daemon, a browser, and what the tests ask of pictures.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { PNG } from "pngjs";
import puppeteer from "puppeteer-core";

export const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
export const bracket = join(root, "tests/data/bracket.obj");
/**
 * The path of a shared mesh. Null where it is missing: the test `t` is then skipped, or fails if the shared meshes are
 * required.
 */
export function sharedMesh(t, name) {
  const path = join(process.env.REMESHD_CORPUS || join(root, "../shared/meshes"), name);
  if (existsSync(path)) return path;
  assert.notEqual(process.env.REMESHD_REQUIRE_CORPUS, "1", `there is no ${path}`);
  t.skip(`SKIPPED: there is no ${path}`);
  return null;
}
/** So that both views have the same whole number of pixels. */
const kWidth = 1281;
/** How long to wait for what must happen: minutes, so that a busy machine is not taken for a fault. */
const kPatienceMs = Number(process.env.REMESHD_PAGE_PATIENCE_MS || 120_000);
export const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** What `check` gives once it no longer throws. It is asked again and again; in the end what it throws is thrown. */
export async function eventually(check) {
  const deadline = Date.now() + kPatienceMs;
  for (;;) {
    try {
      return await check();
    } catch (error) {
      if (Date.now() > deadline) throw error;
    }
    await pause(40);
  }
}

/** The real daemon on a free port, of 127.0.0.1 unless an option says another address. */
export async function startDaemon(...options) {
  const environment = Object.fromEntries(Object.entries(process.env).filter(([name]) => !name.startsWith("REMESHD_")));
  const bind = options.includes("--bind") ? [] : ["--bind", "127.0.0.1:0"];
  const child = spawn(process.env.REMESHD_PATH, [...bind, "--log-format", "json", ...options], {
    stdio: ["ignore", "ignore", "pipe"],
    env: environment,
  });
  const address = await new Promise((resolve, reject) => {
    let text = "";
    child.stderr.on("data", (data) => {
      text += data;
      const found = /"address": *"([^"]+)"/.exec(text);
      if (found) resolve(found[1]);
    });
    child.on("exit", () => reject(new Error(`the daemon ended: ${text}`)));
  });
  const origin = `http://${address}`;
  return {
    origin,
    stop: () => child.kill("SIGKILL"),
    /** What a program would get for the same file and query. */
    async remesh(file, query) {
      const response = await fetch(`${origin}/v1/remesh?${new URLSearchParams(query)}`, {
        method: "POST",
        body: readFileSync(file),
      });
      if (response.status !== 200) throw new Error(`status ${response.status}: ${await response.text()}`);
      return Buffer.from(await response.arrayBuffer());
    },
  };
}

export function temporaryFolder() {
  const path = mkdtempSync(join(tmpdir(), "remeshd-page-"));
  return {
    path,
    write(name, content) {
      writeFileSync(join(path, name), content);
      return join(path, name);
    },
    remove: () => rmSync(path, { recursive: true, force: true }),
  };
}

/** Modules of the page, by their paths below `src` without endings, made into one that node can load. */
export async function pageModules(folder, names) {
  const web = join(root, "server/web");
  const { build } = await import(pathToFileURL(join(web, "node_modules/esbuild/lib/main.js")));
  const outfile = join(folder.path, "page.mjs");
  await build({
    stdin: { contents: names.map((name) => `export * from "./src/${name}.ts";`).join("\n"), resolveDir: web },
    bundle: true,
    format: "esm",
    platform: "node",
    outfile,
    logLevel: "warning",
  });
  return import(pathToFileURL(outfile));
}

/** `options` are further flags of the browser. */
export async function startBrowser(...options) {
  return puppeteer.launch({
    executablePath: process.env.CHROMIUM_PATH,
    headless: true,
    args: [
      "--no-sandbox",
      "--use-gl=angle",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--disable-dev-shm-usage",
      "--force-device-scale-factor=1",
      "--hide-scrollbars",
      // The tests look at colours, so edges need not be smooth. That takes software a tenth less time.
      "--webgl-antialiasing-mode=none",
      ...options,
    ],
    timeout: kPatienceMs,
    protocolTimeout: 2 * kPatienceMs,
  });
}

let shared = null;

/**
 * A daemon and a browser for all tests of this process, from before the first to after the last, and a folder, at once.
 */
export function stage() {
  if (shared) return shared;
  const set = (shared = { folder: temporaryFolder(), daemon: undefined, browser: undefined });
  before(async () => {
    [set.daemon, set.browser] = await Promise.all([startDaemon(), startBrowser()]);
  });
  after(async () => {
    await set.browser?.close();
    set.daemon?.stop();
    set.folder.remove();
  });
  return set;
}

/** Output: a function that makes tests with a page of their own, whose console must stay empty. */
export function pageTests(set) {
  return (name, run, options = {}) => {
    test(name, async (t) => {
      const {
        origin = set.daemon.origin,
        mayComplain = false,
        ...rest
      } = typeof options === "function" ? await options() : options;
      const visitor = await openPage(set.browser, origin, { downloads: set.folder.path, ...rest });
      try {
        await run(visitor, t);
        if (!mayComplain) assert.deepEqual(visitor.faults, []);
      } finally {
        await visitor.close();
      }
    });
  };
}

/** Tabs that a test has left, by their browsers: a new one costs as much as many a test. */
const leftTabs = new WeakMap();

async function newTab(browser) {
  const context = await browser.createBrowserContext();
  const page = await context.newPage();
  page.setDefaultTimeout(kPatienceMs);
  const tab = { page, context, session: await page.createCDPSession(), faults: [], origin: "" };
  const note = (fault) => tab.faults.push(fault);
  page.on("pageerror", (error) => note(`error: ${error.message}`));
  page.on("console", (message) => {
    // A request may be over just when the page asks how far it is: 404, which browsers note by themselves.
    if (message.location().url?.includes("/v1/requests/")) return;
    if (["error", "warn"].includes(message.type())) note(`${message.type()}: ${message.text()}`);
  });
  page.on("request", (request) => {
    if (!request.url().startsWith(tab.origin) && !/^(blob|data|about):/.test(request.url()))
      note(`elsewhere: ${request.url()}`);
  });
  return tab;
}

/**
 * A tab of the page, with everything that a person does there. `faults` gathers what must not be in any console; `path`
 * is another page, which is there once it has `ready`.
 */
export async function openPage(
  browser,
  origin,
  {
    width = kWidth,
    height = 800,
    scheme = "light",
    downloads,
    path = "/",
    ready = "#option-refine, #key-dialog[open]",
  } = {},
) {
  if (!leftTabs.has(browser)) leftTabs.set(browser, []);
  const tab = leftTabs.get(browser).pop() ?? (await newTab(browser));
  const { page, context, session } = tab;
  // Nobody has been here before.
  if (tab.origin) await session.send("Storage.clearDataForOrigin", { origin: tab.origin, storageTypes: "all" });
  tab.origin = origin;
  const faults = (tab.faults = []);
  await page.setViewport({ width, height, hasTouch: width < 500 });
  // Without flights of the camera: what is seen is then there at once.
  await page.emulateMediaFeatures([
    { name: "prefers-color-scheme", value: scheme },
    { name: "prefers-reduced-motion", value: "reduce" },
  ]);
  if (downloads)
    await session.send("Browser.setDownloadBehavior", {
      behavior: "allow",
      downloadPath: downloads,
      browserContextId: context.id,
    });
  await page.goto(origin + path, { waitUntil: "load" });
  await page.waitForFunction((selector) => document.querySelector(selector), {}, ready);

  const text = (selector) => page.$eval(selector, (element) => element.textContent);
  const self = {
    page,
    faults,
    text,
    async close() {
      // What is still going on ends with the page.
      await page.goto("about:blank");
      leftTabs.get(browser).push(tab);
    },
    /** As the desktop does it: a file dragged over the page and let go. */
    async drop(file) {
      const data = { items: [], files: [file], dragOperationsMask: 1 };
      for (const type of ["dragEnter", "dragOver", "drop"])
        await session.send("Input.dispatchDragEvent", { type, x: 200, y: 300, data });
    },
    async waitForText(selector, pattern, timeout = kPatienceMs) {
      try {
        await page.waitForFunction(
          (s, source) => new RegExp(source).test(document.querySelector(s)?.textContent ?? ""),
          { timeout, polling: 50 },
          selector,
          pattern.source,
        );
      } catch {
        throw new Error(
          `${selector} never said ${pattern}, but: ${await text(selector)}; the console: ${faults.join(" | ")}`,
        );
      }
    },
    async open(file, faces) {
      await self.drop(file);
      await self.waitForText("#before-count", faces);
    },
    async type(selector, value) {
      await page.click(selector, { count: 3 });
      await page.keyboard.press("Backspace");
      if (value !== "") await page.type(selector, value);
    },
    /** Opens a part of the page that is folded. A click misses its heading if the page grows above it just then. */
    async unfold(selector) {
      await eventually(async () => {
        const isOpen = () => page.$eval(selector, (details) => details.open);
        if (!(await isOpen())) await page.click(`${selector} > summary`);
        assert.ok(await isOpen(), `${selector} is folded`);
      });
    },
    async run() {
      await page.click("#run");
      await self.waitForText("#status", /^Remeshed in/);
    },
    async tab(name) {
      await page.click(`#tab-${name}`);
    },
    /** The number in a row of the report, before or after. */
    async cell(row, column) {
      return page.$eval(
        `[data-row="${row}"]`,
        (element, i) => element.querySelectorAll("td")[i].textContent,
        column === "after" ? 1 : 0,
      );
    },
    async picture(selector) {
      // While a camera moves, the page may draw with fewer pixels; it says when it has drawn what stays.
      await page.waitForSelector("#canvas[data-still]");
      await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
      const clip = await page.$eval(selector, (element) => {
        const { x, y, width, height } = element.getBoundingClientRect();
        return { x: x + scrollX, y: y + scrollY, width, height };
      });
      return PNG.sync.read(Buffer.from(await page.screenshot({ clip, optimizeForSpeed: true })));
    },
    /** A view, once it has come to rest and `check` throws nothing of it: a busy browser shows a frame late. */
    async view(side, check = () => {}) {
      return eventually(async () => {
        const picture = await self.picture(`#${side}`);
        await check(picture);
        return picture;
      });
    },
  };
  return self;
}

const colourAt = (png, at) => (png.data[at] << 16) | (png.data[at + 1] << 8) | png.data[at + 2];

/** Of 255. */
const kRounding = 4;

export function partWhere(png, holds) {
  let count = 0;
  for (let at = 0; at < png.data.length; at += 4) if (holds(at)) ++count;
  return count / (png.data.length / 4);
}

/** Part of a picture's pixels that are not of its most frequent colour, and how many colours it has. */
export function drawn(png) {
  const counts = new Map();
  for (let at = 0; at < png.data.length; at += 4)
    counts.set(colourAt(png, at), (counts.get(colourAt(png, at)) ?? 0) + 1);
  const most = Math.max(...counts.values());
  return { part: 1 - most / (png.data.length / 4), colours: counts.size };
}

/** Part of the pixels that differ by more than rounding. */
export function difference(a, b) {
  return partWhere(a, (at) => [0, 1, 2].some((i) => Math.abs(a.data[at + i] - b.data[at + i]) > kRounding));
}

/** Checks of a picture, for `view`: more than `part` of it is surface; more than `part` of it is not as in another. */
export const isDrawn =
  (part = 0.12) =>
  (png) =>
    assert.ok(drawn(png).part > part, `drawn: ${drawn(png).part}`);
export const differsFrom = (other, part) => (png) =>
  assert.ok(difference(other, png) > part, `differs in ${difference(other, png)}`);

/** Part of the pixels of the yellow of a chosen triangle, which nothing else has. */
export function chosenPart({ data, ...png }) {
  return partWhere({ data, ...png }, (at) => data[at] - data[at + 2] > 85 && data[at + 1] - data[at + 2] > 50);
}

/** Part of the pixels of the purple of patches that were kept or reduced. */
export function stripedPart(png) {
  return partWhere(png, (at) => png.data[at + 2] - png.data[at + 1] > 60 && png.data[at] - png.data[at + 1] > 40);
}

/** Part of the pixels about as red, green and blue as that. */
export function partOf(png, [red, green, blue], tolerance = 12) {
  return partWhere(
    png,
    (at) =>
      Math.max(Math.abs(png.data[at] - red), Math.abs(png.data[at + 1] - green), Math.abs(png.data[at + 2] - blue)) <=
      tolerance,
  );
}

/** Numbers as the page writes them. */
export const shownNumber = (value) => new Intl.NumberFormat("en", { maximumSignificantDigits: 5 }).format(value);

/** Writes a part that was turned: an outline of [radius, height] around the z axis. Output: the path. */
export function turned(folder, name, outline, steps = 24) {
  const vertices = [];
  const rings = outline.map(([radius, height]) => {
    const first = vertices.length;
    const count = radius === 0 ? 1 : steps;
    for (let i = 0; i < count; ++i) {
      const angle = (2 * Math.PI * i) / steps;
      vertices.push([radius * Math.cos(angle), radius * Math.sin(angle), height]);
    }
    return (i) => first + (i % count);
  });
  const faces = [];
  for (let k = 1; k < rings.length; ++k) {
    for (let i = 0; i < steps; ++i) {
      const [below, above] = [rings[k - 1], rings[k]];
      faces.push([...new Set([below(i), below(i + 1), above(i + 1), above(i)])]);
    }
  }
  return folder.write(name, JSON.stringify({ vertices, faces }));
}

let axe = null;

/** What axe finds on a page. By way of the debugger, which the page's policy does not bind. */
export async function violations(page) {
  axe ??= readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
  if (!(await page.evaluate(() => "axe" in globalThis))) await page.evaluate(axe);
  const { violations: found } = await page.evaluate(() =>
    globalThis.axe.run(document, { resultTypes: ["violations"] }),
  );
  return found.map(
    ({ id, impact, nodes }) => `${impact} ${id}: ${nodes.map((node) => node.target.join(" ")).join(", ")}`,
  );
}
