import { type Surface, SurfaceBuilder, UnreadableMesh } from "./surface.ts";

interface JsonMesh {
  vertices?: unknown;
  faces?: unknown;
}

/** `{"vertices": [[x, y, z], ...], "faces": [[i, j, k, ...], ...]}`, alone or as the member `mesh`. */
export function readJson(bytes: Uint8Array): Surface {
  const document = JSON.parse(new TextDecoder().decode(bytes)) as { mesh?: JsonMesh } & JsonMesh;
  return surfaceOfJson(document.mesh ?? document);
}

export function surfaceOfJson(mesh: JsonMesh): Surface {
  if (!Array.isArray(mesh.vertices) || !Array.isArray(mesh.faces)) {
    throw new UnreadableMesh("It has no vertices and faces.");
  }
  const surface = new SurfaceBuilder();
  for (const point of mesh.vertices as number[][]) surface.addPoint(point[0]!, point[1]!, point[2]!);
  for (const face of mesh.faces as number[][]) {
    for (const corner of face) surface.addCorner(corner);
    surface.endFace();
  }
  return surface.finish();
}
