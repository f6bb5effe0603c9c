// Holds docker/ against Kubernetes' own schemas, against itself, and against the daemon, without a cluster:
//   node check.mjs FOLDER SETTINGS METRICS
// FOLDER is docker/, SETTINGS a file with what `remeshd --print-config` says, METRICS one with the names of what it counts,
// one a line. Prints what is wrong.
import fs from "node:fs";
import path from "node:path";
import * as core from "kubernetes-models/v1";
import * as apps from "kubernetes-models/apps/v1";
import * as autoscaling from "kubernetes-models/autoscaling/v2";
import * as networking from "kubernetes-models/networking.k8s.io/v1";
import * as policy from "kubernetes-models/policy/v1";
import YAML from "yaml";

const groups = {"v1": core, "apps/v1": apps, "autoscaling/v2": autoscaling, "networking.k8s.io/v1": networking, "policy/v1": policy};
const [folder, settingsFile, metricsFile] = process.argv.slice(2);
const readme = fs.readFileSync(path.join(folder, "README.md"), "utf8");
const metrics = new Set(fs.readFileSync(metricsFile, "utf8").split("\n"));
const settings = new Set(fs.readFileSync(settingsFile, "utf8").split("\n").map(
  (line) => "REMESHD_" + line.split("=")[0].replaceAll("-", "_").toUpperCase()));
settings.add("REMESHD_API_KEY");
let failures = 0;

function expect(condition, text) {
  if (condition) return;
  failures += 1;
  console.log(`FAILED: ${text}`);
}

// The schemas let unknown keys pass, so that a misspelt one would be lost. But validating reads every key that is known: what
// nobody has looked at is unknown.
function watched(value, place, unread) {
  if (value === null || typeof value !== "object") return value;
  const copy = Array.isArray(value) ? [] : {};
  for (const [key, item] of Object.entries(value)) {
    copy[key] = watched(item, `${place}/${key}`, unread);
    if (!Array.isArray(value)) unread.add(`${place}/${key}`);
  }
  return new Proxy(copy, {
    get(target, key, receiver) {
      unread.delete(`${place}/${String(key)}`);
      return Reflect.get(target, key, receiver);
    },
  });
}

function checkSchema(resource, file) {
  const Model = groups[resource.apiVersion]?.[resource.kind];
  expect(Model, `${file}: there is no ${resource.kind} in ${resource.apiVersion}`);
  if (!Model) return;
  const unread = new Set();
  const content = watched(resource, "", unread);
  try {
    Model.prototype.validate.call(Object.setPrototypeOf(content, Model.prototype));
  } catch (error) {
    expect(false, `${file}: ${error.message}`);
  }
  const read = [...unread].filter((place) => ![...unread].some((other) => place.startsWith(`${other}/`)));
  expect(read.length === 0, `${file}: unknown keys: ${read.join(" ")}`);
}

function checkEnvironment(names, file) {
  for (const name of names.filter((candidate) => candidate.startsWith("REMESHD_"))) {
    expect(settings.has(name), `${file}: the daemon has no setting ${name}`);
  }
}

const kubernetes = path.join(folder, "kubernetes");
const resources = {};
for (const file of fs.readdirSync(kubernetes)) {
  const document = YAML.parse(fs.readFileSync(path.join(kubernetes, file), "utf8"));
  resources[file] = document;
  if (document.kind !== "Kustomization") checkSchema(document, file);
}

