#include "tests/mutate/corpus.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "core/base/run_control.h"
#include "core/io/gzip.h"
#include "tests/mutate/polygon_soup.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/solids.h"

namespace remesh::mutate {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxRatio = 100;  // decompressed to compressed bytes of a file

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void add_folder(const fs::path& folder, std::size_t max_bytes, std::vector<CorpusFile>& files) {
  if (!fs::is_directory(folder)) return;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path relative = entry.path().lexically_relative(folder);
    if (!entry.is_regular_file() || entry.file_size() > max_bytes) continue;
    // These files are known to take longer than a case may.
    if (relative.generic_string().find("slow/") != std::string::npos) continue;
    const bool is_mesh = format_from_file_name(entry.path().filename().string()).has_value();
    if (!is_mesh) continue;
    std::string bytes = read_file(entry.path());
    if (is_gzip(bytes)) {
      try {
        RunControl control;
        bytes = gunzip(bytes, {max_bytes, kMaxRatio}, control);
      } catch (const Error&) {
        continue;  // the file is damaged or too large
      }
    }
    if (bytes.size() > max_bytes) continue;
    const Format format = sniff_format(bytes);
    files.push_back({relative.generic_string(), std::move(bytes), format});
  }
}

void add_made(std::string name, const PolygonMesh& mesh, std::vector<CorpusFile>& files) {
  files.push_back({"<" + std::move(name) + ">", write_soup(soup_of(mesh), SoupFormat::kObj), Format::kObj});
}

}  // namespace

std::vector<CorpusFile> load_corpus(std::size_t max_bytes) {
  const fs::path shared = test::shared_meshes_folder();
  if (!fs::is_directory(shared)) {
    const std::string missing = "there is no " + shared.string();
    if (test::is_corpus_required()) throw std::runtime_error(missing + ", and REMESHD_REQUIRE_CORPUS is 1");
    std::cout << "NOT TESTED in part: " << missing << "\n";
  }
  std::vector<CorpusFile> files;
  add_folder(fs::path(REMESHD_SOURCE_DIR) / "tests" / "data", max_bytes, files);
  add_folder(shared, max_bytes, files);
  add_made("box", shapes::box({2, 3, 5}), files);
  add_made("quad_box", shapes::quad_box({1, 1, 1}, 2), files);
  add_made("blocks", shapes::blocks({"##.", "#.#", "###"}), files);
  add_made("slotted_plate", shapes::slotted_plate(), files);
  add_made("plate_with_round_hole", shapes::plate_with_round_hole(24), files);
  add_made("double_sheet", shapes::double_sheet(), files);
  add_made("cut_cube", solids::cut_cube(7, 20), files);
  add_made("needle_fan", solids::needle_fan(12, 2), files);
  add_made("cone", solids::cone(40, 2), files);
  add_made("nested_squares", solids::nested_squares(4, 0.25), files);
  add_made("tube", solids::tube(4, 10, 0.125), files);
  add_made("stacked_boxes", solids::stacked_boxes(3, 2), files);
  std::sort(files.begin(), files.end(), [](const CorpusFile& a, const CorpusFile& b) {
    return std::tuple(a.bytes.size(), a.name) < std::tuple(b.bytes.size(), b.name);
  });
  return files;
}

}  // namespace remesh::mutate
