// The second thread: reads files and answers and makes them ready to be drawn, so that the page never stands still.
import { type Deviation, deviationOf } from "./mesh/deviation.ts";
import { Draft, type Drawable, type Patches } from "./mesh/drawable.ts";
import { readMesh } from "./mesh/read.ts";
import { surfaceOfJson } from "./mesh/read_json.ts";
import { UnreadableMesh } from "./mesh/surface.ts";
import { type FaceLabels, labelsOf } from "./mesh/face_labels.ts";
import type { Answer, Report } from "./service/types.ts";

export interface Opened {
  drawable: Drawable;
  points: number;
  faces: number;
  minAngle: number;
  size: [number, number, number];
}
export interface Answered {
  report: Report;
  after: Drawable;
  /** The first mesh's `values`, now with its patches. */
  before: Float32Array | null;
  /** For each output face the input face under its centroid. */
  source: Uint32Array;
  labels: FaceLabels[];
}
export type Task =
  | { kind: "open"; file: Blob }
  | { kind: "answer"; body: Blob }
  | { kind: "deviation"; before: Float32Array; after: Float32Array };
export type Reply = { id: number } & (
  | { opened: Opened }
  | { answered: Answered }
  | { deviation: Deviation }
  | { failure: string; isUnreadable: boolean }
);

let input: Draft | null = null;

async function open(file: Blob): Promise<Opened> {
  input = null;
  const draft = new Draft(await readMesh(new Uint8Array(await file.arrayBuffer())));
  input = draft;
  return {
    drawable: draft.drawable(null),
    points: draft.pointCount,
    faces: draft.faces,
    minAngle: draft.minAngle,
    size: draft.size,
  };
}

async function answer(body: Blob): Promise<Answered> {
  const { mesh, report } = JSON.parse(await body.text()) as Answer;
  const kept = new Set(report.patches.filter((patch) => patch.status !== "remeshed").map((patch) => patch.id));
  const surfaceOf = report.patches.map((patch) => patch.surface);
  const patches = (ofFace: Patches["ofFace"]): Patches => ({ ofFace, kept, surfaceOf });
  const after = new Draft(surfaceOfJson(mesh), input?.frame ?? null).drawable(patches(mesh.face_patch));
  const before = mesh.input_face_patch && input ? input.values(patches(mesh.input_face_patch)) : null;
  return { report, after, before, source: Uint32Array.from(mesh.face_source), labels: labelsOf(mesh) };
}

function buffersOf(value: object): ArrayBuffer[] {
  return Object.values(value)
    .filter((item): item is Float64Array<ArrayBuffer> => ArrayBuffer.isView(item))
    .map((array) => array.buffer);
}

async function reply(id: number, task: Task): Promise<void> {
  try {
    if (task.kind === "open") {
      const opened = await open(task.file);
      postMessage({ id, opened } satisfies Reply, { transfer: buffersOf(opened.drawable) });
    } else if (task.kind === "deviation") {
      const deviation = deviationOf(task.before, task.after);
      postMessage({ id, deviation } satisfies Reply, { transfer: buffersOf(deviation) });
    } else {
      const answered = await answer(task.body);
      postMessage({ id, answered } satisfies Reply, {
        transfer: [...buffersOf(answered.after), ...buffersOf(answered)],
      });
    }
  } catch (error) {
    const failure = error instanceof Error ? error.message : String(error);
    postMessage({ id, failure, isUnreadable: error instanceof UnreadableMesh } satisfies Reply);
  }
}

addEventListener("message", (event: MessageEvent<{ id: number; task: Task }>) => {
  void reply(event.data.id, event.data.task);
});
