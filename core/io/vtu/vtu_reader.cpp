#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/io/common/base64.h"
#include "core/io/common/text_tokens.h"
#include "core/io/vtu/vtk_mesh.h"
#include "core/io/vtu/vtu.h"
#include "core/io/vtu/xml_elements.h"

namespace remesh {
namespace {

Error vtk_error(std::size_t offset, const std::string& message) {
  return read_error(Place::byte(offset), Code::kInvalidMesh, message);
}

/// An array as it stands in the file.
struct PackedArray {
  std::string_view section;  ///< the element around it: `Points`, `Cells`, ...
  std::string_view type;     ///< `Float64`, ...
  std::string name;
  std::uint64_t components = 1;
  std::string_view format;  ///< `ascii`, `binary` or `appended`
  std::uint64_t offset = 0;
  std::string_view text;  ///< between its tags
  std::size_t begin = 0;  ///< the offset of `text` in the file
};

struct PackedPiece {
  std::uint64_t points = 0, cells = 0;
  std::array<std::uint64_t, 4> cells_of{};  ///< in PolyData: those of kCellSections
  std::vector<PackedArray> arrays;
  std::size_t begin = 0;
};

/// The elements of cells in PolyData, in the order in which cell data count them, and the type of their cells. Vertices
/// and lines are no faces.
struct CellSection {
  std::string_view element, count;
  int type;
};
constexpr std::array<CellSection, 4> kCellSections{{{"Verts", "NumberOfVerts", 2},
                                                    {"Lines", "NumberOfLines", 4},
                                                    {"Polys", "NumberOfPolys", 7},
                                                    {"Strips", "NumberOfStrips", 6}}};

std::uint64_t number_attribute(const XmlTag& tag, std::string_view name, std::uint64_t otherwise) {
  const auto value = tag.attribute(name);
  return !value || trim(*value).empty() ? otherwise : *tag.number(name);
}

/// How the file packs its arrays.
struct Packing {
  ByteOrder order = ByteOrder::kLittle;
  std::size_t header_size = 4;  ///< bytes of each number in the header of an array
  std::string_view compressor;  ///< empty: none
  std::string_view appended;    ///< the data of arrays that stand behind all others
  bool is_raw = false;          ///< whether these are bytes; else they are base64
};

/// Makes numbers of arrays.
class ArrayUnpacker {
 public:
  ArrayUnpacker(std::string_view content, const Packing& packing, RunControl& control, VtkMesh& mesh)
      : content_(content), packing_(packing), control_(control), mesh_(mesh) {}

  /// Unpacks an array that must have so many numbers.
  template <class T>
  std::vector<T> numbers(const PackedArray& array, std::uint64_t count) {
    if (array.format == "ascii") return numbers_of_text<T>(array, count);
    using Convert = void (*)(const char*, ByteOrder, std::vector<T>&);
    struct Type {
      std::string_view name;
      std::size_t size;
      Convert convert;
    };
    static constexpr std::array<Type, 10> kTypes{{{"Float32", 4, load_numbers<float, T>},
                                                  {"Float64", 8, load_numbers<double, T>},
                                                  {"Int8", 1, load_numbers<std::int8_t, T>},
                                                  {"UInt8", 1, load_numbers<std::uint8_t, T>},
                                                  {"Int16", 2, load_numbers<std::int16_t, T>},
                                                  {"UInt16", 2, load_numbers<std::uint16_t, T>},
                                                  {"Int32", 4, load_numbers<std::int32_t, T>},
                                                  {"UInt32", 4, load_numbers<std::uint32_t, T>},
                                                  {"Int64", 8, load_numbers<std::int64_t, T>},
                                                  {"UInt64", 8, load_numbers<std::uint64_t, T>}}};
    const auto type =
        std::find_if(kTypes.begin(), kTypes.end(), [&](const Type& known) { return known.name == array.type; });
    if (type == kTypes.end()) throw vtk_error(array.begin, "an array of the type " + cited(array.type));
    const auto size = count * type->size;
    std::vector<T> values;
    const auto make_room = [&] {
      control_.memory().ask_for<T>(static_cast<std::size_t>(count));
      values.resize(static_cast<std::size_t>(count));
    };
    if (!packing_.compressor.empty() && type->convert == &load_numbers<T, T> && packing_.order == kNativeOrder) {
      inflate(array, size, [&] {
        make_room();
        return reinterpret_cast<char*>(values.data());
      });
      return values;
    }
    const UnpackedArray bytes = unpacked(array, size);
    make_room();
    type->convert(bytes.data(), packing_.order, values);
    return values;
  }

