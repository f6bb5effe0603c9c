// The parts of an OpenAPI document that the reference shows.

export interface Schema {
  $ref?: string;
  description?: string;
  type?: string | string[];
  properties?: Record<string, Schema>;
  required?: string[];
  additionalProperties?: boolean | Schema;
  items?: Schema;
  allOf?: Schema[];
  oneOf?: Schema[];
  if?: Schema;
  then?: Schema;
  else?: Schema;
  enum?: unknown[];
  const?: unknown;
  default?: unknown;
  minimum?: number;
  exclusiveMinimum?: number;
  maximum?: number;
  minItems?: number;
  maxItems?: number;
  format?: string;
  pattern?: string;
  contentMediaType?: string;
}
export interface Parameter {
  name: string;
  in: "path" | "query" | "header";
  required?: boolean;
  description?: string;
  schema: Schema;
  example?: unknown;
}
export interface Media {
  schema?: Schema;
  example?: unknown;
  examples?: Record<string, { summary: string; value: unknown }>;
}
export interface Body {
  description?: string;
  content: Record<string, Media>;
}
export interface Answer {
  description: string;
  headers?: Record<string, Reference | { description?: string }>;
  content?: Record<string, Media>;
}
interface Reference {
  $ref: string;
}
export interface Operation {
  operationId: string;
  tags: string[];
  summary: string;
  description?: string;
  parameters?: (Reference | Parameter)[];
  requestBody?: Reference | Body;
  responses: Record<string, Reference | Answer>;
}
type Path = { parameters?: (Reference | Parameter)[] } & Partial<Record<Method, Operation>>;
const kMethods = ["get", "post", "delete"] as const;
export type Method = (typeof kMethods)[number];

export interface Document {
  info: { version: string; description: string };
  tags: { name: string; description: string }[];
  paths: Record<string, Path>;
  components: { schemas: Record<string, Schema> };
}

/** An operation with what its path adds to it. */
export interface Placed {
  operation: Operation;
  method: Method;
  path: string;
  parameters: Parameter[];
  body: Body | null;
}

export class Contract {
  constructor(readonly document: Document) {}

  /** What a reference stands for; anything else stands for itself. */
  follow<T extends object>(node: T | Reference): T {
    if (!("$ref" in node)) return node;
    const steps = (node.$ref as string).replace(/^#\//, "").split("/");
    const found = steps.reduce<unknown>((at, step) => (at as Record<string, unknown>)[step], this.document);
    return this.follow(found as T);
  }

  get operations(): Placed[] {
    return Object.entries(this.document.paths).flatMap(([path, item]) =>
      kMethods.flatMap((method): Placed[] => {
        const operation = item[method];
        if (!operation) return [];
        const parameters = [...(item.parameters ?? []), ...(operation.parameters ?? [])];
        return [
          {
            operation,
            method,
            path,
            parameters: parameters.map((parameter) => this.follow<Parameter>(parameter)),
            body: operation.requestBody ? this.follow<Body>(operation.requestBody) : null,
          },
        ];
      }),
    );
  }
}
