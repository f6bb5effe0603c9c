#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "core/base/stoppable.h"
#include "core/io/common/bytes.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/write_text.h"
#include "core/io/vtu/vtu.h"
#include "core/mesh/quality.h"

namespace remesh {
namespace {

constexpr std::uint8_t kTypeOfTriangles = 5;

/// Appends `data` in base64.
void append_base64(std::string& out, std::string_view data, RunControl& control) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte = [&](std::size_t i) { return i < data.size() ? static_cast<unsigned char>(data[i]) : 0u; };
  out.reserve(out.size() + (data.size() + 2) / 3 * 4);
  StopCheck check(control);
  for (std::size_t i = 0; i < data.size(); i += 3) {
    check();
    const unsigned bits = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    out += kDigits[bits >> 18];
    out += kDigits[bits >> 12 & 63];
    out += i + 1 < data.size() ? kDigits[bits >> 6 & 63] : '=';
    out += i + 2 < data.size() ? kDigits[bits & 63] : '=';
  }
}

/// One array of numbers. Its bytes are collected after their length, which is the form that VTK expects.
class DataArray {
 public:
  DataArray(std::string attributes, std::size_t bytes, RunControl& control)
      : attributes_(std::move(attributes)), control_(control), check_(control) {
    data_.reserve(sizeof(std::uint64_t) + bytes);
    append_little_endian(data_, std::uint64_t{bytes});
  }
  template <class T>
  void add(T value) {
    check_();
    append_little_endian(data_, value);
  }
  void write(std::string& out) {
    out += "<DataArray " + attributes_ + " format=\"binary\">\n";
    append_base64(out, data_, control_);
    out += "\n</DataArray>\n";
    std::string().swap(data_);
  }

