/// Lets a server remesh a mesh. It uses a job, so that the work survives lost connections.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "api/operations.h"
#include "core/base/run_control.h"

namespace remesh::cli {

/// The server could not or would not do the work. `code` and the message are the server's own; without an answer the
/// code is `server_unreachable`.
class RemoteError : public std::runtime_error {
 public:
  RemoteError(int http_status, std::string problem_code, const std::string& detail)
      : std::runtime_error(detail), status(http_status), code(std::move(problem_code)) {}

  int status;
  std::string code;
  std::optional<std::uint64_t> line, byte;
};

struct RemoteJob {
  std::string server;   ///< http://host:8080, with a path if a proxy needs one
  std::string api_key;  ///< empty if there is none
  std::string_view mesh;
  std::string content_type;      ///< media type of the mesh; empty: the format is found from the content
  std::string content_encoding;  ///< coding of the mesh; empty if it has none
  std::string accept;            ///< media type of the answer; empty: the format of the mesh
  api::Fields options;           ///< options by their names in the API
  bool wants_report = false;
};

struct RemoteAnswer {
  std::string mesh;
  std::string report;   ///< JSON; empty unless it was asked for
  std::string summary;  ///< the summary of the mesh in one line, see summary_line
  std::string origin;   ///< the origin in the summary of the mesh; empty if there is none
};

/// One remeshing by a server. `run` may be called once; `progress_line` may be called from any thread meanwhile.
class Remote {
 public:
  /// Errors: remesh::Error kInvalidOption - `server` is not a URL.
  explicit Remote(RemoteJob job);
  ~Remote();

  /// Submits the job, waits for it and fetches the result. If the server does not answer, repeats the request for two
  /// minutes; this never makes a second job.
  /// Errors: RemoteError - the message names the job unless the mesh is at fault; remesh::Error kCancelled -
  ///         `control` says to stop, and the job was cancelled at the server.
  RemoteAnswer run(const RunControl& control);
  /// The line for a progress bar.
  std::string progress_line() const;

 private:
  class Client;
  const std::unique_ptr<Client> client_;
};

}  // namespace remesh::cli
