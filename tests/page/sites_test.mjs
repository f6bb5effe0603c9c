// What pages of other sites can do to a daemon without an API key, in a real browser: nothing. And its own page works
// under every name and path that it is meant to have.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { eventually, root, startBrowser, startDaemon, temporaryFolder } from "./support.mjs";

const square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
let browser;
let foreign;
let folder;

/** A site whose pages are empty; it gives its port. */
async function startSite() {
  const server = createServer((_, answer) => answer.setHeader("Content-Type", "text/html").end("<!doctype html>"));
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return { port: server.address().port, stop: () => server.close() };
}

before(async () => {
  folder = temporaryFolder();
  foreign = await startSite();
  // All names lead to this machine, as those of an attacker may.
  browser = await startBrowser("--host-resolver-rules=MAP *.example 127.0.0.1");
});
after(async () => {
  await browser?.close();
  foreign?.stop();
  folder?.remove();
});

/** Opens a page of some address for the length of a test. */
async function withPage(url, use) {
  const page = await browser.newPage();
  try {
    const response = await page.goto(url, { waitUntil: "load" });
    return await use(page, response);
  } finally {
    await page.close();
  }
}

/** In a page: asks, and gives the status, or what kept the page from seeing it. */
function ask(page, url, options) {
  return page.evaluate(
    async (url, options) => {
      try {
        const response = await fetch(url, options);
        return response.type === "opaque" ? "opaque" : response.status;
      } catch (error) {
        return error.name;
      }
    },
    url,
    options,
  );
}

