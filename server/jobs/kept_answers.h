/// Keeps answers that took work to make and are asked for in parts, so that each is made once.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "server/http/connection.h"
#include "server/http/http_message.h"
#include "server/http/route.h"
#include "server/http/spool.h"

namespace remesh::server::jobs {

/// An answer whose body is in a file of the spool.
struct KeptAnswer {
  Response head;  ///< all of the answer but its body
  Spool::File body;
};

class KeptAnswers {
 public:
  explicit KeptAnswers(Spool& spool) : spool_(spool) {}

  /// Finds an answer, or makes and keeps it. If several connections ask for one that is being made, one of them makes
  /// it and the others wait.
  /// Input:  `key` - names the bytes; all requests with one key get the same. `made` - receives the answer if this call
  ///         has made it and it could not be kept.
  /// Output: null if the answer is in `made`.
  /// Errors: whatever `make` throws; ConnectionLost - the client has gone while it waited.
  std::shared_ptr<const KeptAnswer> get(const std::string& key, const Call& call, const std::function<Response()>& make,
                                        std::optional<Response>& made);
  /// Finds an answer that is kept.
  /// Output: null if there is none.
  std::shared_ptr<const KeptAnswer> find(const std::string& key);
  /// Forgets all answers whose keys begin so.
  void forget(std::string_view begin);

 private:
  struct Entry {
    std::shared_ptr<const KeptAnswer> answer;  ///< null while it is being made
    Clock::time_point used = Clock::now();
  };

  bool begin_making(const std::string& key, std::shared_ptr<const KeptAnswer>& found);
  void end_making(const std::string& key, std::shared_ptr<const KeptAnswer> answer);
  void drop_old();

  Spool& spool_;
  std::mutex mutex_;
  std::map<std::string, Entry> entries_;
};

}  // namespace remesh::server::jobs
