// Options from any query string, "name=value&...": accepted, or refused with an error of options.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "api/options.h"
#include "api/request_code.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace remesh;
  std::string_view query(reinterpret_cast<const char*>(data), size);
  api::OptionReader options;
  std::string_view name;
  try {
    while (!query.empty()) {
      const std::string_view pair = query.substr(0, query.find('&'));
      query.remove_prefix(std::min(query.size(), pair.size() + 1));
      if (pair.empty()) continue;  // as the daemon does
      const std::size_t equals = pair.find('=');
      name = pair.substr(0, equals);
      options.add(name, equals == std::string_view::npos ? "" : pair.substr(equals + 1));
    }
    name = "any";
    options.check();
  } catch (const Error& error) {
    fuzz::require(error.code == api::RequestCode::kUnknownOption || error.code == Code::kInvalidOption, error.what());
    fuzz::require(error.option.empty() == name.empty(), "an error of options does not name one");
  }
  return 0;
}
