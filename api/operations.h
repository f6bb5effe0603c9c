/// The operations of the API as plain functions that take and return bytes and strings. They use no HTTP library, no
/// sockets and no log. The daemon and the command line both call them.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/run_control.h"
#include "core/io/formats.h"

namespace remesh::api {

using Fields = std::vector<std::pair<std::string, std::string>>;

/// The limits of the queue for a worker. Large requests are limited by their number. Small requests, with bodies up to
/// 1 MiB, are limited by the expected time of their work, so that hundreds of them may wait for a moment.
struct QueueLimits {
  std::size_t max_large = 0;                                            ///< requests; 0 until it is set
  std::uint64_t max_small_bytes = std::uint64_t{32} << 20;              ///< bytes of the bodies of all small requests
  std::chrono::milliseconds max_small_wait = std::chrono::seconds(60);  ///< the expected waiting time of small requests
};

/// The limits of a request, with their defaults. The daemon's settings change them, and /v1/capabilities reports them.
struct Limits {
  std::uint64_t max_body = 256ull << 20;   ///< bytes
  DecompressionLimits decompression = {};  ///< those of a compressed body, and of a compressed mesh in a body
  ReadLimits input = {};
  std::uint64_t max_output_faces = 50'000'000;
  int workers = 1;  ///< threads that one request may use
  /// The longest time that a request may compute. It also waits no longer than this for a worker.
  std::chrono::milliseconds request_timeout{300'000};
  QueueLimits queue = {};
  /// The limit for a request that names no `max_output_faces`, if it is below `max_output_faces`.
  std::uint64_t usual_output_faces = std::numeric_limits<std::uint64_t>::max();
  std::size_t serial_corners = 0;                           ///< see RunSettings
  std::function<void(const std::string&)> trace = nullptr;  ///< see RunSettings
};

/// One request, independent of HTTP. `query` has the pairs in their order, percent-decoded.
struct Request {
  std::string_view body;
  std::string content_type;      ///< as sent, may be empty
  std::string content_encoding;  ///< as sent, may be empty
  std::string accept;            ///< as sent, may be empty
  Fields query;
  std::function<void()> release_body = nullptr;  ///< called once the body has been read and is no longer needed
};

/// The amount of work that a request took, for metrics and the log.
struct WorkDone {
  std::uint64_t input_faces = 0;
  std::uint64_t output_faces = 0;                              ///< 0 for an analysis
  std::uint64_t remeshed = 0, reduced = 0, kept = 0;           ///< numbers of patches
  std::vector<std::pair<std::string_view, double>> stages_ms;  ///< only the stages that ran
};

/// An answer. `headers` are those besides Content-Type: Remesh-Summary, Server-Timing, Content-Disposition.
struct Response {
  int status = 200;
  std::string content_type;
  std::string body;
  Fields headers;
  std::optional<WorkDone> done = std::nullopt;
};

/// These functions do the whole of POST /v1/remesh and POST /v1/analyze: options, reading, the pipeline, writing.
/// Errors: remesh::Error, with any code.
Response run_remesh(const Request& request, const Limits& limits, RunControl& control);
Response run_analyze(const Request& request, const Limits& limits, RunControl& control);

/// Does the whole of POST /v1/compare: a form with the two meshes as its files `a` and `b`, and the option `tolerance`.
/// Errors: remesh::Error; if it is about one of the meshes, the message says which.
Response run_compare(const Request& request, const Limits& limits, RunControl& control);

/// The result of a remeshing whose answer is fetched later, in any format. See result_archive.
struct StoredRemesh {
  std::string mesh;    ///< the mesh in the format of result_archive
  std::string report;  ///< the report object as JSON
  WorkDone done;
};
/// Remeshes like run_remesh, but returns the result in the form to be stored.
/// Errors: as run_remesh.
StoredRemesh run_remesh_to_keep(const Request& request, const Limits& limits, RunControl& control);
/// Checks all parts of a request to remesh that can be refused before its mesh is read: the options, the form and the
/// media types.
/// Output: true if the mesh is JSON that is not compressed, so that `check_json` can check more.
/// Errors: as run_remesh.
bool check_remesh(const Request& request, const Limits& limits);
/// Checks a request for which check_remesh gave true by reading all of its JSON, without building the mesh: the text
/// must be JSON, and the options in it must be valid. Errors in the mesh itself are not reported.
/// Errors: kMalformedJson; those of options; kCancelled, kTimeout - through `control`.
void check_json(const Request& request, const Limits& limits, RunControl& control);
/// Writes a stored result. The format is the one that `wanted` names by the option `format`, else by Accept, else the
/// one that the job asked for. The option `local_origin` of `wanted` replaces the job's.
/// Input:  `report` - returns the job's report; it is called only if the format contains the report.
/// Output: as run_remesh. The mesh and the summary are checked and measured with the coordinates of the format that
///         is written.
/// Errors: kUnknownOption, kInvalidOption, kNotAcceptable - also if a format cannot hold the result.
Response write_kept(std::string mesh, const std::function<std::string()>& report, const Request& wanted,
                    RunControl& control);

/// These functions answer GET /v1/capabilities and GET /openapi.json.
Response capabilities(const Limits& limits);
Response openapi();

/// An error in the form of RFC 9457. Codes that only HTTP has (`not_found`, `overloaded`, ...) are written to it
/// directly.
struct Problem {
  int status = 500;
  std::string code = "internal";
  std::string detail;
  std::optional<std::uint64_t> line, byte, element, limit;
  std::optional<std::string> option;
};

/// Maps an error of the core to HTTP. This is the only such table.
Problem to_problem(const Error& error);
/// Makes an answer of type application/problem+json, with type, title, status, detail, code, request_id and the
/// members that are set.
Response to_response(const Problem& problem, std::string_view request_id);

}  // namespace remesh::api
