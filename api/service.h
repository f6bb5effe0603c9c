/// The operations of the contract as plain functions: bytes and strings in, bytes and strings out. No HTTP library, no
/// sockets, no logging; the daemon and the command line both call these.
#pragma once

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

/// Bounds that a server sets; also what /v1/capabilities tells.
struct Limits {
  std::uint64_t max_body = 256ull << 20;           ///< bytes
  std::uint64_t max_decompressed = 1024ull << 20;  ///< bytes of a body, or a mesh in it, out of gzip
  std::uint64_t max_ratio = 100;                   ///< of those to the compressed ones, beyond the first MiB
  std::uint64_t max_vertices = 10'000'000;
  std::uint64_t max_faces = 20'000'000;
  std::uint64_t max_output_faces = 50'000'000;
  int workers = 1;  ///< threads one request may use
  double request_timeout_s = 300;
  /// Where a request names no `max_output_faces`, this many if it is fewer.
  std::uint64_t usual_output_faces = std::numeric_limits<std::uint64_t>::max();
  std::size_t serial_corners = 0;  ///< see RunSettings
};

/// Of those, what bounds a body, or a mesh in it, out of gzip.
inline DecompressionLimits decompression_limits(const Limits& limits) {
  return {limits.max_decompressed, limits.max_ratio};
}

/// One request, after HTTP: `query` in the order given, decoded.
struct Request {
  std::string_view body;
  std::string content_type;      ///< as sent, may be empty
  std::string content_encoding;  ///< as sent, may be empty
  std::string accept;            ///< as sent, may be empty
  Fields query;
  std::function<void()> release_body = nullptr;  ///< called once the body is read and not needed any more
};

/// A piece of work in numbers, for whoever counts what a daemon does.
struct WorkDone {
  std::uint64_t input_faces = 0;
  std::uint64_t output_faces = 0;                              ///< 0 of an analysis
  std::uint64_t remeshed = 0, reduced = 0, kept = 0;           ///< patches
  std::vector<std::pair<std::string_view, double>> stages_ms;  ///< those that ran
};

/// What goes back: `headers` beyond Content-Type (Remesh-Summary, Server-Timing, Content-Disposition).
struct Response {
  int status = 200;
  std::string content_type;
  std::string body;
  Fields headers;
  std::optional<WorkDone> done = std::nullopt;
};

/// POST /v1/remesh and POST /v1/analyze, whole: options, reading, the pipeline, writing.
/// Errors: remesh::Error, of any code.
Response run_remesh(const Request& request, const Limits& limits, RunControl& control);
Response run_analyze(const Request& request, const Limits& limits, RunControl& control);

/// The same remeshing for an answer that is fetched later, in any format: see result_archive.
struct KeptRemesh {
  std::string mesh;    ///< packed
  std::string report;  ///< the report object as JSON
  WorkDone done;
};
/// Errors: as run_remesh.
KeptRemesh run_remesh_to_keep(const Request& request, const Limits& limits, RunControl& control);
/// What of a request to remesh can be refused before its mesh is read: options, form, media types.
/// Errors: as run_remesh.
void check_remesh(const Request& request, const Limits& limits);
/// Writes what was kept, in the format that `wanted` asks for by the option `format`, else by Accept, else in the one
/// that the job asked for; with the option `local_origin` that `wanted` has, else the job's.
/// Output: as run_remesh: mesh and summary are checked and measured in the numbers of the format written. `report` is
///         asked for where the format has it.
/// Errors: kUnknownOption, kInvalidOption, kNotAcceptable - also a format that cannot hold the result.
Response write_kept(std::string_view mesh, const std::function<std::string()>& report, const Request& wanted,
                    RunControl& control);

/// GET /v1/capabilities and GET /openapi.json.
Response capabilities(const Limits& limits);
Response openapi();

/// An error of the contract (RFC 9457). Codes that only HTTP knows (`not_found`, `overloaded`, ...) use this directly.
struct Problem {
  int status = 500;
  std::string code = "internal";
  std::string detail;
  std::optional<std::uint64_t> line, byte, element, limit;
  std::optional<std::string> option;
};

/// The one table from core codes to HTTP.
Problem to_problem(const Error& error);
/// application/problem+json with type, title, status, detail, code, request_id and what else is set.
Response to_response(const Problem& problem, std::string_view request_id);

}  // namespace remesh::api
