#include "tests/mutate/flags.h"

#include <stdexcept>
#include <utility>

namespace remesh::mutate {

Flags::Flags(int argc, char** argv, std::map<std::string, std::string> defaults) : values_(std::move(defaults)) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (!word.starts_with("--")) {
      words_.push_back(word);
      continue;
    }
    const auto value = values_.find(word.substr(2));
    if (value == values_.end()) throw std::invalid_argument("there is no flag " + word);
    if (++i == argc) throw std::invalid_argument(word + " wants a value");
    value->second = argv[i];
  }
}

double Flags::number(const std::string& name) const {
  try {
    return std::stod(text(name));
  } catch (const std::exception&) {
    throw std::invalid_argument("--" + name + " wants a number, not \"" + text(name) + "\"");
  }
}

std::uint64_t Flags::integer(const std::string& name) const {
  try {
    return std::stoull(text(name));
  } catch (const std::exception&) {
    throw std::invalid_argument("--" + name + " wants a whole number, not \"" + text(name) + "\"");
  }
}

}  // namespace remesh::mutate
