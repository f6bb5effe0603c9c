/// remeshd_load slow|overload|soak [--connections N] [--seconds S] [--requests N] [--judge-times 0|1]
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>

#include "tests/load/scenarios.h"

int main(int argc, char** argv) {
  const std::string scenario = argc > 1 ? argv[1] : "";
  std::map<std::string, double> options{
      {"--connections", 512}, {"--seconds", 60}, {"--requests", 100'000}, {"--judge-times", 1}};
  for (int i = 2; i + 1 < argc; i += 2) {
    if (options.count(argv[i]) == 0) {
      std::fprintf(stderr, "unknown option %s\n", argv[i]);
      return 2;
    }
    options[argv[i]] = std::strtod(argv[i + 1], nullptr);
  }
  try {
    using namespace remesh::load;
    const bool judges_times = options["--judge-times"] != 0;
    if (scenario == "slow") return slow(static_cast<std::size_t>(options["--connections"]), judges_times);
    if (scenario == "overload") return overload(options["--seconds"], judges_times);
    if (scenario == "soak") return soak(static_cast<std::size_t>(options["--requests"]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", scenario.c_str(), error.what());
    return 1;
  }
  std::fprintf(stderr,
               "usage: remeshd_load slow|overload|soak [--connections N] [--seconds S] [--requests N] "
               "[--judge-times 0|1]\n");
  return 2;
}
