#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/io/common/affine_map.h"
#include "core/io/common/label_collector.h"
#include "core/io/common/mesh_builder.h"
#include "core/io/threemf/threemf.h"
#include "core/io/threemf/zip.h"
#include "core/io/vtu/xml_elements.h"

namespace remesh {
namespace {

Error model_error(std::size_t at, const std::string& message) {
  return read_error(Place::byte(at), Code::kInvalidMesh, message);
}

/// A base material: the number of its group, and its place in the group.
struct MaterialOf3mf {
  std::uint64_t group = 0, index = 0;
};

struct TriangleOf3mf {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t material;  ///< an index into ObjectOf3mf::materials
};

struct ComponentOf3mf {
  std::uint64_t object = 0;
  AffineMap map;
};

/// An object has triangles or components.
struct ObjectOf3mf {
  std::string name;
  std::optional<MaterialOf3mf> material;
  std::vector<Vec3> points;
  std::vector<TriangleOf3mf> triangles;
  std::vector<std::optional<MaterialOf3mf>> materials;
  std::vector<ComponentOf3mf> components;
};

/// Reads a model from an archive.
/// This class is larger than the bound because it has six counters, which all limits need.
class ThreemfReader {
 public:
  ThreemfReader(std::string_view content, const ReadLimits& limits, RunControl& control)
      : limits_(limits), control_(control), builder_(limits, control) {
    const ZipArchive archive(content);
    model_ = archive.read(model_name(archive), limits.decompression, control);
  }

  ReadResult read() {
    parse();
    for (const ComponentOf3mf& item : build_) add_item(item);
    ReadResult result;
    result.mesh = builder_.take();
    result.mesh.labels.object = objects_labels_.take();
    result.mesh.labels.material = materials_labels_.take();
    result.unit = unit_;
    result.up_axis = "z";
    record_dropped(
        "colours, textures and other properties of triangles were dropped; number of triangles that had them", dropped_,
        result.diagnostics);
    return result;
  }

 private:
  /// Finds the name of the model in the archive, which is that of a relationship.
  std::string model_name(const ZipArchive& archive) const {
    constexpr std::string_view kRelationships = "_rels/.rels", kUsual = "3D/3dmodel.model";
    if (!archive.has(kRelationships)) return std::string(kUsual);
    const std::string text = archive.read(kRelationships, limits_.decompression, control_);
    XmlTags tags(text);
    while (tags.next().kind != XmlTag::Kind::kEnd) {
      const XmlTag& tag = tags.tag();
      if (tag.opens("Relationship") && tag.attribute("Type").value_or("").ends_with("/3dmodel"))
        return xml_text(tag.attribute("Target").value_or(kUsual));
    }
    return std::string(kUsual);
  }

  void parse() {
    XmlTags tags(model_);
    bool is_in_build = false, has_model = false;
    ObjectOf3mf* object = nullptr;
    std::uint64_t group = 0;
    while (tags.next().kind != XmlTag::Kind::kEnd) {
      const XmlTag& tag = tags.tag();
      tick(tag.end);
      if (tag.opens("triangle") && object != nullptr) {
        add_triangle(tag, *object);
      } else if (tag.opens("vertex") && object != nullptr) {
        add_vertex(tag, *object);
      } else if (tag.opens("component") && object != nullptr) {
        object->components.push_back(component_of(tag));
        // Objects that stand before those that use them form no circles.
        if (object->components.back().object == last_id_ || !objects_.contains(object->components.back().object))
          throw model_error(tag.begin, "a component whose object does not stand before it");
      } else if (tag.opens("item") && is_in_build) {
        build_.push_back(component_of(tag));
      } else if (tag.opens("object")) {
        last_id_ = tag.number("id").value_or(0);
        const auto [entry, is_new] = objects_.try_emplace(last_id_);
        if (!is_new) throw model_error(tag.begin, "two objects with the id " + std::to_string(last_id_));
        object = &entry->second;
        const auto name = tag.attribute("name");
        object->name = name ? xml_text(*name) : "object_" + std::to_string(last_id_);
        if (object->name.size() > kMaxNameLength) object->name.resize(kMaxNameLength);
        if (const auto pid = tag.number("pid")) object->material = {*pid, tag.number("pindex").value_or(0)};
        object->materials.push_back(object->material);
        if (tag.kind == XmlTag::Kind::kEmpty) object = nullptr;
      } else if (tag.closes("object")) {
        object = nullptr;
      } else if (tag.opens("basematerials")) {
        group = tag.number("id").value_or(0);
      } else if (tag.opens("base")) {
        materials_[group].push_back(xml_text(tag.attribute("name").value_or("")));
      } else if (tag.name == "build") {
        is_in_build = tag.kind == XmlTag::Kind::kOpen;
      } else if (tag.opens("model")) {
        has_model = true;
        unit_ = tag.attribute("unit").value_or("millimeter");
        const std::string_view required = trim(tag.attribute("requiredextensions").value_or(""));
        // Materials and colours may be left out; all other extensions change the shape or where it stands.
        if (!required.empty() && required != "m")
          throw model_error(tag.begin, "the extensions " + cited(required) + " are required, but not read");
      }
    }
    if (!has_model) throw model_error(0, "not 3MF: the archive has no model");
  }

  void add_vertex(const XmlTag& tag, ObjectOf3mf& object) {
    if (++vertices_read_ > limits_.max_vertices)
      throw too_large_error(Place::byte(tag.begin), "vertices", limits_.max_vertices);
    Vec3 p;
    constexpr std::array<std::string_view, 3> kNames{"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = tag.attribute(kNames[static_cast<std::size_t>(axis)]);
      if (!value) throw model_error(tag.begin, "a vertex with fewer than three coordinates");
      p[axis] = parse_coordinate(trim(*value), Place::byte(tag.begin));
    }
    object.points.push_back(p);
  }

