/// Returns thrown errors as values.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "core/base/error.h"

namespace remesh::test {

/// Runs `act` and returns the error that it throws. The test fails if it throws none.
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
