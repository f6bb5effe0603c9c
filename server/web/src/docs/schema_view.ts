import { type Child, h } from "../ui/dom.ts";
import type { Schema } from "./contract.ts";
import { prose } from "./prose.ts";

const nameOf = (ref: string): string => ref.slice(ref.lastIndexOf("/") + 1);
const words = (values: unknown[]): string => values.map((value) => String(value)).join(", ");

/** The type in words; named schemas are links. */
function typeOf(schema: Schema): Child[] {
  if (schema.$ref) return [h("a", { href: `#schema-${nameOf(schema.$ref)}` }, nameOf(schema.$ref))];
  if (schema.oneOf) return schema.oneOf.flatMap((one, i) => [i > 0 && " or ", ...typeOf(one)]);
  if (schema.items) return ["array of ", ...typeOf(schema.items)];
  return [[schema.type ?? []].flat().join(" or ")];
}

/** What the value has to keep to. */
export function boundsOf(schema: Schema): string {
  const { minimum, exclusiveMinimum, maximum, minItems, maxItems } = schema;
  return [
    schema.const !== undefined && `always ${String(schema.const)}`,
    schema.enum && `one of ${words(schema.enum)}`,
    minimum !== undefined && `at least ${minimum}`,
    exclusiveMinimum !== undefined && `above ${exclusiveMinimum}`,
    maximum !== undefined && `at most ${maximum}`,
    minItems !== undefined && minItems === maxItems && `${minItems} items`,
    minItems !== undefined && minItems !== maxItems && `at least ${minItems} items`,
    maxItems !== undefined && minItems !== maxItems && `at most ${maxItems} items`,
    schema.format && `as ${schema.format}`,
    schema.pattern && `matches ${schema.pattern}`,
    schema.default !== undefined && `${String(schema.default)} if left out`,
  ]
    .filter(Boolean)
    .join("; ");
}

/** The type and the bounds, in one line. */
export function summaryOf(schema: Schema, isRequired = false): HTMLElement {
  const bounds = boundsOf(schema);
  return h("span", { class: "muted" }, ...typeOf(schema), bounds && `; ${bounds}`, isRequired && "; required");
}

function member(name: string, schema: Schema, isRequired: boolean): HTMLElement {
  return h(
    "div",
    { class: "member" },
    h("dt", {}, h("code", {}, name), " ", summaryOf(schema, isRequired)),
    h("dd", {}, ...prose(schema.description), ...inside(schema)),
  );
}

/** `if` with the members that are there then. */
function condition(schema: Schema): HTMLElement {
  const asked = Object.entries(schema.if?.properties ?? {}).map(
    ([name, { const: value, enum: values }]) => `${name} is ${values ? words(values) : String(value)}`,
  );
  const members = words(schema.then?.required ?? []);
  const otherwise = schema.else?.required ? `; otherwise ${words(schema.else.required)}` : "";
  return h("p", {}, `If ${asked.join(" and ")}: ${members}${otherwise} are there.`);
}

/** What a value of this schema is made of. */
export function inside(schema: Schema): HTMLElement[] {
  const { properties = {}, required = [], additionalProperties, items, allOf = [], oneOf = [] } = schema;
  const members = Object.entries(properties).map(([name, one]) => member(name, one, required.includes(name)));
  if (typeof additionalProperties === "object") members.push(member("any other name", additionalProperties, false));
  return [
    ...(members.length > 0 ? [h("dl", { class: "members" }, ...members)] : []),
    ...(items && !items.$ref ? inside(items) : []),
    ...[...allOf, ...oneOf].flatMap((part) => {
      if (part.if) return [condition(part)];
      return part.$ref
        ? [h("p", {}, ...(allOf.includes(part) ? ["All of ", ...typeOf(part)] : typeOf(part)))]
        : inside(part);
    }),
  ];
}

export function schemaView(name: string, schema: Schema): HTMLElement {
  return h(
    "section",
    { id: `schema-${name}`, class: "schema", tabindex: "-1" },
    h("h3", {}, name),
    h("p", {}, summaryOf(schema)),
    ...prose(schema.description),
    ...inside(schema),
  );
}
