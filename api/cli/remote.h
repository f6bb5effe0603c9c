/// A mesh remeshed by a server: as a job, so that it outlives connections.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "api/service.h"
#include "core/base/run_control.h"

namespace remesh::cli {

/// The server does not do it; `code` and message are its own, or `server_unreachable`.
class RemoteError : public std::runtime_error {
 public:
  RemoteError(int http_status, std::string problem_code, const std::string& detail)
      : std::runtime_error(detail), status(http_status), code(std::move(problem_code)) {}

  int status;
  std::string code;
  std::optional<std::uint64_t> line, byte;
};

struct RemoteJob {
  std::string server;   ///< http://host:8080, with a path where a proxy has one
  std::string api_key;  ///< empty: none
  std::string_view mesh;
  std::string content_type;      ///< of the mesh; empty: the content tells
  std::string content_encoding;  ///< of the mesh; empty: none
  std::string accept;            ///< media type of the answer; empty: as the mesh
  api::Fields options;           ///< by the contract's names
  bool wants_report = false;
};

struct RemoteAnswer {
  std::string mesh;
  std::string report;  ///< JSON; empty unless asked for
  std::string origin;  ///< the summary's origin of the mesh; empty: none
};

/// One remeshing by a server. `run` is called once; `progress_line` from any thread meanwhile.
class Remote {
 public:
  /// Errors: remesh::Error kInvalidOption - `server` is no URL.
  explicit Remote(RemoteJob job);
  ~Remote();

  /// Submits the job, waits for it and fetches the result. Where nobody answers it asks again, for two minutes, without
  /// making a second job of it.
  /// Errors: RemoteError, which names the job where it is not the mesh's fault; remesh::Error kCancelled - `control`
  /// says to stop: the job is cancelled at the server.
  RemoteAnswer run(const RunControl& control);
  /// For a progress bar.
  std::string progress_line() const;

 private:
  class Client;
  const std::unique_ptr<Client> client_;
};

}  // namespace remesh::cli
