#include "api/cli/failure.h"

#include <new>

#include "api/cli/files.h"
#include "api/cli/remote.h"
#include "api/request_code.h"

namespace remesh::cli {

int exit_code(const Error& error) {
  if (error.code == Code::kOutputTooLarge) return kFailed;
  return error.option.empty() && error.code != Code::kNotAcceptable ? kFailed : kMisused;
}

namespace {

std::string place(const std::string& input, std::optional<std::uint64_t> line, std::optional<std::uint64_t> byte) {
  std::string text = input == "-" ? "standard input" : input;
  if (line) text += ":" + std::to_string(*line);
  if (byte) text += ": byte " + std::to_string(*byte);
  return text;
}

std::string describe(const RemoteError& error, const std::string& input) {
  const bool is_located = error.line || error.byte || error.status == 422;
  return (is_located ? place(input, error.line, error.byte) + ": " : "") + error.code + ": " + error.what();
}

}  // namespace

std::string place_of(const Error& error, const std::string& input) { return place(input, error.line, error.byte); }

std::string describe(const Error& error, const std::string& input) {
  const bool is_located = exit_code(error) == kFailed && error.stage == Stage::kRead;
  return (is_located ? place_of(error, input) + ": " : "") + std::string(api::error_name(error)) + ": " + error.what();
}

Failure failure_of(const std::exception_ptr& thrown, const std::string& input) {
  const auto failed = [](const std::string& code, const std::string& message) {
    return Failure{kFailed, code, message, code + ": " + message};
  };
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    return {exit_code(error), std::string(api::error_name(error)), error.what(), describe(error, input)};
  } catch (const RemoteError& error) {
    const bool is_misuse = error.status == 400 || error.status == 406;
    return {is_misuse ? kMisused : kFailed, error.code, error.what(), describe(error, input)};
  } catch (const FileError& error) {
    return {kFailed, "file_error", error.what(), error.what()};
  } catch (const std::bad_alloc&) {
    return failed("out_of_memory", "the mesh needs more memory than this process may use");
  } catch (const std::exception& error) {
    return failed("internal", error.what());
  } catch (...) {
    return failed("internal", "an exception of an unknown type was thrown");
  }
}

}  // namespace remesh::cli
