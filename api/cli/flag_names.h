/// The names of options on the command line.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace remesh::cli {

/// Converts an option's name in the API to that of a flag, without the two hyphens in front.
inline std::string with_hyphens(std::string_view name) {
  std::string flag(name);
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

/// Converts a flag to an option's name in the API.
inline std::string with_underscores(std::string_view flag) {
  std::string name(flag);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace remesh::cli
