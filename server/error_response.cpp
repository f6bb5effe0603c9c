#include "server/error_response.h"

#include <cerrno>
#include <new>
#include <string>
#include <system_error>

#include "server/log.h"

namespace remesh::server {
namespace {

constexpr const char* kRetryAfterSeconds = "2";

Response respond(const api::Problem& problem, std::string_view request_id, const Fields& headers = {}) {
  Response response;
  static_cast<api::Response&>(response) = api::to_response(problem, request_id);
  response.headers.insert(response.headers.end(), headers.begin(), headers.end());
  if (response.status == 503) response.headers.emplace_back("Retry-After", kRetryAfterSeconds);
  return response;
}

Response respond_internal(const char* what, std::string_view request_id) {
  log::write(log::Level::kError, "request failed", {{"id", std::string(request_id)}, {"error", std::string(what)}});
  api::Problem problem;
  problem.detail = "an internal error; the server's log has more under this request id";
  return respond(problem, request_id);
}

}  // namespace

Response error_response(const std::exception_ptr& failure, std::string_view request_id) {
  try {
    std::rethrow_exception(failure);
  } catch (const HttpError& error) {
    return respond(error.problem, request_id, error.headers);
  } catch (const Error& error) {
    if (error.code == Code::kInternal) return respond_internal(error.what(), request_id);
    return respond(api::to_problem(error), request_id);
  } catch (const std::bad_alloc&) {
    log::write(log::Level::kError, "out of memory", {{"id", std::string(request_id)}});
    api::Problem problem;
    problem.status = 503;
    problem.code = "out_of_memory";
    problem.detail = "not enough memory for this request now";
    return respond(problem, request_id);
  } catch (const std::system_error& error) {
    const int number = error.code().value();
    if (number != EMFILE && number != ENFILE && number != EAGAIN) return respond_internal(error.what(), request_id);
    log::write(log::Level::kError, "out of descriptors or threads", {{"id", std::string(request_id)}});
    api::Problem problem;
    problem.status = 503;
    problem.code = "overloaded";
    problem.detail = "the server is out of descriptors or threads";
    return respond(problem, request_id);
  } catch (const std::exception& error) {
    return respond_internal(error.what(), request_id);
  } catch (...) {
    return respond_internal("something that is no std::exception was thrown", request_id);
  }
}

}  // namespace remesh::server
