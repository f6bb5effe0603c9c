"""Compares the documents with what the two programs say of themselves: documents_test.py REMESHD REMESH

Options, formats, endpoints, settings, and the codes in a report stand in tables that people read, in the contract, and in the
code. An entry that stands in one place and not in the others is reported, so that nobody forgets one when something is added.
Defaults and ranges must be equal, no table may have an entry twice, and a flag or variable that a document mentions must exist.
What the documents say of results, such as a number of faces, is compared with a run.

Exit code: 0 - they agree; 1 - the differences are listed.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import urllib.error
import urllib.parse
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests" / "support"))
from remeshd import Daemon  # noqa: E402

# These defaults depend on the machine.
MACHINE = {"--workers", "--max-running", "--queue-size", "--memory-budget"}
# These flags of the daemon are no settings, since they end it.
ENDING = {"--help", "--version", "--print-config", "--check-config"}
# These are flags of other programs: curl, tsc, docker, systemctl, pip, Blender, PrusaSlicer.
FOREIGN = {"--data-binary", "--fail-with-body", "--info", "--no-build-isolation", "--noEmit", "--now", "--python-expr", "--rm",
           "--scale"}
# These variables are read by `docker/` or by tests, or are options of CMake.
OTHER_VARIABLES = {"REMESHD_API_KEY", "REMESHD_CORPUS", "REMESHD_DOMAIN", "REMESHD_REQUIRE_CORPUS", "REMESHD_TESTS",
                   "REMESHD_UNITY", "REMESHD_UPSTREAM", "REMESHD_WEB", "REMESHD_WERROR"}
# Numbers of faces in documents. A pattern tells where they stand; its group is the number, and its spaces stand for any
# white space. The run that must have as many faces is a mesh and options of `remesh`, or without options the mesh itself.
BRACKET = "tests/data/bracket.obj"
FACES = (
    ("README.md", r"before and after: ([\d,]+) irregular triangles", (BRACKET,)),
    ("README.md", r"triangles, and ([\d,]+) with 16 edges per full turn", (BRACKET, "--elements-per-circle=16")),
    ("core/README.md", r"one bracket, ([\d,]+) triangles", (BRACKET,)),
)
# The documents that a newcomer reads, whose commands and numbers are all run.
FOR_NEWCOMERS = ("README.md", "api/README.md", "server/README.md", "docker/README.md", "server/web/README.md")
# How their commands begin. Those that `e2e.readme` runs have no reason; for others, it is said why nothing runs them, or what
# does.
COMMANDS = {
    "curl ": None,
    "job=$(curl ": None,
    "remesh ": None,
    "build/release/remesh ": None,
    "build/release/remeshd --bind 0.0.0.0:8080 ": "e2e.requests has a daemon with keys; this one would be open to the network",
    "openssl rand ": "e2e.readme writes a key itself",
    "./dev serve": "it installs packages and does not end; tools.dev has its help, and all tests build what it builds",
    "gmsh ": "e2e.step",
    "docker build ": "it needs an engine and a registry; the test deployment reads the files",
    "docker compose ": "the same",
    "docker run ": "the same",
    "docker push ": "the same",
    "REMESHD_API_KEY=$(openssl rand -hex 24) REMESHD_DOMAIN=mesh.example.org docker compose ": "the same",
    "POSTGRES_PASSWORD=$(openssl rand -hex 24) docker compose ": "the same",
    "cp docker/kubernetes/secret.example.yaml ": "the test deployment compares the secret with what refers to it",
    "kubectl ": "it needs a cluster; the test deployment holds the files against Kubernetes' schemas",
    "promtool ": "deployment.monitoring",
}
# Numbers of faces there that no run has: what they are instead.
OTHER_NUMBERS = {
    ("README.md", "32 facets"): "the bound of elements_per_circle=auto",
    ("api/README.md", "32 facets"): "the same",
    ("api/README.md", "32.5 facets"): "the same, as a turn",
    ("api/README.md", "20 faces"): "a bound of min_edge_length=auto",
    ("api/README.md", "40 faces"): "the same with proximity",
    ("api/README.md", "5 faces"): "an example of arithmetic",
    ("api/README.md", "10,000 triangles"): "the largest input whose faces an analysis counts",
    ("api/README.md", "50 million faces"): "the default of --max-output-faces, which the table of settings has",
    ("server/web/README.md", "200,000 faces"): "the size of the mesh of ./dev page-million",
}
failures = []


def expect_equal(found, expected, what):
    """Compares two collections of names, of which the first may have none twice."""
    found = list(found)
    for name in sorted({name for name in found if found.count(name) > 1}, key=str):
        failures.append(f"{what}: {name} stands there twice")
    for name in sorted(set(expected) - set(found), key=str):
        failures.append(f"{what}: {name} is missing")
    for name in sorted(set(found) - set(expected), key=str):
        failures.append(f"{what}: there is no {name}")


def documents():
    """The Markdown files of the repository."""
    found = []
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [name for name in folders if name not in ("build", "node_modules") and not name.startswith(".")]
        found += [str((pathlib.Path(folder) / name).relative_to(ROOT)) for name in names if name.endswith(".md")]
    return sorted(found)


def section(path, heading):
    """The lines of a document under a heading, up to the next heading of any level."""
    lines = (ROOT / path).read_text(encoding="utf-8").split("\n")
    begin = lines.index(heading) + 1
    end = next((i for i in range(begin, len(lines)) if re.match(r"#+ ", lines[i])), len(lines))
    return lines[begin:end]


def tables(lines):
    """The tables among some lines, each as rows of cells, without their heads."""
    found, rows = [], None
    for line in [*lines, ""]:
        if not line.startswith("|"):
            if rows:
                found.append(rows)
            rows = None
        elif re.match(r"\|( *-+ *\|)+$", line):
            rows = []
        elif rows is not None:
            rows.append([cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]])
    return found


def code_spans(cell):
    return re.findall(r"`([^`]+)`", cell)


def get(daemon, path):
    with urllib.request.urlopen(f"http://127.0.0.1:{daemon.port}{path}", timeout=120) as answer:
        return json.load(answer)


def refusal_of(daemon, path, body):
    """What the daemon has against a request, or "" if it answers with a result."""
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{daemon.port}{path}", data=body, timeout=120):
            return ""
    except urllib.error.HTTPError as error:
        return json.load(error)["detail"]


def output_of(*command):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("REMESHD_")}
    return subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout


def settings_of(program):
    lines = output_of(program, "--print-config").splitlines()
    return {f"--{name}": value for name, value in (line.split("=", 1) for line in lines)}


def flags_of_help(text):
    """Each flag that a help describes, with what stands behind it on its line."""
    return dict(re.findall(r"^ +(?:-\w,)?(--[a-z][a-z0-9-]*)(.*)$", text, re.MULTILINE))


def number(text):
    try:
        return float(text)
    except ValueError:
        return None


def check_options(capabilities, contract):
    lines = section("api/README.md", "## Options")
    groups = tables(lines)
    rows = [row for group in groups for row in group]
    options = {option["name"]: option for option in capabilities["options"]}
    # Each group has a table. The name of the group stands above it.
    titles = [match.group(1).lower() for line in lines if (match := re.match(r"\*\*(\w+)\*\*: ", line))]
    found = [(title, name) for title, group in zip(titles, groups) for row in group for name in code_spans(row[0])]
    expected = [(option["group"], option["name"]) for option in capabilities["options"]]
    if found != expected:
        failures.append(f"api/README.md, tables of options: they are {found}, not {expected}")
    expect_equal(contract["components"]["schemas"]["Options"]["properties"], options, "api/openapi.yaml, schema Options")
    expect_equal([name for row in rows for name in code_spans(row[0])], options, "api/README.md, table of options")
    for row in rows:
        described = [options[name] for name in code_spans(row[0]) if name in options]
        # One default stands for all options of a row: they exclude each other.
        defaults = [option["default"] for option in described if option["default"] is not None]
        words = re.split(r"[\s()]+", row[1].replace("`", ""))
        for default in defaults:
            text = str(default).lower() if isinstance(default, bool) else str(default)
            if text not in words and all(number(word) != number(text) or number(word) is None for word in words):
                failures.append(f"api/README.md, {row[0]}: the default is {text}, not {row[1]}")
        if not defaults and (number(words[0]) is not None or words[0] in ("true", "false")):
            failures.append(f"api/README.md, {row[0]}: there is no default, but {row[1]}")
        for option in described:
            text = words_of_range(option)
            if text and not re.search(rf"(?<![\d.]){re.escape(text)}(?![\d.]*\d)", row[2]):
                failures.append(f"api/README.md, option {option['name']}: its range is {text}, which {row[2]!r} does not say")


def words_of_range(option):
    """The range of an option in the words of the documents, or "" where it goes without saying."""
    low, above, high = (option.get(bound) for bound in ("minimum", "exclusive_minimum", "maximum"))
    if high is not None:
        return f"{low:g} to {high:,.0f}" if high >= 10_000 else f"{low:g} to {high:g}"
    if above:
        return f"above {above:g}"
    return f"at least {low:g}" if low and option["type"] == "number" else ""


def rows_of_formats(read, written):
    """The table of formats, as it follows from what the daemon says of them."""
    rows = []
    reads, writes = ({form["name"]: form for form in forms} for forms in (read, written))
    labels = {"none": "none", "one": "one [kind](api/README.md#names)", "all": "objects, groups, materials"}
    for name, form in (reads | writes).items():
        same = next((other for other, one in reads.items() if one["media_type"] == form["media_type"]), None)
        rows.append([f"`{name}`", " ".join(f"`.{ending}`" for ending in form["endings"]), f"`{form['media_type']}`",
                     reads[name]["about"] if name in reads else f"as `{same}`" if same else "no",
                     f"{form['about']}; {form['numbers']}s" if name in writes else "no",
                     labels[form["labels"]] if name in writes else ""])
    return rows


def expect_rows(path, heading, columns, wanted):
    """Holds a table, the one with so many columns, against the rows that it must have."""
    found = next((rows for rows in tables(section(path, heading)) if len(rows[0]) == columns), [])
    if found != wanted:
        text = "\n".join("| " + " | ".join(row).replace("|  |", "| |") + " |" for row in wanted)
        failures.append(f"{path}, {heading}: the table must have these rows:\n{text}")


def check_formats(capabilities, contract, twin):
    read, written = capabilities["formats"]["input"], capabilities["formats"]["output"]
    names = [form["name"] for form in written]
    types_read, types_written = {form["media_type"] for form in read}, {form["media_type"] for form in written}
    expect_rows("README.md", "## The service", 6, rows_of_formats(read, written))
    expect_rows("api/README.md", "### Programs", 4, [
        [f"`{form['name']}`", program["program"], program["takes"], "<br>".join(f"`{line}`" for line in program["lines"])]
        for form in written for program in form["programs"]])
    # The files that are told to people in other ways.
    help_lines = [line.split() for line in output_of(twin, "--help").splitlines()]
    for form in {form["name"]: form for form in read + written}.values():
        start = [form["name"], *(f".{ending}" for ending in form["endings"])]
        way = ("r" if form in read or form["name"] in [f["name"] for f in read] else "-") + ("w" if form["name"] in names else "-")
        if [*start, way] not in [line[: len(start) + 1] for line in help_lines]:
            failures.append(f"remesh --help: there is no line {' '.join([*start, way])}")
    groups = tables(section("api/README.md", "## Options"))
    format_row = next(row for group in groups for row in group if row[0] == "`format`")
    expect_equal(code_spans(format_row[2]), names, "api/README.md, option format")

    parts = contract["components"]
    choices = {"the parameter": parts["parameters"]["format"]["schema"]["enum"],
               "the member of Options": parts["schemas"]["Options"]["properties"]["format"]["enum"]}
    for where, choice in choices.items():
        expect_equal([name for name in choice if name not in ("auto", None)], names, f"api/openapi.yaml, format, {where}")
    for path, method in (("/v1/remesh", "post"), ("/v1/jobs/{id}/result", "get")):
        content = contract["paths"][path][method]["responses"]["200"]["content"]
        expect_equal(content, types_written, f"api/openapi.yaml, the types of {path}")
    body = parts["requestBodies"]["Mesh"]["content"]
    expect_equal([kind for kind in body if kind in types_written | types_read], types_read, "api/openapi.yaml, the types of a body")


def check_endpoints(contract):
    described = {f"{method.upper()} {path}" for path, item in contract["paths"].items() for method in item
                 if method in ("get", "post", "put", "patch", "delete")}
    table = set()
    for row in tables(section("README.md", "## The service"))[0]:
        method = "GET"
        for span in code_spans(row[0]):
            method, _, path = span.rpartition(" ") if " " in span else (method, "", span)
            table.add(f"{method} {path}")
    # The pages are for people; the contract is for programs.
    expect_equal(table - {"GET /", "GET /docs"}, described, "README.md, table of the service")

    routes = set()
    for source in sorted((ROOT / "server").rglob("*.cpp")):
        if "node_modules" in source.parts:
            continue
        text = source.read_text(encoding="utf-8")
        texts = dict(re.findall(r"std::string (\w+) = \"(/[^\"]*)\"", text))
        for method, path, name, rest in re.findall(
                r"\{\s*\"(GET|POST|PUT|PATCH|DELETE)\",\s*(?:\"(/[^\"]*)\"|(\w+)(?: \+ \"([^\"]*)\")?)\s*,", text):
            if path or name in texts:
                routes.add(f"{method} {path or texts[name] + rest}")
    expect_equal(routes - {"GET /"}, described, "the routes in server/, held against api/openapi.yaml")


def seconds(text):
    match = re.fullmatch(r"(\d+)(s|h)", text)
    return int(match.group(1)) * {"s": 1, "h": 3600}[match.group(2)] if match else text


def variable_of(flag):
    return "REMESHD_" + flag[2:].upper().replace("-", "_")


def check_settings(settings, described):
    rows = []
    for row in tables(section("server/README.md", "## Configuration"))[0]:
        flags = [name for name in code_spans(row[0]) if name.startswith("--")]
        defaults = row[1].replace("`", "").split(", ")
        rows += [(flag, defaults[i] if len(defaults) == len(flags) else row[1]) for i, flag in enumerate(flags)]
    expect_equal([flag for flag, _ in rows], settings, "server/README.md, table of settings")
    expect_equal(described, set(settings) | ENDING, "remeshd --help")
    table = dict(rows)
    for flag in sorted(set(described) & set(settings)):
        default = re.search(r"=(\S+)", described[flag].split("(Env:")[0])
        if flag not in MACHINE and default and default.group(1) != settings[flag]:
            failures.append(f"remeshd --help, {flag}: its default is {settings[flag]}, not {default.group(1)}")
        if f"(Env:{variable_of(flag)})" not in described[flag]:
            failures.append(f"remeshd --help, {flag}: its variable is not {variable_of(flag)}")
    about = "\n".join(section("server/README.md", "## Configuration"))
    for flag in sorted(ENDING - {"--version"}):
        if f"{flag}`" not in about:
            failures.append(f"server/README.md, Configuration: {flag} is missing")
    for flag in sorted(set(table) & set(settings) - MACHINE):
        if seconds(table[flag]) != seconds(settings[flag]):
            failures.append(f"server/README.md, {flag}: its default is {settings[flag]}, not {table[flag]}")


def check_mentions(settings, described):
    """What a document calls a flag or a variable exists: in one of the two programs, or in the scripts."""
    # CHANGELOG.md tells of what was.
    names = [name for name in documents() if name != "CHANGELOG.md"]
    scripts = [ROOT / "dev", *(ROOT / "tests/tools").glob("*.py"), *(ROOT / "tests/bench").glob("*.py"),
               *(ROOT / "tests/mutate").glob("*.cpp")]
    in_scripts = set(re.findall(r"--[a-z][a-z0-9-]*", "\n".join(p.read_text(encoding="utf-8") for p in scripts)))
    flags = set(described) | in_scripts | FOREIGN
    variables = {variable_of(flag) for flag in settings} | OTHER_VARIABLES
    for name in names:
        text = (ROOT / name).read_text(encoding="utf-8")
        for flag in sorted(set(re.findall(r"(?<![\w-])--[a-z][\w-]*", text)) - flags):
            failures.append(f"{name}: there is no {flag}")
        for variable in sorted(set(re.findall(r"\bREMESHD_[A-Z_]*[A-Z]\b", text)) - variables):
            failures.append(f"{name}: there is no {variable}")


def check_codes(contract):
    schemas = contract["components"]["schemas"]
    for heading, schema, member in (("### Reasons", "Unrefined", "reason"), ("## Diagnostics", "Diagnostic", "code")):
        codes = [code for row in tables(section("api/README.md", heading))[0] for code in code_spans(row[0])]
        expect_equal(codes, schemas[schema]["properties"][member]["enum"], f"api/README.md, {heading}")


def sources(folder):
    return "\n".join(p.read_text(encoding="utf-8") for p in sorted((ROOT / folder).rglob("*"))
                     if p.suffix in (".h", ".cpp") and "node_modules" not in p.parts)


def check_errors(contract):
    """Each code of an error is thrown in the folder that declares it, and the contract names those that there are."""
    for folder, header, enum in (("core", "core/base/error.h", "Code"), ("api", "api/request_code.h", "RequestCode")):
        body = re.search(rf"enum class {enum} \{{(.*?)\}};", (ROOT / header).read_text(encoding="utf-8"), re.DOTALL).group(1)
        used = set(re.findall(rf"(?<!case )\b{enum}::(k\w+)", re.sub(r"//.*", "", sources(folder))))
        for code in re.findall(r"^\s*(k\w+)", body, re.MULTILINE):
            if code not in used:
                failures.append(f"{header}: nothing in {folder}/ throws {code}")

    text = contract["components"]["responses"]["Problem"]["description"]
    described = [code for code in code_spans(text) if re.fullmatch(r"[a-z_]+", code)]
    # The contract calls the rest of these statuses the usual.
    usual = re.findall(r"\d+", text.rpartition(". ")[2])
    literals = set(re.findall(r"\"([a-z_]+)\"", "\n".join(sources(folder) for folder in ("core", "api", "server"))))
    for code in sorted(set(described) - literals):
        failures.append(f"api/openapi.yaml, Problem: nothing throws {code}")
    for status, code in sorted(set(re.findall(r"HttpError\((\d+), \"(\w+)\"", sources("server")))):
        if code not in described and status not in usual:
            failures.append(f"api/openapi.yaml, Problem: {status} {code} is missing")


def check_wishes(daemon, capabilities):
    """The daemon takes the options of the README's first table, and knows the codes of the second one."""
    lines = section("README.md", "# remeshd")
    wishes, refusals = tables(lines)
    names = {option["name"] for option in capabilities["options"]}
    mesh = (ROOT / "tests/data/octahedron.ply").read_bytes()
    for query in [span for row in wishes for span in code_spans(row[1]) if "=" in span]:
        for name, value in urllib.parse.parse_qsl(query, strict_parsing=True, keep_blank_values=True):
            if name not in names:
                failures.append(f"README.md, {query}: there is no option {name}")
        refusal = refusal_of(daemon, f"/v1/remesh?{query}", mesh)
        if refusal:
            failures.append(f"README.md, {query}: {refusal}")
    literals = set(re.findall(r"\"([a-z_]+)\"", "\n".join(sources(folder) for folder in ("core", "api", "server"))))
    for code in [span for row in refusals for span in code_spans(" ".join(row))]:
        if re.fullmatch(r"[a-z]+(_[a-z]+)+", code) and code not in literals | names:
            failures.append(f"README.md: there is no {code}")


