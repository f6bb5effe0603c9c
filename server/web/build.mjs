// Builds the page into a folder and, for the daemon, into a C++ source.
// Usage: node build.mjs OUTPUT_FOLDER [OUTPUT.cpp]
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const [folder, source] = process.argv.slice(2);
if (!folder) throw new Error("usage: node build.mjs OUTPUT_FOLDER [OUTPUT.cpp]");

/** Files beyond this would make the page slow to come. */
const kMostBytes = 300_000;

const files = [];
// Names change with contents, so that browsers may keep them for ever.
function add(name, extension, type, bytes) {
  const hash = createHash("sha256").update(bytes).digest("hex").slice(0, 12);
  // The page refers to it relatively, so that it works below any path that a proxy gives it.
  const link = `assets/${name}-${hash}.${extension}`;
  files.push({ path: `/${link}`, type, bytes, isFixed: true });
  return link;
}

async function bundle(entry, define = {}, format = "iife") {
  const result = await build({
    entryPoints: [join(here, "src", entry)],
    bundle: true,
    minify: true,
    write: false,
    format,
    target: "es2022",
    legalComments: "none",
    define,
    absWorkingDir: here,
    logLevel: "warning",
  });
  return result.outputFiles[0].contents;
}

const text = "text/javascript; charset=utf-8";
const worker = add("worker", "js", text, await bundle("worker.ts"));
const app = add("app", "js", text, await bundle("main.ts", { WORKER_FILE: JSON.stringify(worker) }));
const docs = add("docs", "js", text, await bundle("docs/main.ts", {}, "esm"));
async function addStyle(name) {
  const css = await build({
    entryPoints: [join(here, `${name}.css`)],
    bundle: true,
    minify: true,
    write: false,
    target: "es2022",
  });
  return add(name, "css", "text/css; charset=utf-8", css.outputFiles[0].contents);
}
const links = {
  APP_FILE: app,
  DOCS_FILE: docs,
  STYLE_FILE: await addStyle("style"),
  DOCS_STYLE_FILE: await addStyle("docs"),
  FAVICON_FILE: add("favicon", "svg", "image/svg+xml", readFileSync(join(here, "favicon.svg"))),
  "<!-- KEY_DIALOG -->": readFileSync(join(here, "key_dialog.html"), "utf8").trim(),
};
function addPage(path, name) {
  const html = readFileSync(join(here, name), "utf8").replace(/"\w+_FILE"|<!-- KEY_DIALOG -->/g, (word) =>
    word[0] === '"' ? `"${links[word.slice(1, -1)]}"` : links[word],
  );
  files.unshift({ path, name, type: "text/html; charset=utf-8", bytes: Buffer.from(html), isFixed: false });
}
addPage("/docs", "docs.html");
addPage("/", "index.html");
for (const file of files) file.packed = gzipSync(file.bytes, { level: 9 });

rmSync(folder, { recursive: true, force: true });
mkdirSync(join(folder, "assets"), { recursive: true });
for (const { path, name, bytes } of files) writeFileSync(join(folder, name ?? path), bytes);

const total = files.reduce((sum, { packed }) => sum + packed.length, 0);
for (const { path, bytes, packed } of files) console.log(`${path}: ${bytes.length} bytes, ${packed.length} packed`);
console.log(`all: ${total} bytes packed`);
if (total > kMostBytes) throw new Error(`the page has more than ${kMostBytes} bytes`);

// As numbers, since compilers need not take string literals above 65,536 characters.
function bytesOf(buffer) {
  const lines = [];
  for (let at = 0; at < buffer.length; at += 32) lines.push(`    ${[...buffer.subarray(at, at + 32)].join(",")},`);
  return lines.join("\n");
}

if (source) {
  const arrays = files.map(({ packed }, i) => `constexpr unsigned char kFile${i}[] = {\n${bytesOf(packed)}\n};`);
  const entries = files.map(
    ({ path, type, packed, isFixed }, i) =>
      `    {"${path}", "${type}", {reinterpret_cast<const char*>(kFile${i}), ${packed.length}}, /*is_packed=*/true, /*is_fixed=*/${isFixed}},`,
  );
  writeFileSync(
    source,
    `// Made by server/web/build.mjs.
#include "server/web_page.h"

namespace remesh::server {
namespace {

${arrays.join("\n")}

}  // namespace

std::vector<WebFile> web_files() {
  return {
${entries.join("\n")}
  };
}

}  // namespace remesh::server
`,
  );
}
