/// The daemon's log: events with named values, on standard error, as text for people or as a JSON object a line for
/// machines.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace remesh::server::log {

enum class Level { kDebug, kInfo, kWarning, kError, kOff };
enum class Format { kAuto, kText, kJson };  ///< kAuto: text on a terminal

struct Field {
  std::string_view name;
  std::variant<std::string, std::int64_t, double> value;
};

/// Sets the log up; before that, it is text from level info on.
void set_up(Format format, Level level);

/// Whether `write` would write.
bool is_written(Level level);

/// Writes one line. Values from outside are safe: whatever could break the line is escaped.
void write(Level level, std::string_view event, const std::vector<Field>& fields = {});

/// The line's payload without time and level, as `write` makes it.
std::string render(Format format, std::string_view event, const std::vector<Field>& fields);

}  // namespace remesh::server::log