  void add_triangle(const XmlTag& tag, ObjectOf3mf& object) {
    if (++triangles_read_ > limits_.max_faces)
      throw too_large_error(Place::byte(tag.begin), "faces", limits_.max_faces);
    TriangleOf3mf triangle{};
    constexpr std::array<std::string_view, 3> kNames{"v1", "v2", "v3"};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto corner = tag.number(kNames[i]);
      if (!corner) throw model_error(tag.begin, "a triangle with fewer than three corners");
      if (*corner >= object.points.size())
        throw read_error(Place::byte(tag.begin), Code::kIndexOutOfRange,
                         "a triangle refers to vertex " + std::to_string(*corner) + "; there are " +
                             std::to_string(object.points.size()) + ", counted from 0");
      triangle.corners[i] = static_cast<std::uint32_t>(*corner);
    }
    if (const auto index = tag.number("p1")) {
      MaterialOf3mf material{object.material ? object.material->group : 0, *index};
      if (const auto pid = tag.number("pid")) material.group = *pid;
      const auto& last = object.materials.back();
      if (!last || last->group != material.group || last->index != material.index) object.materials.push_back(material);
      triangle.material = static_cast<std::uint32_t>(object.materials.size() - 1);
    }
    object.triangles.push_back(triangle);
  }

  ComponentOf3mf component_of(const XmlTag& tag) const {
    ComponentOf3mf component;
    component.object = tag.number("objectid").value_or(0);
    const auto transform = tag.attribute("transform");
    if (!transform) return component;
    std::string_view rest = *transform;
    std::array<double, 12> m{};
    for (double& value : m) {
      const std::string_view token = next_token(rest);
      if (token.empty()) throw model_error(tag.begin, "a transform with fewer than 12 numbers");
      value = parse_coordinate(token, Place::byte(tag.begin));
    }
    // Points are rows there, which are multiplied from the left.
    component.map = {{{{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}}}, {m[9], m[10], m[11]}};
    return component;
  }

  /// Adds the triangles of an item and of all its components.
  void add_item(const ComponentOf3mf& item) {
    std::vector<ComponentOf3mf> stack{item};
    const auto root = objects_.find(item.object);
    if (root == objects_.end()) throw model_error(0, "the build lists an object that is not there");
    objects_labels_.name(root->second.name);
    while (!stack.empty()) {
      control_.check();
      const ComponentOf3mf use = stack.back();
      stack.pop_back();
      // Objects without triangles may use each other so often that it would never end.
      if (++uses_ > limits_.max_faces) throw too_large_error(Place::byte(0), "components", limits_.max_faces);
      const ObjectOf3mf& object = objects_.at(use.object);
      add_triangles(object, use.map);
      for (auto part = object.components.rbegin(); part != object.components.rend(); ++part)
        stack.push_back({part->object, use.map.after(part->map)});
    }
  }

  void add_triangles(const ObjectOf3mf& object, const AffineMap& map) {
    if (object.points.size() > limits_.max_vertices - vertices_)
      throw too_large_error(Place::byte(0), "vertices", limits_.max_vertices);
    if (object.triangles.size() > limits_.max_faces - builder_.mesh().face_count())
      throw too_large_error(Place::byte(0), "faces", limits_.max_faces);
    const std::uint64_t base = vertices_;
    vertices_ += object.points.size();
    builder_.announce(vertices_, 0, 0, 0, Place::byte(0));
    for (const Vec3& p : object.points) {
      tick(model_.size());
      builder_.add_vertex(map(p), Place::byte(0));
    }
    const bool turns_over = map.turns_over();
    std::uint32_t last = kNone;
    for (const TriangleOf3mf& triangle : object.triangles) {
      tick(model_.size());
      if (triangle.material != last) {
        last = triangle.material;
        materials_labels_.name(name_of(object.materials[last]));
      }
      if (object.materials[last] && !materials_.contains(object.materials[last]->group)) ++dropped_;
      objects_labels_.add_face(builder_.mesh().face_count());
      materials_labels_.add_face(builder_.mesh().face_count());
      builder_.begin_face(3, Place::byte(0));
      for (const std::size_t i : turns_over ? std::array<std::size_t, 3>{0, 2, 1} : std::array<std::size_t, 3>{0, 1, 2})
        builder_.add_corner(static_cast<std::int64_t>(base + triangle.corners[i]), Place::byte(0));
    }
  }

  std::string name_of(const std::optional<MaterialOf3mf>& material) const {
    if (!material) return "";
    const auto group = materials_.find(material->group);
    if (group == materials_.end() || material->index >= group->second.size()) return "";
    const std::string& name = group->second[material->index];
    return name.size() <= kMaxNameLength ? name : name.substr(0, kMaxNameLength);
  }

  void tick(std::size_t offset) { builder_.tick(offset, model_.size()); }

  const ReadLimits& limits_;
  RunControl& control_;
  MeshBuilder builder_;
  std::string model_;
  std::string unit_;
  std::map<std::uint64_t, ObjectOf3mf> objects_;
  std::map<std::uint64_t, std::vector<std::string>> materials_;
  std::vector<ComponentOf3mf> build_;
  LabelCollector objects_labels_, materials_labels_;
  std::uint64_t last_id_ = 0, vertices_read_ = 0, triangles_read_ = 0, vertices_ = 0, uses_ = 0, dropped_ = 0;
};

}  // namespace

ReadResult read_threemf(std::string_view content, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  return ThreemfReader(content, limits, control).read();
}

}  // namespace remesh
