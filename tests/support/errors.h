/// What was thrown, as a value.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "core/base/error.h"

namespace remesh::test {

/// The error that `act` ends with; a failure of the test if it does not.
inline Error error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(Code::kInternal, Stage::kQueued, "");
}

}  // namespace remesh::test
