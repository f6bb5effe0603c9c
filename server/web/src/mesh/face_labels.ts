// Objects, groups and materials of an answer's faces.
import type { AnswerMesh } from "../service/types.ts";

export const kLabels = ["object", "group", "material"] as const;
export type LabelKind = (typeof kLabels)[number];

export interface FaceLabels {
  kind: LabelKind;
  names: string[];
  /** Of each face of the result an index of a name. */
  after: ArrayLike<number>;
  /** Of each patch; -1 where its faces have several, as they may without barriers. */
  ofPatch: ArrayLike<number>;
}

/** Output: those kinds that the mesh has. */
export function labelsOf({ labels, face_groups: groups, face_patch: patches }: AnswerMesh): FaceLabels[] {
  const found = kLabels.flatMap((kind) => {
    const label = labels?.[kind];
    return label ? [{ kind, names: label.names, after: label.of_face }] : [];
  });
  // Groups whose names are numbers.
  if (groups) {
    const names = [...new Set(groups)].sort((a, b) => a - b);
    const place = new Map(names.map((name, i) => [name, i]));
    found.push({ kind: "group", names: names.map(String), after: groups.map((group) => place.get(group)!) });
  }
  return found.map((label) => ({ ...label, ofPatch: byPatch(patches, label.after) }));
}

function byPatch(patches: readonly number[], labels: ArrayLike<number>): Int32Array {
  let count = 0;
  for (const patch of patches) count = Math.max(count, patch + 1);
  const kUnseen = -2;
  const ofPatch = new Int32Array(count).fill(kUnseen);
  patches.forEach((patch, f) => {
    ofPatch[patch] = ofPatch[patch] === kUnseen || ofPatch[patch] === labels[f] ? labels[f]! : -1;
  });
  return ofPatch;
}
