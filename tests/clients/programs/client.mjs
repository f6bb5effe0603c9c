// Node's fetch, undici, axios and got as clients. README.md in this folder describes the commands.
import { createHash } from "node:crypto";
import { createReadStream, readFileSync } from "node:fs";
import http from "node:http";
import { Readable } from "node:stream";
import { setTimeout as sleep } from "node:timers/promises";

const MEDIA_TYPE = "model/obj";

async function load(name) {
  try {
    return await import(name);
  } catch {
    console.log(`SKIPPED: Node has no ${name} here`);
    return null;
  }
}

// Each client makes a function of one connection, which sends a body and gives the status and the bytes of the answer.
// A client that takes a FormData of the web has `form`.
const CLIENTS = {
  async fetch() {
    return {
      form: true,
      connect: () => async (url, body, headers) => {
        const options = { method: "POST", body, headers, duplex: "half" };
        const answer = await fetch(url, options);
        return [answer.status, Buffer.from(await answer.arrayBuffer())];
      },
    };
  },
  async undici() {
    const undici = await load("undici");
    return (
      undici && {
        connect() {
          const dispatcher = new undici.Agent({ connections: 1 });
          return async (url, body, headers) => {
            const answer = await undici.request(url, { method: "POST", body, headers, dispatcher });
            return [answer.statusCode, Buffer.from(await answer.body.arrayBuffer())];
          };
        },
      }
    );
  },
  async axios() {
    const axios = await load("axios");
    return (
      axios && {
        form: true,
        connect() {
          const client = axios.default.create({
            httpAgent: new http.Agent({ keepAlive: true, maxSockets: 1 }),
            responseType: "arraybuffer",
            maxRedirects: 0,
            validateStatus: () => true,
          });
          return async (url, body, headers) => {
            const answer = await client.post(url, body, { headers });
            return [answer.status, Buffer.from(answer.data)];
          };
        },
      }
    );
  },
  async got() {
    const got = await load("got");
    return (
      got && {
        form: true,
        connect() {
          const client = got.got.extend({
            agent: { http: new http.Agent({ keepAlive: true, maxSockets: 1 }) },
            responseType: "buffer",
            throwHttpErrors: false,
            retry: { limit: 0 },
          });
          return async (url, body, headers) => {
            const answer = await client.post(url, { body, headers });
            return [answer.statusCode, answer.body];
          };
        },
      }
    );
  },
};

async function report(name, request) {
  try {
    const [status, body] = await request();
    console.log(`${name} | ${status} | ${createHash("sha256").update(body).digest("hex")}`);
  } catch (error) {
    console.log(`${name} | lost | ${error.code ?? ""} ${error.message} ${error.cause ?? ""}`.replaceAll("\n", " "));
  }
}

async function upload(name, client, url, path) {
  const mesh = readFileSync(path);
  const send = client.connect();
  await report(`${name}, whole`, () => send(url, mesh, { "Content-Type": MEDIA_TYPE }));
  await report(`${name}, stream`, () => send(url, createReadStream(path), { "Content-Type": MEDIA_TYPE }));
  if (client.form) {
    const form = new FormData();
    form.append("mesh", new Blob([mesh]), "part.obj");
    await report(`${name}, form`, () => send(url, form, {}));
  }
}

async function pause(name, client, url, path, seconds, rounds, connections) {
  const mesh = readFileSync(path);
  async function use() {
    const send = client.connect();
    for (let round = 0; round <= rounds; ++round) {
      await sleep(round === 0 ? 0 : seconds * 1000);
      await report(`${name}, pause`, () => send(url, mesh, { "Content-Type": MEDIA_TYPE }));
    }
  }
  await Promise.all(Array.from({ length: connections }, use));
}

async function* slowly(size, rate) {
  const began = performance.now();
  for (let sent = 0; sent < size; ) {
    await sleep(Math.max(0, began + (sent / rate) * 1000 - performance.now()));
    const piece = Buffer.alloc(Math.min(65536, size - sent), "#");
    sent += piece.length;
    yield piece;
  }
}

async function early(name, client, url, size, rate) {
  const body = Readable.from(slowly(size, rate), { objectMode: false });
  await report(`${name}, stream`, () => client.connect()(url, body, { "Content-Type": MEDIA_TYPE }));
}

const [command, url, ...rest] = process.argv.slice(2);
const commands = {
  upload: (name, client) => upload(name, client, url, rest[0]),
  pause: (name, client) => pause(name, client, url, rest[0], ...rest.slice(1).map(Number)),
  early: (name, client) => early(name, client, url, ...rest.map(Number)),
};
await Promise.all(
  Object.entries(CLIENTS).map(async ([name, make]) => {
    const client = await make();
    if (client) await commands[command](name, client);
  }),
);
process.exit(0); // Kept connections would keep the program alive.
