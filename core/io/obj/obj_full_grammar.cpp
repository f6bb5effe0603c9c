#include <tiny_obj_loader.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <istream>
#include <streambuf>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/io/common/label_collector.h"
#include "core/io/common/number_parsing.h"
#include "core/io/common/read_errors.h"
#include "core/io/obj/obj_dropped_records.h"
#include "core/io/obj/obj_readers.h"
#include "core/io/obj/obj_records.h"

namespace remesh {
namespace {

/// Number of bytes between two checks for cancellation, which take a few milliseconds.
constexpr std::size_t kProgressStep = std::size_t{1} << 18;

/// Reads vertices itself and passes every other relevant record to tinyobjloader as a stream. It delivers one record
/// at a time, so in a callback `records_` is still at the record that the callback is about.
class ObjReader final : private std::streambuf {
 public:
  ObjReader(std::string_view text, const ReadLimits& limits, RunControl& control)
      : text_size_(text.size()), records_(text), limits_(limits), control_(control) {}

  ReadResult read() {
    std::istream stream(this);
    stream.exceptions(std::ios::badbit);  // lets exceptions from underflow() pass through
    tinyobj::callback_t callbacks;
    callbacks.index_cb = [](void* reader, tinyobj::index_t* corners, int count) {
      static_cast<ObjReader*>(reader)->add_face(corners, count);
    };
    callbacks.object_cb = [](void* reader, const char* name) { static_cast<ObjReader*>(reader)->object_.name(name); };
    callbacks.group_cb = [](void* reader, const char** names, int count) {
      static_cast<ObjReader*>(reader)->group_.name(join(names, count));
    };
    callbacks.usemtl_cb = [](void* reader, const char* name, int) {
      static_cast<ObjReader*>(reader)->material_.name(name);
    };
    tinyobj::LoadObjWithCallback(stream, callbacks, this);
    return finish();
  }

 private:
  /// The stream calls this when the last delivered record has been consumed.
  int_type underflow() override {
    delivery_.clear();
    while (delivery_.empty() && records_.next()) {
      report_progress();
      take_record();
    }
    setg(delivery_.data(), delivery_.data(), delivery_.data() + delivery_.size());
    return delivery_.empty() ? traits_type::eof() : traits_type::to_int_type(delivery_.front());
  }

  void take_record() {
    const std::string_view keyword = records_.keyword();
    if (keyword == "v") {
      add_vertex(records_.arguments());
    } else if (keyword == "f" || keyword == "fo") {
      deliver_face(records_.arguments());
    } else if (keyword == "g" || keyword == "o" || keyword == "usemtl") {
      deliver_name(keyword, trim(records_.arguments()));
    } else if (keyword == "mtllib") {
      const std::string_view files = trim(records_.arguments());
      if (!files.empty()) mesh_.labels.material_libraries.emplace_back(files);
    } else {
      extras_.dropped.count(keyword);
    }
  }

  void add_vertex(std::string_view arguments) {
    const std::uint64_t id = mesh_.vertex_count();
    if (id >= limits_.max_vertices) throw too_large("vertices", limits_.max_vertices);
    Vec3 position;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view token = next_value(arguments);
      if (!token.empty()) {
        position[axis] = coordinate(token);
      } else if (axis == 2) {
        extras_.missing_z.add(id);
      } else {
        throw vertex_error(Code::kInvalidMesh, "a vertex with fewer than two coordinates");
      }
    }
    if (!next_value(arguments).empty()) extras_.extra_values.add(id);
    mesh_.positions.push_back(position);
  }

  double coordinate(std::string_view token) const {
    const Real real = parse_real(token);
    switch (real.fault) {
      case RealFault::kNone: break;
      case RealFault::kNotANumber: throw vertex_error(Code::kInvalidMesh, "a coordinate that is not a number");
      case RealFault::kNotFinite: throw vertex_error(Code::kNonfiniteCoordinate, "a coordinate that is not finite");
    }
    return real.value;
  }

  /// Checks a face and delivers its vertex indices alone, because tinyobjloader would accept more than it should.
  void deliver_face(std::string_view arguments) {
    if (mesh_.face_count() >= limits_.max_faces) throw too_large("faces", limits_.max_faces);
    const std::uint64_t max_corners = std::min(kMaxObjFaceCorners, PolygonMesh::kMaxCorners - mesh_.corners.size());
    std::uint64_t corners = 0;
    delivery_ = "f";
    for (auto token = next_value(arguments); !token.empty(); token = next_value(arguments)) {
      if (++corners > max_corners) throw too_large("face corners", max_corners);
      delivery_ += ' ';
      delivery_ += checked_vertex(token);
    }
    delivery_ += '\n';
    if (corners < 3) throw face_error(Code::kInvalidMesh, "a face with fewer than three corners");
  }

  /// Returns the vertex part of a corner (`i`, `i/j`, `i//k`, `i/j/k`, where the numbers after a slash may be
  /// missing).
  std::string_view checked_vertex(std::string_view corner) {
    const char* at = corner.data();
    const char* const end = at + corner.size();
    const int index = take_integer(at, end);
    const std::string_view vertex(corner.data(), static_cast<std::size_t>(at - corner.data()));
    for (int part = 0; part < 2 && at != end && *at == '/'; ++part) {
      ++at;
      if (at != end && *at != '/') take_integer(at, end);
    }
    if (at != end) throw malformed_corner();
    check_vertex_index(index);
    return vertex;
  }