 private:
  template <class T>
  std::vector<T> numbers_of_text(const PackedArray& array, std::uint64_t count) {
    constexpr std::size_t kMinNumber = 2;
    std::vector<T> values;
    values.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(count, array.text.size() / kMinNumber + 1)));
    TextTokens tokens(array.text);
    const auto in_file = [&](Error error) {
      error.line.reset();
      error.at_byte(array.begin);
      return error;
    };
    try {
      for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
        mesh_.tick(array.begin + tokens.offset());
        if (values.size() == count) throw tokens.expected("the end of the array", token);
        const bool is_real = std::is_floating_point_v<T> || token.find_first_of(".eE") != std::string_view::npos;
        if (is_real) {
          const double real = parse_coordinate(token, tokens.place());
          values.push_back(std::is_floating_point_v<T> ? static_cast<T>(real)
                                                       : static_cast<T>(std::clamp(real, -0x1p53, 0x1p53)));
          continue;
        }
        if constexpr (!std::is_floating_point_v<T>) {
          T whole{};
          const auto [stop, status] = std::from_chars(token.data(), token.data() + token.size(), whole);
          if (status != std::errc()) throw tokens.expected("a whole number", token);
          values.push_back(whole);
        }
      }
    } catch (const Error& error) {
      if (error.code != Code::kInvalidMesh && error.code != Code::kNonfiniteCoordinate) throw;
      throw in_file(error);
    }
    if (values.size() < count) throw wrong_count(array, values.size(), count);
    return values;
  }

  /// The bytes of an array, behind those of its header.
  struct UnpackedArray {
    std::string bytes;
    std::size_t begin;
    const char* data() const { return bytes.data() + begin; }
  };

  /// Returns the bytes of an array, which must be so many.
  UnpackedArray unpacked(const PackedArray& array, std::uint64_t size) const {
    UnpackedArray unpacked{{}, 0};
    if (packing_.compressor.empty()) {
      const std::uint64_t found = header_number(array, first_bytes(array, packing_.header_size), 0);
      if (found != size) throw wrong_count(array, found, size);
      unpacked = {first_bytes(array, packing_.header_size + size), packing_.header_size};
      if (unpacked.bytes.size() != packing_.header_size + size) throw ends_early(array);
    } else {
      inflate(array, size, [&] {
        control_.memory().ask_for<char>(static_cast<std::size_t>(size));
        unpacked.bytes.resize(static_cast<std::size_t>(size));
        return unpacked.bytes.data();
      });
    }
    return unpacked;
  }

  /// Returns so many bytes of an array, or all if it has fewer, as they are before zlib unpacks them.
  std::string first_bytes(const PackedArray& array, std::uint64_t bytes) const {
    const bool is_appended = array.format == "appended";
    if (!is_appended && array.format != "binary")
      throw vtk_error(array.begin, "an array in the format " + cited(array.format));
    if (is_appended && array.offset > packing_.appended.size())
      throw vtk_error(array.begin, "an array whose data begin behind the end of the file");
    const std::string_view text =
        is_appended ? packing_.appended.substr(static_cast<std::size_t>(array.offset)) : array.text;
    if (!is_appended || !packing_.is_raw) return from_base64(text, bytes);
    return std::string(text.substr(0, static_cast<std::size_t>(std::min<std::uint64_t>(bytes, text.size()))));
  }

  /// Returns a number of an array's header.
  std::uint64_t header_number(const PackedArray& array, std::string_view bytes, std::size_t i) const {
    if (bytes.size() < (i + 1) * packing_.header_size) throw ends_early(array);
    const char* const at = bytes.data() + i * packing_.header_size;
    return packing_.header_size == 8 ? load<std::uint64_t>(at, packing_.order)
                                     : load<std::uint32_t>(at, packing_.order);
  }

  /// Lets zlib unpack an array, which must have so many bytes.
  /// Input: `make_room` - is called once the array is known to tell that size; returns where the bytes go.
  template <class MakeRoom>
  void inflate(const PackedArray& array, std::uint64_t size, const MakeRoom& make_room) const {
    const std::string head = first_bytes(array, 3 * packing_.header_size);
    const std::uint64_t blocks = header_number(array, head, 0), block = header_number(array, head, 1),
                        last = header_number(array, head, 2);
    if (blocks == 0 && size == 0) return;
    // Each block of the header stands in the file, so that there cannot be more than it has bytes.
    if (blocks == 0 || blocks > content_.size() || block == 0 || block > std::numeric_limits<std::uint32_t>::max() ||
        last > block)
      throw vtk_error(array.begin, "an array with a malformed list of blocks");
    const std::uint64_t whole = last == 0 ? blocks * block : (blocks - 1) * block + last;
    if (whole != size) throw wrong_count(array, whole, size);
    const std::string sizes = first_bytes(array, (3 + blocks) * packing_.header_size);
    std::uint64_t packed_size = 0;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const std::uint64_t of_block = header_number(array, sizes, static_cast<std::size_t>(3 + b));
      if (of_block > content_.size() - std::min<std::uint64_t>(packed_size, content_.size())) throw ends_early(array);
      packed_size += of_block;
    }
    // Deflate makes at most 1,032 bytes of one, so no room is made for what cannot come.
    constexpr std::uint64_t kMaxRatio = 1032;
    if (size / kMaxRatio > packed_size) throw ends_early(array);
    const std::uint64_t begin = (3 + blocks) * packing_.header_size;
    const std::string packed = first_bytes(array, begin + packed_size);
    if (packed.size() != begin + packed_size) throw ends_early(array);
    char* to = make_room();
    std::size_t from = static_cast<std::size_t>(begin);
    for (std::uint64_t b = 0; b < blocks; ++b) {
      control_.check();
      const auto of_block = static_cast<std::size_t>(header_number(array, sizes, static_cast<std::size_t>(3 + b)));
      const std::size_t wanted =
          b + 1 < blocks || last == 0 ? static_cast<std::size_t>(block) : static_cast<std::size_t>(last);
      uLongf length = wanted;
      const int status = uncompress(reinterpret_cast<Bytef*>(to), &length,
                                    reinterpret_cast<const Bytef*>(packed.data() + from), of_block);
      if (status != Z_OK || length != wanted) throw vtk_error(array.begin, "an array that zlib cannot unpack");
      from += of_block;
      to += wanted;
    }
  }

  static Error ends_early(const PackedArray& array) { return vtk_error(array.begin, "an array whose data end early"); }
  static Error wrong_count(const PackedArray& array, std::uint64_t found, std::uint64_t wanted) {
    return vtk_error(array.begin, "the array " + cited(array.name) + " has another length (" + std::to_string(found) +
                                      ") than its piece tells (" + std::to_string(wanted) + ")");
  }

  std::string_view content_;
  const Packing& packing_;
  RunControl& control_;
  VtkMesh& mesh_;
};

