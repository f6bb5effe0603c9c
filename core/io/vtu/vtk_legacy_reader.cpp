#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <utility>
#include <vector>

#include "core/io/common/text_lines.h"
#include "core/io/vtu/vtk_mesh.h"

namespace remesh {
namespace {

bool is_legacy_space(char c) { return is_blank(c) || is_line_end(c); }

/// Cells of one keyword: the corners of cell c are those from begin_of[c] to begin_of[c + 1].
struct LegacyCells {
  std::vector<std::int64_t> begin_of{0};
  std::vector<std::int64_t> points;
};

/// The keywords of cells in PolyData, in the order in which cell data count them, and the type of their cells.
struct LegacyKeyword {
  std::string_view word;
  int type;
};
constexpr std::array<LegacyKeyword, 4> kLegacyKeywords{
    {{"VERTICES", 2}, {"LINES", 4}, {"POLYGONS", 7}, {"TRIANGLE_STRIPS", 6}}};

class VtkLegacyReader {
 public:
  VtkLegacyReader(std::string_view content, const ReadLimits& limits, RunControl& control)
      : content_(content), control_(control), mesh_(content, limits, control) {}

  ReadResult read() {
    read_head();
    for (std::string_view word = next(); !word.empty(); word = next()) read_section(upper(word));
    if (!has_points_) throw error("there are no points");
    std::vector<std::int64_t> types = std::move(types_);
    for (std::size_t k = 0; k < kLegacyKeywords.size(); ++k) add_cells(poly_cells_[k], kLegacyKeywords[k].type, {});
    if (types.size() + 1 != cells_.begin_of.size()) throw error("there is not one type for each cell");
    add_cells(cells_, 0, types);
    for (const auto& labels : labels_)
      if (!labels.empty() && labels.size() != cell_count_) throw error("the number of cell data is not that of cells");
    mesh_.end_piece(labels_);
    return mesh_.take();
  }

 private:
  void read_head() {
    (void)line();  // the version
    (void)line();  // the title
    const std::string kind = upper(trim(line()));
    if (kind != "ASCII" && kind != "BINARY") throw error("neither ASCII nor BINARY, but " + cited(kind));
    is_binary_ = kind == "BINARY";
    if (upper(next()) != "DATASET") throw error("the word DATASET was expected");
    const std::string type = upper(next());
    if (type != "POLYDATA" && type != "UNSTRUCTURED_GRID")
      throw error("a data set of the type " + cited(type) + "; POLYDATA and UNSTRUCTURED_GRID are read");
  }

  void read_section(const std::string& word) {
    mesh_.tick(at_);
    const auto poly = std::find_if(kLegacyKeywords.begin(), kLegacyKeywords.end(),
                                   [&](const LegacyKeyword& known) { return known.word == word; });
    if (word == "POINTS") {
      read_points();
    } else if (poly != kLegacyKeywords.end()) {
      read_cells(poly_cells_[static_cast<std::size_t>(poly - kLegacyKeywords.begin())]);
    } else if (word == "CELLS") {
      read_cells(cells_);
    } else if (word == "CELL_TYPES") {
      types_ = numbers<std::int64_t>("int", count("the number of cells"));
    } else if (word == "CELL_DATA" || word == "POINT_DATA") {
      are_cell_data_ = word == "CELL_DATA";
      tuples_ = count("the number of values");
    } else if (word == "METADATA") {
      (void)line();
      while (at_ < content_.size() && !trim(line()).empty()) {
      }
    } else {
      read_attribute(word);
    }
  }

  void read_points() {
    if (has_points_) throw error("there is a second list of points");
    has_points_ = true;
    const std::uint64_t n = count("the number of points");
    const std::string type = lower(next());
    mesh_.begin_piece(n, content_.size(), place());
    const std::vector<double> coordinates = numbers<double>(type, 3 * n);
    for (std::size_t i = 0; i < coordinates.size(); i += 3) {
      mesh_.tick(at_);
      mesh_.add_point({coordinates[i], coordinates[i + 1], coordinates[i + 2]}, place());
    }
  }

  void read_cells(LegacyCells& cells) {
    const std::uint64_t n = count("the number of cells"), size = count("the number of their numbers");
    const std::size_t before = at_;
    if (upper(next()) == "OFFSETS") {
      cells.begin_of = numbers<std::int64_t>(lower(next()), n);
      if (upper(next()) != "CONNECTIVITY") throw error("the word CONNECTIVITY was expected");
      cells.points = numbers<std::int64_t>(lower(next()), size);
      if (cells.begin_of.empty()) cells.begin_of = {0};
      if (cells.begin_of.front() != 0 || !std::is_sorted(cells.begin_of.begin(), cells.begin_of.end()) ||
          cells.begin_of.back() > static_cast<std::int64_t>(cells.points.size()))
        throw error("the offsets of cells do not ascend from 0 to the number of corners");
      return;
    }
    at_ = before;
    std::vector<std::int64_t> flat = numbers<std::int64_t>("int", size);
    cells = {};
    cells.begin_of.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(n, size)) + 1);
    std::size_t to = 0;
    for (std::size_t i = 0; i < flat.size();) {
      mesh_.tick(at_);
      const std::int64_t corners = flat[i++];
      if (corners < 0 || static_cast<std::uint64_t>(corners) > flat.size() - i)
        throw error("a cell has more corners than its list");
      for (std::int64_t c = 0; c < corners; ++c) flat[to++] = flat[i++];
      cells.begin_of.push_back(static_cast<std::int64_t>(to));
    }
    if (cells.begin_of.size() != n + 1) throw error("the list of cells has another number of cells than it tells");
    flat.resize(to);
    cells.points = std::move(flat);
  }

