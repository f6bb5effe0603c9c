// A program that openapi-typescript has given the types of the contract: node use.js URL
import assert from "node:assert/strict";
import { setTimeout as sleep } from "node:timers/promises";
import createClient from "openapi-fetch";
import type { components, paths } from "./api.js";

const client = createClient<paths>({ baseUrl: process.argv[2]! });
const square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
// The body is a file, and not the JSON that openapi-fetch would make of it.
const upload = {
  body: square,
  bodySerializer: (body: unknown) => body as string,
  headers: { "Content-Type": "model/obj" },
};

const capabilities = await client.GET("/v1/capabilities");
assert.ok(capabilities.data!.limits!.workers! > 0);

const query = { min_angle_deg: 25, format: "json" } as const;
const remeshed = await client.POST("/v1/remesh", { params: { query }, ...upload });
assert.equal(remeshed.response.status, 200);

const job = await client.POST("/v1/jobs", upload);
assert.equal(job.response.status, 202);
const path = { id: job.data!.id };
let state: components["schemas"]["Job"]["state"] = "queued";
while (state !== "succeeded") {
  await sleep(50);
  state = (await client.GET("/v1/jobs/{id}", { params: { path } })).data!.state;
}
const result = await client.GET("/v1/jobs/{id}/result", { params: { path }, parseAs: "text" });
assert.match(result.data as string, /^# remeshd/);
assert.equal((await client.DELETE("/v1/jobs/{id}", { params: { path } })).response.status, 204);

const missing = await client.GET("/v1/jobs/{id}", { params: { path: { id: "0".repeat(32) } } });
assert.equal(missing.error!.code, "not_found");
