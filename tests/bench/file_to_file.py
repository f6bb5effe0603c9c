"""Parts `io` and `way`: reading and writing beside other readers, and the whole way beside CGAL's."""

import json
import statistics

from programs import face_count, median, peak_bytes, seconds

CGAL_BYTES_A_FACE = 182


def milliseconds_of_io(bench, path, runs):
    times_of = json.loads(bench.run(bench.program("io_bench"), path, str(runs)).output)
    return {what: statistics.median(times) for what, times in times_of.items()}


def measure_io(bench, table):
    for name in ["box", "bracket"]:
        ms = milliseconds_of_io(bench, bench.input(name, bench.faces), bench.runs)
        loop, events = ms["from_chars loop"], ms["nlohmann-json, events"]
        case = f"{name}, text"
        table.add(case, "loop on std::from_chars", loop, "ms")
        table.add(case, "tinyobjloader", ms["tinyobjloader"], "ms", "the loop", loop)
        table.add(case, "OBJ in, one thread", ms["read_obj, 1 thread"], "ms", "the loop", loop, 1.5)
        table.add(case, "OBJ in, two threads", ms["read_obj, 2 threads"], "ms", "one thread",
                  ms["read_obj, 1 thread"], 1)
        table.add(case, "OBJ out, one thread", ms["write_obj, 1 thread"], "ms", "the loop", loop, 3)
        table.add(case, "OBJ out, two threads", ms["write_obj, 2 threads"], "ms", "one thread",
                  ms["write_obj, 1 thread"], 1)
        table.add(case, "nlohmann-json's events", events, "ms")
        table.add(case, "JSON in", ms["read_json"], "ms", "the events", events, 0.4)


def measure_way(bench, table):
    for name in ["box", "bracket"]:
        path = bench.input(name, bench.faces)
        faces = face_count(path)
        works = {
            "remesh": lambda: bench.remesh(path, "--refine", "false"),
            "reading": lambda: milliseconds_of_io(bench, path, 1)["tinyobjloader"] / 1000,
        }
        has_peer = bench.program("planar_peer").exists()
        if has_peer:
            works["CGAL"] = lambda: bench.run(bench.program("planar_peer"), path, bench.folder / "peer.obj")
        results = bench.by_turns(works)
        ours = results["remesh"]
        reading = statistics.median(results["reading"])
        between = median(lambda run: run.milliseconds_between_files(), ours)
        case = f"{name}, {faces:,} faces, file to file"
        table.add(case, "tinyobjloader reads", reading, "s")
        table.add(case, "remesh, two threads", seconds(ours), "s", "reading alone", reading, 0.5)
        table.add(case, "remesh, memory", peak_bytes(ours) / faces, "bytes a face",
                  f"{CGAL_BYTES_A_FACE} bytes a face", CGAL_BYTES_A_FACE, 1)
        peer = "CGAL remesh_planar_patches"
        if not has_peer:
            table.leave_out(case, peer, "CGAL 5.6 or newer could not be had")
            continue
        theirs = results["CGAL"]
        process = median(lambda run: json.loads(run.output)["process_ms"], theirs)
        table.add(case, peer, seconds(theirs), "s", "reading alone", reading)
        table.add(case, f"{peer}, memory", peak_bytes(theirs) / faces, "bytes a face")
        table.add(case, f"{peer}, without reading and writing", process, "ms")
        table.add(case, "remesh", seconds(ours), "s", "CGAL's", seconds(theirs), 0.25)
        table.add(case, "remesh, memory", peak_bytes(ours) / faces, "bytes a face", "CGAL's",
                  peak_bytes(theirs) / faces, 1)
        table.add(case, "remesh, without reading and writing", between, "ms", "CGAL's", process, 1)