  void add_cells(const LegacyCells& cells, int type, const std::vector<std::int64_t>& types) {
    mesh_.expect_cells(cells.begin_of.size() - 1, cells.points.size());
    for (std::size_t c = 0; c + 1 < cells.begin_of.size(); ++c) {
      mesh_.tick(at_);
      const auto begin = static_cast<std::size_t>(cells.begin_of[c]),
                 end = static_cast<std::size_t>(cells.begin_of[c + 1]);
      mesh_.add_cell(types.empty() ? type : static_cast<int>(types[c]),
                     std::span(cells.points).subspan(begin, end - begin), place());
      ++cell_count_;
    }
  }

  void read_attribute(const std::string& word) {
    constexpr std::array<std::pair<std::string_view, std::uint64_t>, 6> kComponents{
        {{"VECTORS", 3}, {"NORMALS", 3}, {"TENSORS", 9}, {"TENSORS6", 6}, {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}}};
    const auto known =
        std::find_if(kComponents.begin(), kComponents.end(), [&](const auto& k) { return k.first == word; });
    const std::string name(next());
    if (word == "SCALARS") {
      const std::string type = lower(next());
      const std::string_view rest = trim(line());
      const std::uint64_t components = rest.empty() ? 1 : parse_count(rest, "the number of components");
      const std::size_t before = at_;
      if (upper(next()) == "LOOKUP_TABLE") {
        (void)next();
      } else {
        at_ = before - 1;  // the line end, behind which binary data begin
      }
      take_array(name, type, components, tuples_);
    } else if (known != kComponents.end()) {
      take_array(name, lower(next()), known->second, tuples_);
    } else if (word == "TEXTURE_COORDINATES") {
      const std::uint64_t components = count("the number of components");
      take_array(name, lower(next()), components, tuples_);
    } else if (word == "COLOR_SCALARS") {
      take_array(name, is_binary_ ? "unsigned_char" : "float", count("the number of components"), tuples_);
    } else if (word == "LOOKUP_TABLE") {
      take_array("", is_binary_ ? "unsigned_char" : "float", 4, count("the size of the table"));
    } else if (word == "FIELD") {
      for (std::uint64_t left = count("the number of arrays"); left > 0; --left) {
        mesh_.tick(at_);
        std::string of_array(next());
        if (of_array == "METADATA") {
          read_section(of_array);
          of_array = next();
        }
        if (of_array.empty()) throw error("the file ends within a field");
        const std::uint64_t components = count("the number of components"), tuples = count("the number of values");
        take_array(of_array, lower(next()), components, tuples);
      }
    } else {
      throw error("a section that is not known: " + cited(word));
    }
  }

  /// Keeps an array if it has labels of cells.
  void take_array(const std::string& name, const std::string& type, std::uint64_t components, std::uint64_t tuples) {
    if (components > kMaxComponents) throw error("an array with too many components");
    if (tuples > content_.size()) throw error("an array with more values than the file has room for");
    const auto kind = are_cell_data_ && components == 1 ? VtkMesh::kind_of(name) : std::nullopt;
    if (kind && labels_[static_cast<std::size_t>(*kind)].empty()) {
      labels_[static_cast<std::size_t>(*kind)] = numbers<std::int64_t>(type, tuples);
      return;
    }
    mesh_.drop_array();
    if (type == "bit" && is_binary_) {
      to_line_end();
      const std::uint64_t bytes = (components * tuples + 7) / 8;
      if (bytes > content_.size() - at_) throw error("the data end early");
      at_ += static_cast<std::size_t>(bytes);
      return;
    }
    (void)numbers<double>(type, components * tuples);
  }

