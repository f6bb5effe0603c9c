#include "server/http/error_response.h"

#include <algorithm>
#include <cerrno>
#include <new>
#include <string>
#include <system_error>

#include "server/observe/log.h"

namespace remesh::server {
namespace {

constexpr const char* kRetryAfterSeconds = "2";

Response respond(const api::Problem& problem, std::string_view request_id, const Fields& headers = {}) {
  Response response;
  static_cast<api::Response&>(response) = api::to_response(problem, request_id);
  response.headers.insert(response.headers.end(), headers.begin(), headers.end());
  response.problem_code = problem.code;
  const bool has_time =
      std::any_of(headers.begin(), headers.end(), [](const auto& header) { return header.first == "Retry-After"; });
  if (!has_time && (response.status == 503 || response.status == 429))
    response.headers.emplace_back("Retry-After", kRetryAfterSeconds);
  return response;
}

void log_failure(const char* what, std::string_view request_id) {
  log::write(log::Level::kError, "request failed", {{"id", std::string(request_id)}, {"error", std::string(what)}});
}

Response respond_internal(const char* what, std::string_view request_id) {
  log_failure(what, request_id);
  const HttpError error(500, "internal",
                        "an internal error has occurred; the server's log has the details under "
                        "this request id");
  return respond(error.problem, request_id);
}

}  // namespace

Response error_response(const std::exception_ptr& failure, std::string_view request_id) {
  try {
    std::rethrow_exception(failure);
  } catch (const HttpError& error) {
    return respond(error.problem, request_id, error.headers);
  } catch (const Error& error) {
    const api::Problem problem = api::to_problem(error);
    if (problem.status == 500) log_failure(error.what(), request_id);
    return respond(problem, request_id);
  } catch (const std::bad_alloc&) {
    log::write(log::Level::kError, "out of memory", {{"id", std::string(request_id)}});
    return respond(out_of_memory().problem, request_id);
  } catch (const std::system_error& error) {
    const int number = error.code().value();
    if (number != EMFILE && number != ENFILE && number != EAGAIN) return respond_internal(error.what(), request_id);
    log::write(log::Level::kError, "out of descriptors or threads", {{"id", std::string(request_id)}});
    return respond(HttpError(503, "overloaded", "the server is out of descriptors or threads").problem, request_id);
  } catch (const std::exception& error) {
    return respond_internal(error.what(), request_id);
  } catch (...) {
    return respond_internal("an exception of an unknown type was thrown", request_id);
  }
}

}  // namespace remesh::server
