/// The kinds of errors that only a request has. The core, which knows no JSON, no forms and no names of options, never
/// throws them.
#pragma once

#include <string_view>

#include "core/base/error.h"

namespace remesh::api {

/// These codes continue the core's, so that an error of either kind is a remesh::Error.
enum class RequestCode {
  kMalformedRequest = kCoreCodeCount,
  kMalformedJson,
  kMalformedMultipart,
  kBodyTooLarge,
  kUnknownOption,
};
inline constexpr int kCodeCount = static_cast<int>(RequestCode::kUnknownOption) + 1;

/// The code in the form in which an Error holds it.
constexpr Code as_code(RequestCode code) { return static_cast<Code>(code); }
constexpr bool operator==(Code code, RequestCode other) { return code == as_code(other); }

/// The stable name of an error's code, whether the core or a request has it: `invalid_mesh`, `malformed_json`.
std::string_view error_name(const Error& error);

}  // namespace remesh::api
