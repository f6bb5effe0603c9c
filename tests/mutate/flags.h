/// Parses the flags of these programs: `--name VALUE`, and words without a name.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace remesh::mutate {

class Flags {
 public:
  /// Input:  `defaults` - the names that may be given, with their defaults.
  /// Errors: std::invalid_argument - an unknown name, or a name without a value.
  Flags(int argc, char** argv, std::map<std::string, std::string> defaults);

  const std::string& text(const std::string& name) const { return values_.at(name); }
  /// Returns a value as a number.
  /// Errors: std::invalid_argument - it is not a number.
  double number(const std::string& name) const;
  std::uint64_t integer(const std::string& name) const;
  bool is_set(const std::string& name) const { return !values_.at(name).empty(); }
  const std::vector<std::string>& words() const { return words_; }

 private:
  std::map<std::string, std::string> values_;
  std::vector<std::string> words_;
};

}  // namespace remesh::mutate
