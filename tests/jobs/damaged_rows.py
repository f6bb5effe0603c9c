"""Ways to damage one job's row or its blobs, as far as the tables allow them.

A damaged job is made by one transaction, so that no worker sees it whole. What it holds besides the damage is that of a
job that waits, runs, or has ended.
"""

import collections

MAX = 2**63 - 1
MAX_INT = 2**31 - 1
# The largest numbers that do not count as damaged, see kDamagedJob in server/jobs/schema.h.
LARGEST = 9 * 10**15

# `columns` differ from those of a sound row. `blobs` is a list of (kind, part, data, file, size), in which None stands for what a
# sound job has. All values are SQL.
Damage = collections.namedtuple("Damage", "name state columns blobs")


def text(value):
    return "'" + value.replace("'", "''") + "'"


class Writer:
    """Writes jobs into a store of either kind, behind the back of its daemons."""

    def __init__(self, store, mesh, done):
        """`mesh` - the bytes of a sound input; `done` - the id of a job that has succeeded."""
        self.store, self.mesh, self.done = store, mesh, done

    def bytes(self, value):
        return f"'\\x{value.hex()}'::bytea" if self.store.postgres else f"x'{value.hex()}'"

    def sound_columns(self, job_id, state):
        def same(column):
            return f"(SELECT {column} FROM remeshd_job WHERE id = '{self.done}')"
        columns = {"id": text(job_id), "owner": "''", "state": text(state), "turn": same("turn"), "memory": "1000",
                   "request": same("request"), "created_ms": same("created_ms"), "queued_ms": same("created_ms"),
                   "stored": str(len(self.mesh))}
        if state == "running":
            columns.update({"token": "1", "attempts": "1", "worker": "'somebody.1'", "stage": "'read'", "version": "2",
                            "started_ms": same("created_ms"), "lease_ms": same("created_ms"), "lease_length_ms": "1000"})
        if state not in ("queued", "running"):
            columns.update({"token": "1", "attempts": "1", "commits": "1", "stage": "'done'", "fraction": "1",
                            "started_ms": same("created_ms"), "finished_ms": same("created_ms"),
                            "expires_ms": f"{same('created_ms')} + 3600000"})
        if state in ("failed", "cancelled"):
            columns.update({"problem_status": "422", "problem": text('{"status":422,"code":"empty_mesh"}'), "stored": "0"})
        return columns

    def write(self, jobs):
        """Writes jobs, each an id and its damage, in one transaction."""
        self.store.change([statement for job_id, damage in jobs for statement in self.statements(job_id, damage)])

    def statements(self, job_id, damage):
        columns = {**self.sound_columns(job_id, damage.state), **damage.columns}
        statements = [f"INSERT INTO remeshd_job ({', '.join(columns)}) VALUES ({', '.join(columns.values())})"]
        blobs = damage.blobs
        if blobs is None:
            blobs = SOUND_RESULT if damage.state == "succeeded" else SOUND_INPUT if damage.state in ("queued", "running") else []
        for kind, part, data, file, size in blobs:
            statements.append(self.blob(job_id, kind, part, data, file, size))
        return statements

    def blob(self, job_id, kind, part, data, file, size):
        sound = f"SELECT {{}} FROM remeshd_blob WHERE job = '{self.done}' AND kind = '{kind}' AND part = 0"
        if data is None:
            data = self.bytes(self.mesh) if kind == "input" else f"({sound.format('data')})"
        elif isinstance(data, bytes):
            data = self.bytes(data)
        if size is None:
            size = len(self.mesh) if kind == "input" else f"({sound.format('size')})"
        return f"INSERT INTO remeshd_blob (job, kind, part, data, file, size) VALUES ('{job_id}', '{kind}', {part}, {data}, " \
               f"{file}, {size})"


def blob(kind, part=0, data=None, file="NULL", size=None):
    return (kind, part, data, file, size)


SOUND_INPUT = [blob("input")]
SOUND_RESULT = [blob("mesh"), blob("report")]


