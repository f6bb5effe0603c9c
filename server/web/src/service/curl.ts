/** As one word of a shell's line. */
export function shellWord(text: string): string {
  return /^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`;
}

/** The name of a result: `part.obj` as STL is `part-remeshed.stl`. */
export function resultName(file: string, ending: string): string {
  return `${file.replace(/\.gz$/i, "").replace(/\.[^.]*$/, "") || "mesh"}-remeshed.${ending}`;
}

/** The line that does what the page does. */
export function curlLine(
  page: string,
  file: string,
  query: [string, string][],
  format: string,
  ending: string,
  hasKey: boolean,
): string {
  const url = new URL("v1/remesh", page);
  // Commas and the like may stand in a query as they are, and read better.
  const parameters = [...query, ["format", format]].map(
    ([name, value]) => `${name}=${encodeURIComponent(value!).replaceAll("%2C", ",")}`,
  );
  return [
    "curl",
    "--fail-with-body",
    ...(hasKey ? ['-H "Authorization: Bearer $REMESHD_API_KEY"'] : []),
    `--data-binary ${shellWord(`@${file}`)}`,
    shellWord(`${url}?${parameters.join("&")}`),
    `-o ${shellWord(resultName(file, ending))}`,
  ].join(" ");
}
