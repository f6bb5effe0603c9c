/// Reads numbers from the columns of a row. SQLite stores any text in any column, so a damaged file may hold anything.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>

#include "server/jobs/job_store.h"

namespace remesh::server::jobs {

/// Output: nothing if the column is empty or holds no whole number.
inline std::optional<std::int64_t> maybe_integer(const std::optional<std::string>& column) {
  std::int64_t value = 0;
  if (!column) return std::nullopt;
  const char* const end = column->data() + column->size();
  const auto [stop, error] = std::from_chars(column->data(), end, value);
  return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

/// Errors: DataError - the column is empty or holds no whole number.
inline std::int64_t integer(const std::optional<std::string>& column) {
  if (const std::optional<std::int64_t> value = maybe_integer(column)) return *value;
  throw DataError("a column of the store holds \"" + column.value_or("") + "\" in place of a number");
}

}  // namespace remesh::server::jobs
