import { Scanner } from "./scanner.ts";
import { type Surface, SurfaceBuilder, UnreadableMesh } from "./surface.ts";

const kSizes: Record<string, number> = {
  char: 1,
  int8: 1,
  uchar: 1,
  uint8: 1,
  short: 2,
  int16: 2,
  ushort: 2,
  uint16: 2,
  int: 4,
  int32: 4,
  uint: 4,
  uint32: 4,
  float: 4,
  float32: 4,
  double: 8,
  float64: 8,
};

interface Property {
  name: string;
  type: string;
  /** Of a list. */
  countType: string | null;
}
interface Element {
  name: string;
  count: number;
  properties: Property[];
}
type Next = (type: string) => number;

export function readPly(bytes: Uint8Array): Surface {
  const scanner = new Scanner(bytes);
  const { format, elements } = readHeader(scanner);
  const next = format === "ascii" ? textNumbers(scanner) : binaryNumbers(bytes, scanner.at, format.includes("little"));
  const surface = new SurfaceBuilder();
  for (const element of elements) readElement(element, next, surface);
  return surface.finish();
}

function readHeader(scanner: Scanner): { format: string; elements: Element[] } {
  let format = "";
  const elements: Element[] = [];
  while (!scanner.isAtEnd) {
    const words = scanner.line().split(/\s+/);
    if (words[0] === "format") format = words[1] ?? "";
    else if (words[0] === "element") elements.push({ name: words[1] ?? "", count: Number(words[2]), properties: [] });
    else if (words[0] === "property") {
      const isList = words[1] === "list";
      const type = words[isList ? 3 : 1] ?? "";
      const countType = isList ? (words[2] ?? "") : null;
      if (!(type in kSizes) || (countType !== null && !(countType in kSizes))) {
        throw new UnreadableMesh(`The header has the unknown type ${type}.`);
      }
      elements.at(-1)?.properties.push({ name: words[isList ? 4 : 2] ?? "", type, countType });
    } else if (words[0] === "end_header") return { format, elements };
  }
  throw new UnreadableMesh("The header has no end.");
}

function textNumbers(scanner: Scanner): Next {
  return () => {
    if (!scanner.hasMore()) throw new UnreadableMesh("The file ends too early.");
    return scanner.number();
  };
}

function binaryNumbers(bytes: Uint8Array, begin: number, isLittle: boolean): Next {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  let at = begin;
  return (type) => {
    const here = at;
    at += kSizes[type]!;
    if (at > view.byteLength) throw new UnreadableMesh("The file ends too early.");
    switch (type) {
      case "char":
      case "int8":
        return view.getInt8(here);
      case "uchar":
      case "uint8":
        return view.getUint8(here);
      case "short":
      case "int16":
        return view.getInt16(here, isLittle);
      case "ushort":
      case "uint16":
        return view.getUint16(here, isLittle);
      case "int":
      case "int32":
        return view.getInt32(here, isLittle);
      case "uint":
      case "uint32":
        return view.getUint32(here, isLittle);
      case "float":
      case "float32":
        return view.getFloat32(here, isLittle);
      default:
        return view.getFloat64(here, isLittle);
    }
  };
}

function readElement(element: Element, next: Next, surface: SurfaceBuilder): void {
  const isVertex = element.name === "vertex";
  const isFace = element.name === "face";
  const axes = element.properties.map((property) => ["x", "y", "z"].indexOf(property.name));
  const point = [NaN, NaN, NaN];
  for (let i = 0; i < element.count; ++i) {
    for (let p = 0; p < element.properties.length; ++p) {
      const { name, type, countType } = element.properties[p]!;
      if (countType === null) {
        const value = next(type);
        if (isVertex && axes[p]! >= 0) point[axes[p]!] = value;
        continue;
      }
      const isCorners = isFace && (name === "vertex_indices" || name === "vertex_index");
      for (let left = next(countType); left > 0; --left) {
        const value = next(type);
        if (isCorners) surface.addCorner(value);
      }
      if (isCorners) surface.endFace();
    }
    if (isVertex) surface.addPoint(point[0]!, point[1]!, point[2]!);
  }
}
