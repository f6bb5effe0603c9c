#include "tests/mutate/polygon_soup.h"

#include <charconv>
#include <cstring>

namespace remesh::mutate {
namespace {

void append(std::string& out, double value) {
  char digits[32];
  out.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

void append(std::string& out, const Vec3& p, char separator) {
  append(out, p.x);
  out += separator;
  append(out, p.y);
  out += separator;
  append(out, p.z);
}

void append_face(std::string& out, const std::vector<std::uint32_t>& face, std::uint32_t first, char separator) {
  for (std::size_t k = 0; k < face.size(); ++k) {
    if (k > 0) out += separator;
    out += std::to_string(face[k] + first);
  }
}

template <class T>
void append_bytes(std::string& out, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

std::string write_obj(const PolygonSoup& soup) {
  std::string out;
  for (const Vec3& p : soup.positions) {
    out += "v ";
    append(out, p, ' ');
    out += '\n';
  }
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    if (!soup.groups.empty() && (f == 0 || soup.groups[f] != soup.groups[f - 1]))
      out += "g part" + std::to_string(soup.groups[f]) + "\n";
    out += "f ";
    append_face(out, soup.faces[f], 1, ' ');
    out += '\n';
  }
  return out;
}

std::string write_off(const PolygonSoup& soup) {
  std::string out = "OFF\n" + std::to_string(soup.positions.size()) + " " + std::to_string(soup.faces.size()) + " 0\n";
  for (const Vec3& p : soup.positions) {
    append(out, p, ' ');
    out += '\n';
  }
  for (const auto& face : soup.faces) {
    out += std::to_string(face.size()) + " ";
    append_face(out, face, 0, ' ');
    out += '\n';
  }
  return out;
}

/// Calls visit(a, b, c) with the corners of a fan of every face. Triangles with an index out of range are left out.
template <class Visit>
void for_each_triangle(const PolygonSoup& soup, const Visit& visit) {
  for (const auto& face : soup.faces) {
    for (std::size_t k = 2; k < face.size(); ++k) {
      if (face[0] >= soup.positions.size() || face[k - 1] >= soup.positions.size() || face[k] >= soup.positions.size())
        continue;
      visit(soup.positions[face[0]], soup.positions[face[k - 1]], soup.positions[face[k]]);
    }
  }
}

std::string write_stl_text(const PolygonSoup& soup) {
  std::string out = "solid made\n";
  for_each_triangle(soup, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const Vec3& p : {a, b, c}) {
      out += "vertex ";
      append(out, p, ' ');
      out += '\n';
    }
    out += "endloop\nendfacet\n";
  });
  return out + "endsolid made\n";
}

std::string write_stl_binary(const PolygonSoup& soup) {
  std::string out(84, ' ');
  std::uint32_t count = 0;
  for_each_triangle(soup, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    ++count;
    for (const Vec3& p : {Vec3{}, a, b, c})
      for (int axis = 0; axis < 3; ++axis) append_bytes(out, static_cast<float>(p[axis]));
    append_bytes(out, std::uint16_t{0});
  });
  std::memcpy(out.data() + 80, &count, sizeof count);
  return out;
}

std::string write_ply(const PolygonSoup& soup, bool is_binary) {
  std::string out = is_binary ? "ply\nformat binary_little_endian 1.0\n" : "ply\nformat ascii 1.0\n";
  out += "element vertex " + std::to_string(soup.positions.size());
  out += "\nproperty double x\nproperty double y\nproperty double z\n";
  out += "element face " + std::to_string(soup.faces.size());
  out += "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& p : soup.positions) {
    if (is_binary) {
      for (int axis = 0; axis < 3; ++axis) append_bytes(out, p[axis]);
    } else {
      append(out, p, ' ');
      out += '\n';
    }
  }
  for (const auto& face : soup.faces) {
    if (is_binary) {
      append_bytes(out, static_cast<std::uint8_t>(face.size()));
      for (const std::uint32_t v : face) append_bytes(out, v);
    } else {
      out += std::to_string(face.size()) + " ";
      append_face(out, face, 0, ' ');
      out += '\n';
    }
  }
  return out;
}

std::string write_json(const PolygonSoup& soup) {
  std::string out = "{\"vertices\": [";
  for (std::size_t v = 0; v < soup.positions.size(); ++v) {
    out += v == 0 ? "[" : ",\n[";
    append(out, soup.positions[v], ',');
    out += ']';
  }
  out += "],\n\"faces\": [";
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    out += f == 0 ? "[" : ",\n[";
    append_face(out, soup.faces[f], 0, ',');
    out += ']';
  }
  out += "]";
  if (!soup.groups.empty()) {
    out += ",\n\"face_groups\": [";
    append_face(out, soup.groups, 0, ',');
    out += "]";
  }
  return out + "}\n";
}

}  // namespace

PolygonSoup soup_of(const PolygonMesh& mesh) {
  PolygonSoup soup;
  soup.positions = mesh.positions.items();
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    std::vector<std::uint32_t>& face = soup.faces.emplace_back();
    for (const VertexId v : mesh.face(FaceId(f))) face.push_back(v.value);
  }
  for (const LabelSet* set : {&mesh.labels.group, &mesh.labels.object, &mesh.labels.material}) {
    if (!set->is_used()) continue;
    soup.groups = set->of_face.items();
    break;
  }
  return soup;
}

std::string write_soup(const PolygonSoup& soup, SoupFormat format) {
  switch (format) {
    case SoupFormat::kObj: return write_obj(soup);
    case SoupFormat::kOff: return write_off(soup);
    case SoupFormat::kStlText: return write_stl_text(soup);
    case SoupFormat::kStlBinary: return write_stl_binary(soup);
    case SoupFormat::kPlyText: return write_ply(soup, false);
    case SoupFormat::kPlyBinary: return write_ply(soup, true);
    case SoupFormat::kJson: return write_json(soup);
  }
  return {};
}

Format format_of(SoupFormat format) {
  switch (format) {
    case SoupFormat::kOff: return Format::kOff;
    case SoupFormat::kStlText:
    case SoupFormat::kStlBinary: return Format::kStl;
    case SoupFormat::kPlyText:
    case SoupFormat::kPlyBinary: return Format::kPly;
    case SoupFormat::kJson: return Format::kJson;
    case SoupFormat::kObj: break;
  }
  return Format::kObj;
}

}  // namespace remesh::mutate