class VtkXmlReader {
 public:
  VtkXmlReader(std::string_view content, const ReadLimits& limits, RunControl& control)
      : content_(content), mesh_(content, limits, control), arrays_(content, packing_, control, mesh_) {}

  ReadResult read() {
    parse();
    for (const PackedPiece& piece : pieces_) read_piece(piece);
    return mesh_.take();
  }

 private:
  void parse() {
    XmlTags tags(content_.starts_with(kUtf8Mark) ? content_.substr(kUtf8Mark.size()) : content_);
    const std::size_t mark = content_.starts_with(kUtf8Mark) ? kUtf8Mark.size() : 0;
    while (tags.next().kind != XmlTag::Kind::kEnd && !tags.tag().opens("VTKFile")) {
    }
    read_head(tags.tag());
    std::string_view section;
    bool is_in_grid = false;
    PackedPiece* piece = nullptr;
    for (const XmlTag* tag = &tags.next(); tag->kind != XmlTag::Kind::kEnd; tag = &tags.next()) {
      mesh_.tick(tag->end);
      if (tag->opens(type_)) {
        is_in_grid = true;
      } else if (tag->opens("Piece") && is_in_grid) {
        piece = &pieces_.emplace_back();
        piece->begin = mark + tag->begin;
        piece->points = number_attribute(*tag, "NumberOfPoints", 0);
        piece->cells = number_attribute(*tag, "NumberOfCells", 0);
        for (std::size_t i = 0; i < kCellSections.size(); ++i)
          piece->cells_of[i] = number_attribute(*tag, kCellSections[i].count, 0);
        if (tag->kind == XmlTag::Kind::kEmpty) piece = nullptr;
      } else if (tag->closes("Piece")) {
        piece = nullptr;
      } else if (tag->opens("DataArray") || tag->opens("Array")) {
        take_array(tags, section, piece, mark);
      } else if (tag->opens("AppendedData")) {
        const std::size_t begin = content_.find('_', mark + tag->end);
        if (begin == std::string_view::npos)
          throw vtk_error(mark + tag->begin, "appended data without a _ before them");
        packing_.appended = content_.substr(begin + 1);
        packing_.is_raw = tag->attribute("encoding").value_or("") == "raw";
        return;
      } else if (tag->kind == XmlTag::Kind::kOpen) {
        section = tag->name;
      } else if (tag->kind == XmlTag::Kind::kClose) {
        section = {};
      }
    }
  }