  int take_integer(const char*& at, const char* end) const {
    int value = 0;
    const auto [stop, status] = std::from_chars(at, end, value);
    if (status == std::errc::invalid_argument) throw malformed_corner();
    if (status == std::errc::result_out_of_range) {
      throw face_error(Code::kIndexOutOfRange, "a face with an index of more than 32 bits");
    }
    at = stop;
    return value;
  }

  /// Checks an index. A positive index may refer to a later vertex, so it is compared with the number of vertices at
  /// the end of the text.
  void check_vertex_index(int index) {
    const std::uint64_t vertices = mesh_.vertex_count();
    if (index == 0) throw face_error(Code::kIndexOutOfRange, "a face with the index 0; the first vertex is 1");
    if (index < 0 && static_cast<std::uint64_t>(-std::int64_t{index}) > vertices) {
      throw face_error(Code::kIndexOutOfRange, out_of_range_message(index, vertices) + " vertices before it");
    }
    if (index > 0 && static_cast<std::uint64_t>(index) > vertices &&
        (references_ahead_.empty() || index > references_ahead_.back().index)) {
      references_ahead_.push_back({index, records_.line(), mesh_.face_count()});
    }
  }

  void deliver_name(std::string_view keyword, std::string_view name) {
    if (name.size() > kMaxNameLength) {
      throw error(Code::kInvalidMesh, "a name of more than " + std::to_string(kMaxNameLength) + " bytes");
    }
    delivery_ = keyword;
    delivery_ += ' ';
    delivery_ += name;
    delivery_ += '\n';
  }

  void add_face(const tinyobj::index_t* corners, int count) {
    const std::size_t faces_before = mesh_.face_count();
    for (LabelCollector* labels : {&object_, &group_, &material_}) labels->add_face(faces_before);
    for (int i = 0; i < count; ++i) {
      const std::int64_t index = corners[i].vertex_index;
      const std::int64_t from_zero = index > 0 ? index - 1 : index + static_cast<std::int64_t>(mesh_.vertex_count());
      mesh_.corners.emplace_back(static_cast<std::uint32_t>(from_zero));
    }
    mesh_.face_begin.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
  }

  ReadResult finish() {
    for (const auto& reference : references_ahead_) {
      if (static_cast<std::uint64_t>(reference.index) > mesh_.vertex_count()) {
        throw read_error(Place::line(reference.line), Code::kIndexOutOfRange,
                         out_of_range_message(reference.index, mesh_.vertex_count()))
            .at_element(reference.face);
      }
    }
    if (mesh_.face_count() == 0) throw Error(Code::kEmptyMesh, Stage::kRead, "the text has no face");

    ReadResult result;
    mesh_.labels.object = object_.take();
    mesh_.labels.group = group_.take();
    mesh_.labels.material = material_.take();
    result.mesh = std::move(mesh_);
    result.diagnostics = std::move(extras_).diagnostics();
    return result;
  }

  void report_progress() {
    if (records_.offset() < next_progress_) return;
    control_.progress(static_cast<double>(records_.offset()) / static_cast<double>(text_size_));
    next_progress_ = records_.offset() + kProgressStep;
  }

  /// Returns the next token. A comment after the values ends them.
  static std::string_view next_value(std::string_view& arguments) {
    const std::string_view token = next_token(arguments);
    if (!token.starts_with('#')) return token;
    arguments = {};
    return {};
  }

  static std::string join(const char** names, int count) {
    std::string joined;
    for (int i = 0; i < count; ++i) {
      if (i > 0) joined += ' ';
      joined += names[i];
    }
    return joined;
  }

  static std::string out_of_range_message(int index, std::uint64_t vertices) {
    return "a face refers to vertex " + std::to_string(index) + ", but the mesh has only " + std::to_string(vertices);
  }

  Place here() const { return Place::line(records_.line()); }
  Error error(Code code, const std::string& message) const { return read_error(here(), code, message); }
  Error vertex_error(Code code, const std::string& message) const {
    return error(code, message).at_element(mesh_.vertex_count());
  }
  Error face_error(Code code, const std::string& message) const {
    return error(code, message).at_element(mesh_.face_count());
  }
  Error too_large(const std::string& what, std::uint64_t limit) const { return too_large_error(here(), what, limit); }
  Error malformed_corner() const {
    return face_error(Code::kInvalidMesh, "a face corner that has none of the forms i, i/j, i//k, i/j/k");
  }

  struct ReferenceAhead {
    int index;
    std::uint64_t line;
    std::uint64_t face;
  };

  std::size_t text_size_;
  ObjRecords records_;
  const ReadLimits& limits_;
  RunControl& control_;
  PolygonMesh mesh_;
  LabelCollector object_, group_, material_;
  ObjExtras extras_;
  /// Each index is larger than all before it, so the first one that is out of range is on the first such line.
  std::vector<ReferenceAhead> references_ahead_;
  std::string delivery_;
  std::size_t next_progress_ = kProgressStep;
};

}  // namespace

ReadResult read_obj_full_grammar(std::string_view text, const ReadLimits& limits, RunControl& control) {
  control.enter(Stage::kRead);
  return ObjReader(text, limits, control).read();
}

}  // namespace remesh