 private:
  std::string attributes_;
  RunControl& control_;
  StopCheck check_;
  std::string data_;
};

std::string typed(std::string_view type, std::string_view name) {
  return "type=\"" + std::string(type) + "\" Name=\"" + std::string(name) + "\"";
}

/// Appends a comment in valid UTF-8 that cannot end early. Two hyphens would end it, and names may be in any
/// encoding.
void append_comment(std::string& out, std::string_view line) {
  out += "<!-- ";
  char last = ' ';
  while (!line.empty()) {
    const std::size_t length = utf8_length(line);
    const bool is_allowed = length > 0 && !(line.front() == '-' && last == '-');
    if (is_allowed) {
      out += line.substr(0, length);
    } else {
      out += '?';
    }
    last = is_allowed ? line.front() : '?';
    line.remove_prefix(std::max<std::size_t>(length, 1));
  }
  out += " -->\n";
}

using LabelKinds = std::array<std::pair<std::string_view, const LabelSet*>, 3>;

/// Appends the value of an attribute in valid UTF-8.
void append_attribute(std::string& out, std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    switch (text.front()) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;  // for VTK the data of the array begin behind the first one in the file
      case '"': out += "&quot;"; break;
      default: length > 0 ? out += text.substr(0, length) : out += '?';
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
}

/// Writes the names of labels as the names of an array's components, in which ParaView shows them. The components have
/// the numbers of the labels as values. An array of strings would be the usual form, but meshio reads no file that has
/// one.
void write_names(std::string& out, const LabelKinds& kinds, RunControl& control) {
  // VTK takes time in proportion to the square of the number of components.
  constexpr std::size_t kMaxNames = 1000;
  out += "<FieldData>\n";
  for (const auto& [kind, set] : kinds) {
    const std::size_t n = set->names.size();
    if (!set->is_used() || n > kMaxNames) continue;
    std::string attributes = typed("Int32", std::string(kind) + "_names") +
                             " NumberOfTuples=\"1\" NumberOfComponents=\"" + std::to_string(n) + "\"";
    for (std::size_t i = 0; i < n; ++i) {
      attributes += " ComponentName" + std::to_string(i) + "=\"";
      append_attribute(attributes, without_control_characters(set->names[i]));
      attributes += '"';
    }
    DataArray numbers(std::move(attributes), sizeof(std::int32_t) * n, control);
    for (std::size_t i = 0; i < n; ++i) numbers.add(static_cast<std::int32_t>(i));
    numbers.write(out);
  }
  out += "</FieldData>\n";
}

void write_points(std::string& out, const TriangleMesh& mesh, WriteProgress& progress, RunControl& control) {
  DataArray points(typed("Float64", "Points") + " NumberOfComponents=\"3\"", 3 * sizeof(double) * mesh.positions.size(),
                   control);
  for (const Vec3& position : mesh.positions) {
    progress.tick();
    for (int axis = 0; axis < 3; ++axis) points.add(position[axis]);
  }
  out += "<Points>\n";
  points.write(out);
  out += "</Points>\n";
}

void write_cells(std::string& out, const TriangleMesh& mesh, WriteProgress& progress, RunControl& control) {
  const std::size_t n = mesh.faces.size();
  out += "<Cells>\n";
  DataArray connectivity(typed("Int64", "connectivity"), 3 * sizeof(std::int64_t) * n, control);
  DataArray offsets(typed("Int64", "offsets"), sizeof(std::int64_t) * n, control);
  DataArray types(typed("UInt8", "types"), n, control);
  std::int64_t offset = 0;
  for (const Triangle& face : mesh.faces) {
    progress.tick();
    for (const VertexId v : face) connectivity.add(std::int64_t{v.value});
    offsets.add(offset += 3);
    types.add(kTypeOfTriangles);
  }
  connectivity.write(out);
  offsets.write(out);
  types.write(out);
  out += "</Cells>\n";
}

void write_cell_data(std::string& out, const WriterInput& input, const LabelKinds& kinds, RunControl& control) {
  const std::size_t n = input.mesh.faces.size();
  out += "<CellData Scalars=\"patch\">\n";
  DataArray patch(typed("Int32", "patch"), sizeof(std::int32_t) * n, control);
  for (const PatchId p : input.face_patch) patch.add(static_cast<std::int32_t>(p.value));
  patch.write(out);
  if (!input.surface_of_patch.empty()) {
    DataArray surface(typed("Int32", "surface"), sizeof(std::int32_t) * n, control);
    for (const PatchId p : input.face_patch)
      surface.add(static_cast<std::int32_t>(input.surface_of_patch[p.value].value));
    surface.write(out);
  }
  for (const auto& [kind, set] : kinds) {
    if (!set->is_used()) continue;
    DataArray labels(typed("Int32", kind), sizeof(std::int32_t) * n, control);
    for (const std::uint32_t label : set->of_face) labels.add(static_cast<std::int32_t>(label));
    labels.write(out);
  }
  const IdVector<FaceId, FaceQuality> quality = face_quality(input.mesh, control);
  const std::pair<std::string_view, double FaceQuality::*> measures[] = {
      {"min_angle_deg", &FaceQuality::min_angle_deg},
      {"radius_edge_ratio", &FaceQuality::radius_edge_ratio},
      {"aspect_ratio", &FaceQuality::aspect_ratio}};
  for (const auto& [name, measure] : measures) {
    DataArray values(typed("Float64", name), sizeof(double) * n, control);
    for (const FaceQuality& face : quality) values.add(face.*measure);
    values.write(out);
  }
  out += "</CellData>\n";
}

}  // namespace

std::string write_vtu(const WriterInput& input, RunControl& control) {
  control.enter(Stage::kWrite);
  const TriangleMesh& mesh = input.mesh;
  const LabelKinds kinds{
      {{"object", &mesh.labels.object}, {"group", &mesh.labels.group}, {"material", &mesh.labels.material}}};
  WriteProgress progress(mesh.positions.size() + mesh.faces.size(), control);
  std::string out = "<?xml version=\"1.0\"?>\n";
  for (const std::string& comment : input.comments) {
    for (const std::string& line : comment_lines(comment)) append_comment(out, line);
  }
  for (const auto& [kind, set] : kinds) {
    for (std::size_t i = 0; set->is_used() && i < set->names.size(); ++i) {
      append_comment(out,
                     std::string(kind) + " " + std::to_string(i) + ": " + without_control_characters(set->names[i]));
    }
  }
  out +=
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<UnstructuredGrid>\n";
  if (std::any_of(kinds.begin(), kinds.end(), [](const auto& kind) { return kind.second->is_used(); }))
    write_names(out, kinds, control);
  out += "<Piece NumberOfPoints=\"" + std::to_string(mesh.positions.size()) + "\" NumberOfCells=\"" +
         std::to_string(mesh.faces.size()) + "\">\n";
  write_points(out, mesh, progress, control);
  write_cells(out, mesh, progress, control);
  write_cell_data(out, input, kinds, control);
  out += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return out;
}

}  // namespace remesh