  void read_head(const XmlTag& tag) {
    if (tag.kind == XmlTag::Kind::kEnd) throw vtk_error(0, "not VTK's XML: there is no element VTKFile");
    type_ = tag.attribute("type").value_or("");
    if (type_ != "UnstructuredGrid" && type_ != "PolyData")
      throw vtk_error(tag.begin, "a VTK file of the type " + cited(type_) + "; UnstructuredGrid and PolyData are read");
    packing_.order =
        tag.attribute("byte_order").value_or("LittleEndian") == "BigEndian" ? ByteOrder::kBig : ByteOrder::kLittle;
    packing_.header_size = tag.attribute("header_type").value_or("UInt32") == "UInt64" ? 8 : 4;
    packing_.compressor = tag.attribute("compressor").value_or("");
    if (!packing_.compressor.empty() && packing_.compressor != "vtkZLibDataCompressor")
      throw vtk_error(tag.begin,
                      "arrays packed by " + cited(packing_.compressor) + " are not read, only vtkZLibDataCompressor");
  }

  void take_array(XmlTags& tags, std::string_view section, PackedPiece* piece, std::size_t mark) {
    const XmlTag tag = tags.tag();
    PackedArray array;
    array.section = section;
    array.type = tag.attribute("type").value_or("");
    array.name = xml_text(tag.attribute("Name").value_or(""));
    array.components = number_attribute(tag, "NumberOfComponents", 1);
    array.format = tag.attribute("format").value_or("ascii");
    array.offset = number_attribute(tag, "offset", 0);
    array.begin = mark + tag.end;
    if (section == "FieldData" && piece == nullptr) take_names(array, tag);
    if (tag.kind == XmlTag::Kind::kOpen) {
      tags.next();
      array.text = tags.text_before();
      // There may be elements inside of the array, such as the range of its values.
      while (tags.tag().kind != XmlTag::Kind::kEnd && !tags.tag().closes(tag.name)) {
        mesh_.tick(tags.tag().end);
        tags.next();
      }
    }
    if (piece != nullptr) piece->arrays.push_back(std::move(array));
  }

  /// Takes the names of labels, which are those of the components of an array `group_names`.
  void take_names(const PackedArray& array, const XmlTag& tag) {
    constexpr std::string_view kEnding = "_names";
    if (!array.name.ends_with(kEnding)) return;
    const auto kind = VtkMesh::kind_of(std::string_view(array.name).substr(0, array.name.size() - kEnding.size()));
    if (!kind) return;
    // One pass: to look for each name by itself would take time in proportion to the square of their number.
    constexpr std::string_view kPrefix = "ComponentName";
    std::string_view rest = tag.attributes;
    for (std::size_t at = rest.find(kPrefix); at != std::string_view::npos; at = rest.find(kPrefix)) {
      rest.remove_prefix(at + kPrefix.size());
      std::int64_t number = 0;
      const auto [stop, status] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
      const std::size_t quote = rest.find('"');
      const std::size_t end = quote == std::string_view::npos ? quote : rest.find('"', quote + 1);
      if (status != std::errc() || end == std::string_view::npos) return;
      mesh_.add_name(*kind, number, xml_text(rest.substr(quote + 1, end - quote - 1)));
      rest.remove_prefix(end + 1);
    }
  }

