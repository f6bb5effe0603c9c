/// Reads each file three times and prints its path, its bytes, the number of its faces, and the smallest processor time
/// of a reading in milliseconds, apart by tabs. Files are read as the command line reads them: told by their content.
/// Usage: read_times FILE...
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "api/json_reader.h"
#include "core/io/format_spec.h"

namespace {

double processor_ms() {
  std::timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

std::size_t faces_of(const std::string& content) {
  using namespace remesh;
  RunControl control;
  api::OptionReader options;
  const Format format = sniff_format(content);
  const ReadResult read = format == Format::kJson ? api::read_json(content, {}, control, options)
                                                  : format_spec(format).read(content, {}, control);
  return read.mesh.face_count();
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    const std::string content{std::istreambuf_iterator<char>(file), {}};
    double least = std::numeric_limits<double>::max();
    std::size_t faces = 0;
    try {
      for (int run = 0; run < 3; ++run) {
        const double start = processor_ms();
        faces = faces_of(content);
        least = std::min(least, processor_ms() - start);
      }
    } catch (const remesh::Error& error) {
      std::fprintf(stderr, "read_times: %s: %s\n", argv[i], error.what());
      return 1;
    }
    std::printf("%s\t%zu\t%zu\t%.3f\n", argv[i], content.size(), faces, least);
  }
}