/** The routes that answered requests of the pages with success. */
async function served(daemon) {
  const metrics = await (await fetch(`${daemon.origin}/metrics`)).text();
  return [...metrics.matchAll(/^remeshd_http_requests_total{code="2\d\d",method="(\w+)",route="([^"]+)"}/gm)]
    .map(([, method, route]) => `${method} ${route}`)
    .filter((name) => name !== "GET /metrics");
}

test("a page of another site, or of another port, starts nothing and reads nothing", async (t) => {
  const daemon = await startDaemon("--store", "sqlite", "--state-dir", folder.path);
  t.after(() => daemon.stop());
  const { port } = new URL(daemon.origin);
  for (const site of ["evil.example", "localhost"]) {
    for (const host of ["localhost", "127.0.0.1"]) {
      const target = `http://${host}:${port}`;
      await withPage(`http://${site}:${foreign.port}/`, async (page) => {
        const post = { method: "POST", body: square };
        for (const path of ["/v1/remesh", "/v1/jobs", "/v1/analyze"]) {
          assert.equal(await ask(page, target + path, { ...post, mode: "no-cors" }), "opaque");
          assert.equal(await ask(page, target + path, post), "TypeError");
          assert.equal(
            await ask(page, target + path, { ...post, headers: { "X-Request-Id": "0123456789abcdef" } }),
            "TypeError",
          );
        }
        for (const path of ["/", "/metrics", "/v1/capabilities", "/openapi.json"])
          assert.equal(await ask(page, target + path), "TypeError", `${path} is read`);
        const loads = await page.evaluate(
          (url) =>
            new Promise((resolve) => {
              const image = new Image();
              image.onload = () => resolve(true);
              image.onerror = () => resolve(false);
              image.src = url;
            }),
          `${target}/v1/capabilities`,
        );
        assert.equal(loads, false);
        // A form needs no permission to be sent, and its answer replaces the page.
        const [answer] = await Promise.all([
          page.waitForNavigation(),
          page.evaluate((url) => {
            const form = document.createElement("form");
            form.method = "post";
            form.enctype = "multipart/form-data";
            form.action = url;
            const mesh = document.createElement("textarea");
            mesh.name = "mesh";
            mesh.value = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
            form.append(mesh);
            document.body.append(form);
            form.submit();
          }, `${target}/v1/jobs`),
        ]);
        assert.equal(answer.status(), 403);
      });
    }
  }
  assert.deepEqual(await served(daemon), []);
});

test("a name that leads here only for a while is not answered", async (t) => {
  const daemon = await startDaemon("--store", "none");
  t.after(() => daemon.stop());
  await withPage(`http://rebound.example:${new URL(daemon.origin).port}/`, async (page, response) => {
    assert.equal(response.status(), 421);
    for (const path of ["/", "/metrics", "/v1/capabilities"]) assert.equal(await ask(page, path), 421, path);
    assert.equal(await ask(page, "/v1/remesh", { method: "POST", body: square }), 421);
  });
  assert.deepEqual(await served(daemon), []);
});

/** The page loads, asks for what the daemon can do, and gets a mesh. */
async function expectWorkingPage(url) {
  await withPage(url, async (page, response) => {
    assert.equal(response.status(), 200, url);
    await eventually(async () =>
      assert.match(await page.$eval("#version", (element) => element.textContent), /\d/, `no version at ${url}`),
    );
    assert.equal(await ask(page, "v1/remesh", { method: "POST", body: square }), 200, url);
    assert.equal(await ask(page, "v1/requests/0123456789abcdef", { method: "DELETE" }), 404, url);
  });
}

test("the daemon's own page works by name and by address", async (t) => {
  const daemon = await startDaemon("--store", "none");
  const other = await startDaemon("--bind", "[::1]:0", "--store", "none");
  t.after(() => [daemon, other].forEach((one) => one.stop()));
  const { port } = new URL(daemon.origin);
  for (const url of [`http://localhost:${port}/`, `http://127.0.0.1:${port}/`, `${other.origin}/`])
    await expectWorkingPage(url);
});

test("a page of an allowed origin may ask and read", async (t) => {
  const origin = `http://tool.example:${foreign.port}`;
  const daemon = await startDaemon("--store", "none", "--cors-origin", origin);
  t.after(() => daemon.stop());
  await withPage(`${origin}/`, async (page) => {
    const headers = { "X-Request-Id": "0123456789abcdef" };
    assert.equal(await ask(page, `${daemon.origin}/v1/remesh`, { method: "POST", body: square, headers }), 200);
    assert.equal(await ask(page, `${daemon.origin}/v1/capabilities`), 200);
  });
});

/** A program that is installed, or unpacked by `./dev setup`; nothing if it is not there. */
function findProgram(name) {
  const folders = [
    join(root, "build/unpacked/usr/bin"),
    join(root, "build/unpacked/usr/sbin"),
    "/usr/bin",
    "/usr/sbin",
  ];
  return folders.map((path) => join(path, name)).find(existsSync);
}

async function freePort() {
  const site = await startSite();
  site.stop();
  return site.port;
}

/** Runs a proxy until the test ends. */
async function startProxy(t, program, options, url) {
  const child = spawn(program, options, {
    stdio: "ignore",
    env: { ...process.env, XDG_DATA_HOME: folder.path, XDG_CONFIG_HOME: folder.path },
  });
  t.after(() => child.kill());
  await eventually(() => fetch(url));
}

const flags = ["--store", "none", "--allowed-hosts", "mesh.example"];

test("the page works behind Caddy, under another name and below a path", async (t) => {
  const caddy = findProgram("caddy");
  if (!caddy) return t.skip("SKIPPED: there is no caddy (./dev setup unpacks one)");
  const daemon = await startDaemon(...flags);
  t.after(() => daemon.stop());
  const port = await freePort();
  const upstream = new URL(daemon.origin).host;
  const file = join(folder.path, "Caddyfile");
  const sites = `handle_path /mesh/* {\n reverse_proxy ${upstream}\n}\nhandle {\n reverse_proxy ${upstream}\n}\n`;
  writeFileSync(file, `{\n admin off\n auto_https off\n}\nhttp://mesh.example:${port} {\n${sites}}\n`);
  await startProxy(t, caddy, ["run", "--adapter", "caddyfile", "--config", file], `http://127.0.0.1:${port}/`);
  await expectWorkingPage(`http://mesh.example:${port}/`);
  await expectWorkingPage(`http://mesh.example:${port}/mesh/`);
});

test("the page works behind nginx, under another name and below a path", async (t) => {
  const nginx = findProgram("nginx");
  if (!nginx) return t.skip("SKIPPED: there is no nginx (./dev setup unpacks one)");
  const daemon = await startDaemon(...flags);
  t.after(() => daemon.stop());
  const port = await freePort();
  const file = join(folder.path, "nginx.conf");
  const paths = ["client_body", "proxy", "fastcgi", "uwsgi", "scgi"].map(
    (kind) => `${kind}_temp_path ${folder.path}/${kind};`,
  );
  writeFileSync(
    file,
    `${process.getuid() === 0 ? "user root;" : ""} daemon off; pid ${folder.path}/nginx.pid; error_log stderr; events {}
    http {
      access_log off; ${paths.join(" ")} proxy_set_header Host $http_host;
      server {
        listen 127.0.0.1:${port};
        location / { proxy_pass ${daemon.origin}; }
        location /mesh/ { proxy_pass ${daemon.origin}/; }
      }
    }`,
  );
  await startProxy(t, nginx, ["-e", "stderr", "-p", folder.path, "-c", file], `http://127.0.0.1:${port}/livez`);
  await expectWorkingPage(`http://mesh.example:${port}/`);
  await expectWorkingPage(`http://mesh.example:${port}/mesh/`);
});