  void read_piece(const PackedPiece& piece) {
    const PackedArray* const points = find(piece, "Points", {});
    if (points == nullptr && piece.points > 0) throw vtk_error(piece.begin, "a piece without points");
    mesh_.begin_piece(piece.points, content_.size(), Place::byte(piece.begin));
    if (points != nullptr) {
      if (points->components != 3) throw vtk_error(points->begin, "the points do not have three coordinates");
      const std::vector<double> coordinates = arrays_.numbers<double>(*points, 3 * piece.points);
      for (std::size_t i = 0; i < coordinates.size(); i += 3) {
        mesh_.tick(points->begin);
        mesh_.add_point({coordinates[i], coordinates[i + 1], coordinates[i + 2]}, Place::byte(points->begin));
      }
    }
    std::uint64_t cells = piece.cells;
    if (type_ == "PolyData") {
      cells = 0;
      for (std::size_t i = 0; i < kCellSections.size(); ++i) {
        cells += piece.cells_of[i];
        read_cells(piece, kCellSections[i].element, piece.cells_of[i], kCellSections[i].type);
      }
    } else {
      read_cells(piece, "Cells", piece.cells, 0);
    }
    std::array<std::vector<std::int64_t>, 3> labels;
    for (const PackedArray& array : piece.arrays) {
      const auto kind = array.section == "CellData" ? VtkMesh::kind_of(array.name) : std::nullopt;
      if (kind && array.components == 1 && array.type != "String" && labels[static_cast<std::size_t>(*kind)].empty()) {
        labels[static_cast<std::size_t>(*kind)] = arrays_.numbers<std::int64_t>(array, cells);
      } else if (array.section == "CellData" || array.section == "PointData") {
        mesh_.drop_array();
      }
    }
    mesh_.end_piece(labels);
  }

  /// Reads the cells of an element. `type` is that of all of them; 0: each has its own.
  void read_cells(const PackedPiece& piece, std::string_view element, std::uint64_t count, int type) {
    if (count == 0) return;
    const PackedArray* const corners = find(piece, element, "connectivity");
    const PackedArray* const ends = find(piece, element, "offsets");
    const PackedArray* const types = find(piece, element, "types");
    if (corners == nullptr || ends == nullptr || (types == nullptr && type == 0))
      throw vtk_error(piece.begin, "cells without the arrays connectivity, offsets and types");
    // Each cell but a few has corners, so there are no more cells than the largest number of corners.
    if (count > mesh_.max_corners()) throw too_large_error(Place::byte(piece.begin), "cells", mesh_.max_corners());
    const std::vector<std::int64_t> end_of = arrays_.numbers<std::int64_t>(*ends, count);
    const std::int64_t last = end_of.back();
    if (last < 0 || static_cast<std::uint64_t>(last) > mesh_.max_corners())
      throw too_large_error(Place::byte(ends->begin), "corners of cells", mesh_.max_corners());
    const std::vector<std::int64_t> points = arrays_.numbers<std::int64_t>(*corners, static_cast<std::uint64_t>(last));
    std::vector<std::int64_t> type_of;
    if (type == 0) type_of = arrays_.numbers<std::int64_t>(*types, count);
    mesh_.expect_cells(end_of.size(), points.size());
    std::int64_t begin = 0;
    for (std::size_t c = 0; c < end_of.size(); ++c) {
      mesh_.tick(corners->begin);
      if (end_of[c] < begin || end_of[c] > last) throw vtk_error(ends->begin, "the offsets of cells do not ascend");
      mesh_.add_cell(
          type == 0 ? static_cast<int>(type_of[c]) : type,
          std::span(points).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end_of[c] - begin)),
          Place::byte(corners->begin));
      begin = end_of[c];
    }
  }

  /// Output: null if there is no such array. An empty name fits any.
  static const PackedArray* find(const PackedPiece& piece, std::string_view section, std::string_view name) {
    const auto found = std::find_if(piece.arrays.begin(), piece.arrays.end(), [&](const PackedArray& array) {
      return array.section == section && (name.empty() || array.name == name);
    });
    return found == piece.arrays.end() ? nullptr : &*found;
  }

  std::string_view content_;
  VtkMesh mesh_;
  std::string_view type_;
  Packing packing_;
  ArrayUnpacker arrays_;
  std::vector<PackedPiece> pieces_;
};

}  // namespace

ReadResult read_vtk_xml(std::string_view content, const ReadLimits& limits, RunControl& control) {
  return VtkXmlReader(content, limits, control).read();
}

bool is_legacy_vtk(std::string_view text) { return text.starts_with("# vtk DataFile"); }

ReadResult read_vtu(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  return is_legacy_vtk(content) ? read_vtk_legacy(content, limits, control) : read_vtk_xml(content, limits, control);
}

}  // namespace remesh
