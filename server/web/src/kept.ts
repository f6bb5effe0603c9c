// The mesh and the options, kept in this browser alone, so that they are there after a reload.

const kName = "remeshd";
const kStore = "kept";
const kKey = "last";
/** Larger files are not kept: writing them would be felt at every choice. */
const kLargestFile = 200_000_000;

export interface Kept {
  file: Blob;
  name: string;
  query: [string, string][];
}

function ask<T>(request: IDBRequest<T>): Promise<T> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error ?? new Error("The browser keeps nothing."));
  });
}

async function store(mode: IDBTransactionMode): Promise<IDBObjectStore> {
  const opening = indexedDB.open(kName, 1);
  opening.onupgradeneeded = () => opening.result.createObjectStore(kStore);
  return (await ask(opening)).transaction(kStore, mode).objectStore(kStore);
}

/** A browser that keeps nothing, as in a private window, is no fault: then nothing is there after a reload. */
async function tried<T>(act: () => Promise<T>): Promise<T | null> {
  try {
    return await act();
  } catch {
    return null;
  }
}

export async function keep(file: File, query: [string, string][]): Promise<void> {
  if (file.size > kLargestFile) return forget();
  await tried(async () => ask((await store("readwrite")).put({ file, name: file.name, query } satisfies Kept, kKey)));
}
export async function forget(): Promise<void> {
  await tried(async () => ask((await store("readwrite")).delete(kKey)));
}
export async function recall(): Promise<{ file: File; query: [string, string][] } | null> {
  const kept = await tried(async () => (await ask((await store("readonly")).get(kKey))) as Kept | undefined);
  return kept ? { file: new File([kept.file], kept.name), query: kept.query } : null;
}