def count_faces(twin, mesh, *options):
    if not options:
        return sum(line.startswith("f ") for line in (ROOT / mesh).read_text(encoding="utf-8").splitlines())
    with tempfile.TemporaryDirectory() as folder:
        result = pathlib.Path(folder) / "result.obj"
        output_of(twin, str(ROOT / mesh), "-o", str(result), *options)
        return sum(line.startswith("f ") for line in result.read_text(encoding="utf-8").splitlines())


def check_results(twin):
    """The numbers that the documents tell of results are those of a run."""
    known = {}
    for document, pattern, run in FACES:
        text = (ROOT / document).read_text(encoding="utf-8")
        told = re.findall(pattern.replace(" ", r"\s+"), text)
        if run not in known:
            known[run] = count_faces(twin, *run)
        if not told:
            failures.append(f"{document}: nothing reads like {pattern}")
        for faces in told:
            if int(faces.replace(",", "")) != known[run]:
                failures.append(f"{document}: {' '.join(run)} has {known[run]:,} faces, not {faces}")

    text = (ROOT / "api/README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```\w*\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    told = [block for block in blocks if block.startswith(BRACKET)]
    found = subprocess.run([twin, "--analyze", BRACKET], check=True, capture_output=True, text=True, cwd=ROOT).stdout
    if told != [found]:
        failures.append(f"api/README.md: remesh --analyze {BRACKET} prints\n{found}")


def check_commands():
    """Each command of a document for newcomers is run by a test, or it is told here why not."""
    begun = set()
    for document in FOR_NEWCOMERS:
        text = (ROOT / document).read_text(encoding="utf-8")
        for block in re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
            for line in re.sub(r"\s*\\\n\s*", " ", block).splitlines():
                for command in line.split(" && "):
                    known = [begin for begin in COMMANDS if command.startswith(begin)]
                    begun.update(known)
                    if not known:
                        failures.append(f"{document}: nothing runs {command}")
    for begin in sorted(set(COMMANDS) - begun):
        failures.append(f"tests/tools/documents_test.py: no document has a command {begin}")


def check_numbers():
    """Each number of faces in a document for newcomers is that of a run, or it is told here what it is."""
    found = set()
    for document in FOR_NEWCOMERS:
        text = (ROOT / document).read_text(encoding="utf-8")
        # What a program prints is compared as a whole, see check_results.
        prose = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
        run = {match for name, pattern, _ in FACES if name == document
               for match in re.findall(pattern.replace(" ", r"\s+"), prose)}
        for amount, kind in re.findall(r"\b(\d[\d,.]*)\s+((?:\w+\s+)?(?:faces|triangles|facets))\b", prose):
            phrase = f"{amount} {' '.join(kind.split())}"
            found.add((document, phrase))
            if amount not in run and (document, phrase) not in OTHER_NUMBERS:
                failures.append(f"{document}: no run has {phrase}")
    for document, phrase in sorted(set(OTHER_NUMBERS) - found):
        failures.append(f"tests/tools/documents_test.py: {document} has no {phrase}")


def main():
    program, twin = sys.argv[1:]
    with Daemon(program) as daemon:
        capabilities, contract = get(daemon, "/v1/capabilities"), get(daemon, "/openapi.json")
        check_wishes(daemon, capabilities)
    check_results(twin)
    check_options(capabilities, contract)
    check_formats(capabilities, contract, twin)
    check_endpoints(contract)
    settings, described = settings_of(program), flags_of_help(output_of(program, "--help"))
    check_settings(settings, described)
    check_mentions(settings, {**described, **flags_of_help(output_of(twin, "--help"))})
    check_codes(contract)
    check_errors(contract)
    check_commands()
    check_numbers()
    for failure in failures:
        print("FAILED:", failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