def damages(is_sqlite):
    """All kinds of damage that a store of this kind allows."""
    kinds = []

    def add(phase, label, blobs=None, **columns):
        kinds.append(Damage(f"{phase}: {label}", phase, {column: str(value) for column, value in columns.items()}, blobs))

    # Numbers.
    for column, values in {"memory": (-1, 0, LARGEST, MAX, -MAX), "token": (-1, LARGEST, MAX), "version": (-1, 0, LARGEST, MAX),
                           "attempts": (-5, 3, 1_000_000, MAX_INT), "commits": (-1, 1, MAX_INT),
                           "turn": (MAX, -MAX, LARGEST, -LARGEST),
                           "created_ms": (0, -1, MAX, -MAX), "queued_ms": (-MAX, MAX, "NULL"), "stored": (-5, MAX, "NULL"),
                           "started_ms": (MAX,), "finished_ms": (-MAX,), "expires_ms": (0, MAX), "fraction": (-1, 1e308),
                           "problem_status": (-1, MAX_INT), "lease_ms": (MAX,), "lease_length_ms": (-1, MAX)}.items():
        for value in values:
            add("queued", f"{column} = {value}", **{column: value})
    # States and texts.
    for value in ("", "dreaming", "QUEUED", "queued ", "it's\n\"quoted\""):
        add("queued", f"state {value!r}", state=text(value))
    for value in ("", "no JSON", "{}", "[]", "null", "5", '"text"', '{"query":[["max_edge_length"', '{"query":5}', '{"query":[5]}',
                  '{"query":[["a","b","c"]]}', '{"query":[["unknown_option","1"]]}', '{"content_type":[]}', "[" * 100_000,
                  '{"query":' + "[" * 100_000, "x" * 1_000_000):
        add("queued", f"request {value[:30]!r} of {len(value)}", request=text(value))
    add("queued", "stage and worker of other kinds", stage=text("\x01 \u2028"), worker=text("w" * 10_000))
    add("queued", "an owner who is nobody", owner=text("\ufffd" * 100))
    add("queued", "a problem, although it waits", problem=text("no JSON"), problem_status=200)
    # Inputs.
    for name, blobs in {
            "missing": [], "its first piece missing": [blob("input", 131)], "a number below 0": [blob("input", -1)],
            "the last number of all": [blob("input", MAX_INT)], "a gap": [blob("input"), blob("input", MAX_INT)],
            "a piece twice": [blob("input"), blob("input", 1)], "size too large": [blob("input", size=10**6)],
            "size too small": [blob("input", size=1)], "size below 0": [blob("input", size=-1)],
            "size at its maximum": [blob("input", size=MAX)], "no size": [blob("input", size="NULL")],
            "no data": [blob("input", data="NULL")], "empty data": [blob("input", data=b"")],
            "nothing at all": [blob("input", data="NULL", size="NULL")], "no mesh": [blob("input", data=b"\xff" * 40, size=40)],
            "a file": [blob("input", file="'00/no.input'")], "a file above": [blob("input", file="'../../../etc/passwd'")],
            "a blob of a kind that is none": [blob("input"), blob("dream", data=b"x", size=1)],
            "a result already": [blob("input"), *SOUND_RESULT], "a report already": [blob("input"), blob("report", 7)]}.items():
        add("queued", f"input: {name}", blobs)
    # Jobs that run, and whose worker is nobody.
    for column, values in {"lease_ms": ("NULL", 0, MAX), "lease_length_ms": ("NULL", 0, -1, MAX), "token": (MAX, -1, 0),
                           "version": (MAX, LARGEST), "attempts": (3, -1, MAX_INT), "started_ms": ("NULL", MAX),
                           "queued_ms": (MAX,), "turn": (MAX,), "memory": (-1,)}.items():
        for value in values:
            add("running", f"{column} = {value}", **{column: value})
    # Results.
    for name, blobs in {
            "missing": [], "no mesh": [blob("report")], "no report": [blob("mesh")], "mesh empty": [blob("mesh", data=b"", size=0), blob("report")],
            "mesh that is none": [blob("mesh", data=b"\xff" * 200, size=200), blob("report")],
            "mesh of zeros": [blob("mesh", data=b"\0" * 200, size=200), blob("report")],
            "mesh of text": [blob("mesh", data=b"{}" * 100, size=200), blob("report")],
            "mesh too large": [blob("mesh", size=MAX), blob("report")], "mesh too small": [blob("mesh", size=1), blob("report")],
            "mesh below 0": [blob("mesh", size=-1), blob("report")], "mesh in two": [blob("mesh"), blob("mesh", 1), blob("report")],
            "report that is no JSON": [blob("mesh"), blob("report", data=b"no JSON \xff", size=9)],
            "report empty": [blob("mesh"), blob("report", data=b"", size=0)], "a file": [blob("mesh", file="'no'"), blob("report")],
            "an input still": [*SOUND_RESULT, *SOUND_INPUT]}.items():
        add("succeeded", f"result: {name}", blobs)
    for column, values in {"expires_ms": ("NULL", 0, MAX, -MAX), "finished_ms": ("NULL", MAX, -MAX), "stored": (MAX, -1), "commits": (0,),
                           "problem_status": (500,), "attempts": (0, MAX_INT), "token": (MAX,), "version": (MAX,)}.items():
        for value in values:
            add("succeeded", f"{column} = {value}", **{column: value})
    # Failures.
    for status in (0, 1, 200, 204, 304, 600, -1, MAX_INT):
        add("failed", f"status {status}", problem_status=status)
    for value in ("", "no JSON", "[]", "null", "{}", '{"code":5}', '{"code":"' + "x" * 100_000 + '"}', "[" * 100_000, "x\r\ny"):
        add("failed", f"problem {value[:20]!r} of {len(value)}", problem=text(value))
    add("failed", "neither status nor problem", problem_status=0, problem="''")
    add("failed", "it never expires", expires_ms="NULL")
    add("cancelled", "neither status nor problem", problem_status=0, problem="''")
    add("expired", "a result still", SOUND_RESULT)
    if not is_sqlite:
        for value in ("NaN", "Infinity", "-Infinity"):
            add("queued", f"fraction {value}", fraction=text(value))
            add("running", f"fraction {value}", fraction=text(value))
        return kinds
    # SQLite stores anything in any column.
    for column in ("memory", "token", "attempts", "commits", "version", "turn", "created_ms", "queued_ms", "started_ms", "stored",
                   "fraction", "problem_status"):
        for value in ("'text'", "1.5", "x'00ff'"):
            add("queued", f"{column} = {value}", **{column: value})
    for column in ("finished_ms", "expires_ms", "stored", "problem_status"):
        for value in ("'text'", "1.5", "x'00ff'"):
            add("succeeded", f"{column} = {value}", **{column: value})
    for column in ("owner", "state", "request", "stage", "worker", "problem"):
        add("queued", f"{column} as bytes", **{column: "x'ff00fe'"})
        add("queued", f"{column} as a number", **{column: 7})
    for column in ("problem", "stage"):
        add("failed", f"{column} as bytes", **{column: "x'ff00fe'"})
    add("queued", "infinite", fraction="9e999")
    add("running", "lease as text", lease_length_ms="'text'", lease_ms="'text'")
    for state in ("queued", "running", "succeeded"):
        add(state, "no id", id="NULL")
    add("queued", "input: size as text", [blob("input", size="'text'")])
    add("queued", "input: data as text", [blob("input", data="'v 0 0 0'", size=7)])
    add("queued", "input: data as a number", [blob("input", data="7", size=1)])
    add("queued", "input: part as text", [blob("input", part="'text'")])
    add("queued", "input: part as a fraction", [blob("input", part="0.5")])
    add("succeeded", "result: size as text", [blob("mesh", size="'text'"), blob("report")])
    return kinds