// What refers to each other.
const kustomization = resources["kustomization.yaml"];
for (const file of kustomization.resources) expect(file in resources, `kustomization.yaml names ${file}`);
const deployment = resources["deployment.yaml"];
const pod = deployment.spec.template;
const container = pod.spec.containers[0];
const ports = new Set(container.ports.map((port) => port.name));
const matches = (selector, file) => {
  for (const [key, value] of Object.entries(selector)) {
    expect(pod.metadata.labels[key] === value, `${file} selects ${key}=${value}, which no pod has`);
  }
};
matches(deployment.spec.selector.matchLabels, "deployment.yaml");
matches(resources["service.yaml"].spec.selector, "service.yaml");
matches(resources["pdb.yaml"].spec.selector.matchLabels, "pdb.yaml");
matches(resources["networkpolicy.yaml"].spec.podSelector.matchLabels, "networkpolicy.yaml");
for (const port of resources["service.yaml"].spec.ports) expect(ports.has(port.targetPort), `service.yaml: port ${port.targetPort}`);
for (const rule of resources["networkpolicy.yaml"].spec.ingress) {
  for (const port of rule.ports) expect(ports.has(port.port), `networkpolicy.yaml: port ${port.port}`);
}
for (const file of ["hpa.yaml", "hpa-queue.yaml"]) {
  const target = resources[file].spec.scaleTargetRef;
  expect(target.kind === deployment.kind && target.name === deployment.metadata.name, `${file} scales ${target.name}`);
}
const metric = resources["hpa-queue.yaml"].spec.metrics[0].external.metric.name;
expect(metrics.has(metric), `hpa-queue.yaml: the daemon has no metric ${metric}`);
const watchedMetrics = [...readme.matchAll(/^\|.*?\|/gm)].flatMap(([cell]) => cell.match(/remeshd_[a-z_]+/g) ?? []);
expect(watchedMetrics.length > 0, "README.md: no metric to watch");
for (const name of watchedMetrics) expect(metrics.has(name), `README.md: the daemon has no metric ${name}`);
// What a cluster pulls is what the steps push.
const [image] = kustomization.images;
expect(container.image === image.name, `kustomization.yaml renames ${image.name}, the pods have ${container.image}`);
for (const step of ["docker build .* -t", "docker push"]) {
  const line = new RegExp(`^${step} ${image.newName}:${image.newTag}( \\.)?$`, "m");
  expect(line.test(readme), `README.md: no "${step} ${image.newName}:${image.newTag}"`);
}
for (const probe of ["livenessProbe", "readinessProbe"]) {
  const {path: asked, port} = container[probe].httpGet;
  expect(["/livez", "/readyz"].includes(asked) && ports.has(port), `deployment.yaml: ${probe} asks ${asked} at ${port}`);
}
expect(container.readinessProbe.httpGet.path === "/readyz", "deployment.yaml: readiness");
expect(container.livenessProbe.httpGet.path === "/livez", "deployment.yaml: liveness");
const mounts = new Set(container.volumeMounts.map((mount) => mount.name));
for (const volume of pod.spec.volumes) expect(mounts.has(volume.name), `deployment.yaml: the volume ${volume.name} is not mounted`);
expect(mounts.size === pod.spec.volumes.length, "deployment.yaml: every mount has its volume");
checkEnvironment(container.env.map((variable) => variable.name), "deployment.yaml");
for (const variable of container.env) {
  const reference = variable.valueFrom?.secretKeyRef;
  if (!reference) continue;
  const secret = resources["secret.example.yaml"];
  expect(secret.metadata.name === reference.name && reference.key in secret.stringData, `the secret has no ${reference.key}`);
}
const drain = Number(fs.readFileSync(settingsFile, "utf8").match(/^drain-time=(\d+)s$/m)[1]);
const sleep = Number(container.lifecycle.preStop.exec.command[1]);
expect(pod.spec.terminationGracePeriodSeconds > drain + sleep + 3, "deployment.yaml: the grace is too short to drain");

// Compose files: their syntax is checked by docker-compose itself.
for (const file of fs.readdirSync(folder).filter((name) => name.startsWith("compose"))) {
  const compose = YAML.parse(fs.readFileSync(path.join(folder, file), "utf8"));
  const service = compose.services.remeshd;
  checkEnvironment(Object.keys(service.environment ?? {}), file);
  const grace = Number.parseInt(service.stop_grace_period ?? "99", 10);
  expect(grace > drain, `${file}: the grace is too short to drain`);
  for (const volume of Object.values(compose.services).flatMap((one) => one.volumes ?? [])) {
    const [source] = volume.split(":");
    const isThere = source.startsWith("./") ? fs.existsSync(path.join(folder, source)) : source in (compose.volumes ?? {});
    expect(isThere, `${file}: there is no ${source}`);
  }
}
console.log(failures === 0 ? "deployments: nothing wrong" : `deployments: ${failures} wrong`);
process.exit(failures === 0 ? 0 : 1);
