/// The values of options: how their text is read and stored in a request's options. options.h has the way back.
#pragma once

#include <string>
#include <string_view>

#include "api/options.h"
#include "core/base/error.h"

namespace remesh::api {

/// The error to throw for an option that cannot be as it was given.
/// Input:  `message` goes on after the option's name: "must be ...".
Error invalid_option(const OptionSpec& spec, const std::string& message);

/// Reads the value of an option and stores it.
/// Errors: kInvalidOption - the value has the wrong type, cannot be read, or is out of range.
void set_option(const OptionSpec& spec, std::string_view text, ValueKind kind, RequestOptions& options);

}  // namespace remesh::api
