// The API reference: what openapi.json says, with a form for each operation that sends it.
import { ServiceClient } from "../service/client.ts";
import { byId, h } from "../ui/dom.ts";
import { askForKey } from "../ui/key_dialog.ts";
import { type Answer, Contract, type Document, type Placed } from "./contract.ts";
import { prose } from "./prose.ts";
import { inside, schemaView, summaryOf } from "./schema_view.ts";
import { Trial } from "./trial.ts";

const service = new ServiceClient(askForKey);

function answersView(contract: Contract, { operation }: Placed): HTMLElement {
  const rows = Object.entries(operation.responses).map(([status, node]) => {
    const { description, headers = {}, content = {} } = contract.follow<Answer>(node);
    const media = Object.entries(content).map(([type, { schema }]) =>
      h("p", {}, h("code", {}, type), " ", schema && summaryOf(schema), ...(schema ? inside(schema) : [])),
    );
    const fields = Object.keys(headers);
    return h(
      "div",
      { class: "member" },
      h("dt", {}, h("code", {}, status)),
      h(
        "dd",
        {},
        ...prose(description),
        ...media,
        fields.length > 0 && h("p", { class: "muted" }, `With ${fields.join(", ")}.`),
      ),
    );
  });
  const statuses = Object.keys(operation.responses).join(", ");
  return h("details", {}, h("summary", {}, `Answers (${statuses})`), h("dl", { class: "members" }, ...rows));
}

const titleOf = ({ method, path }: Placed): HTMLElement[] => [
  h("span", { class: `method ${method}` }, method.toUpperCase()),
  h("code", {}, path),
];

function operationView(contract: Contract, placed: Placed, trial: Trial): HTMLElement {
  const { operationId, summary, description } = placed.operation;
  return h(
    "section",
    { id: `operation-${operationId}`, class: "operation", "aria-labelledby": `title-${operationId}`, tabindex: "-1" },
    h("h3", { id: `title-${operationId}` }, ...titleOf(placed)),
    h("p", { class: "summary" }, `${summary}.`),
    ...prose(description),
    trial.element,
    answersView(contract, placed),
  );
}

function show(document: Document): void {
  const contract = new Contract(document);
  const { info, tags, components } = document;
  byId("version").textContent = info.version;
  const operations = contract.operations;
  const sample = operations
    .map(({ body }) => body?.content["model/obj"]?.example)
    .find((example) => typeof example === "string");
  const trials = operations.map(
    (placed) =>
      new Trial(placed, service, String(sample), (id) => {
        for (const [i, trial] of trials.entries())
          if (operations[i]!.operation.tags.includes("jobs")) trial.setPath("id", id);
      }),
  );
  const groups = tags.map(({ name, description }) => ({
    name,
    description,
    members: operations.flatMap((placed, i) =>
      placed.operation.tags.includes(name) ? [{ placed, trial: trials[i]! }] : [],
    ),
  }));
  byId("contents").replaceChildren(
    ...groups.flatMap(({ name, members }) => [
      h("h2", {}, name),
      h(
        "ul",
        {},
        ...members.map(({ placed }) =>
          h("li", {}, h("a", { href: `#operation-${placed.operation.operationId}` }, ...titleOf(placed))),
        ),
      ),
    ]),
    h("h2", {}, "schemas"),
    h(
      "ul",
      {},
      ...Object.keys(components.schemas).map((name) => h("li", {}, h("a", { href: `#schema-${name}` }, name))),
    ),
  );
  byId("reference").replaceChildren(
    h("section", {}, ...prose(info.description)),
    ...groups.map(({ name, description, members }) =>
      h(
        "section",
        { class: "group" },
        h("h2", {}, name),
        ...prose(description),
        ...members.map(({ placed, trial }) => operationView(contract, placed, trial)),
      ),
    ),
    h(
      "section",
      { class: "group" },
      h("h2", {}, "schemas"),
      ...Object.entries(components.schemas).map(([name, schema]) => schemaView(name, schema)),
    ),
  );
  // What an address points at was not there when the browser looked for it.
  if (location.hash) globalThis.document.getElementById(location.hash.slice(1))?.scrollIntoView();
}

try {
  show((await (await service.ask("openapi.json")).json()) as Document);
} catch (error) {
  byId("reference").replaceChildren(h("p", { class: "notice" }, `The reference cannot be shown: ${String(error)}`));
}