  /// Reads so many numbers, which begin behind the end of the line in binary files.
  template <class T>
  std::vector<T> numbers(const std::string& type, std::uint64_t n) {
    std::vector<T> values;
    if (is_binary_) {
      to_line_end();
      const std::size_t size = size_of_type(type);
      if (n > (content_.size() - at_) / size) throw error("the data end early");
      control_.memory().ask_for<T>(static_cast<std::size_t>(n));
      values.resize(static_cast<std::size_t>(n));
      const bool is_real = type == "float" || type == "double", is_unsigned = type.starts_with("unsigned");
      switch (size) {
        case 1: is_unsigned ? take_all<std::uint8_t>(values) : take_all<std::int8_t>(values); break;
        case 2: take_all<std::int16_t>(values); break;
        case 4: is_real ? take_all<float>(values) : take_all<std::int32_t>(values); break;
        default: is_real ? take_all<double>(values) : take_all<std::int64_t>(values);
      }
      return values;
    }
    constexpr std::size_t kMinNumber = 2;
    if (n > content_.size() / kMinNumber + 1)
      throw error("the text is too short for " + std::to_string(n) + " numbers");
    values.reserve(static_cast<std::size_t>(n));
    for (std::uint64_t i = 0; i < n; ++i) {
      mesh_.tick(at_);
      const std::string_view token = next();
      if (token.empty())
        throw error("the text ends after " + std::to_string(i) + " of " + std::to_string(n) + " numbers");
      if constexpr (std::is_floating_point_v<T>) {
        values.push_back(parse_coordinate(token, place()));
      } else {
        T value = 0;
        const auto [stop, status] = std::from_chars(token.data(), token.data() + token.size(), value);
        if (status != std::errc()) throw error("a whole number was expected, found " + cited(token));
        values.push_back(value);
      }
    }
    return values;
  }
  /// Takes as many numbers as there are values.
  template <class Stored, class T>
  void take_all(std::vector<T>& values) {
    load_numbers<Stored>(content_.data() + at_, ByteOrder::kBig, values);
    at_ += values.size() * sizeof(Stored);
  }

  std::size_t size_of_type(const std::string& type) const {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 13> kSizes{{{"char", 1},
                                                                               {"signed_char", 1},
                                                                               {"unsigned_char", 1},
                                                                               {"short", 2},
                                                                               {"unsigned_short", 2},
                                                                               {"int", 4},
                                                                               {"unsigned_int", 4},
                                                                               {"vtkidtype", 4},
                                                                               {"float", 4},
                                                                               {"double", 8},
                                                                               {"long", 8},
                                                                               {"unsigned_long", 8},
                                                                               {"vtktypeint64", 8}}};
    const auto found =
        std::find_if(kSizes.begin(), kSizes.end(), [&](const auto& known) { return known.first == type; });
    if (found == kSizes.end()) throw error("numbers of the type " + cited(type));
    return found->second;
  }

  /// Takes the next word. Output: empty at the end of the file.
  std::string_view next() {
    while (at_ < content_.size() && is_legacy_space(content_[at_])) ++at_;
    const std::size_t begin = at_;
    while (at_ < content_.size() && !is_legacy_space(content_[at_])) ++at_;
    return content_.substr(begin, at_ - begin);
  }
  /// Takes the rest of the line.
  std::string_view line() {
    const std::size_t begin = at_;
    to_line_end();
    std::string_view text = content_.substr(begin, at_ - begin);
    while (!text.empty() && is_line_end(text.back())) text.remove_suffix(1);
    return text;
  }
  void to_line_end() {
    const std::size_t end = content_.find('\n', at_);
    at_ = end == std::string_view::npos ? content_.size() : end + 1;
  }
  std::uint64_t count(const char* what) { return parse_count(next(), what); }
  std::uint64_t parse_count(std::string_view token, const char* what) const {
    std::uint64_t value = 0;
    const auto [stop, status] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (status != std::errc() || stop != token.data() + token.size() || value > kMaxCount)
      throw error(std::string(what) + " was expected, found " + cited(token));
    return value;
  }
  static std::string lower(std::string_view word) {
    std::string text(word.substr(0, 64));
    std::transform(text.begin(), text.end(), text.begin(), to_lower);
    return text;
  }
  static std::string upper(std::string_view word) {
    std::string text(word.substr(0, 64));
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
    return text;
  }

  Place place() const { return Place::byte(at_); }
  Error error(const std::string& message) const { return read_error(place(), Code::kInvalidMesh, message); }

  static constexpr std::uint64_t kMaxCount = std::uint64_t{1} << 40;
  static constexpr std::uint64_t kMaxComponents = 1000;

  std::string_view content_;
  RunControl& control_;
  VtkMesh mesh_;
  std::size_t at_ = 0;
  bool is_binary_ = false, has_points_ = false, are_cell_data_ = false;
  std::uint64_t tuples_ = 0, cell_count_ = 0;
  std::array<LegacyCells, kLegacyKeywords.size()> poly_cells_;
  LegacyCells cells_;
  std::vector<std::int64_t> types_;
  std::array<std::vector<std::int64_t>, 3> labels_;
};

}  // namespace

ReadResult read_vtk_legacy(std::string_view content, const ReadLimits& limits, RunControl& control) {
  return VtkLegacyReader(content, limits, control).read();
}

}  // namespace remesh
