#include "core/io/mesh_files.h"

#include "core/base/error.h"
#include "core/io/format_spec.h"

namespace remesh {

ReadResult read_mesh(Format format, std::string_view content, const ReadLimits& limits, RunControl& control) {
  if (const auto read = format_spec(format).read) return read(content, limits, control);
  throw Error(Code::kUnsupportedMediaType, Stage::kRead,
              "the format " + std::string(format_name(format)) + " is not read here");
}

std::string write_mesh(Format format, const WriterInput& input, RunControl& control) {
  control.enter(Stage::kWrite);
  if (const auto write = format_spec(format).write) return write(input, control);
  throw Error(Code::kNotAcceptable, Stage::kWrite,
              "the format " + std::string(format_name(format)) + " is not written here");
}

std::vector<RenamedLabel> renamed_labels(Format format, const WriterInput& input, RunControl& control) {
  const auto renamed = format_spec(format).renamed;
  return renamed == nullptr ? std::vector<RenamedLabel>() : renamed(input, control);
}

std::vector<std::string> filling_lines(Format format, const WriterInput& input, RunControl& control) {
  const auto filling = format_spec(format).filling;
  return filling == nullptr ? std::vector<std::string>() : filling(input, control);
}

}  // namespace remesh
