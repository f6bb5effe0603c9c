#include "api/comparison.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "api/json_writer.h"
#include "api/quoting.h"
#include "api/request_code.h"
#include "core/io/common/number_parsing.h"

namespace remesh::api {
namespace {

/// The far faces that an answer lists.
constexpr std::size_t kListedFaces = 100;

void write_position(JsonWriter& json, const Vec3& p) {
  json.begin_array();
  for (int axis = 0; axis < 3; ++axis) json.number(p[axis]);
  json.end_array();
}

void write_one_way(JsonWriter& json, const verification::OneWayDistance& way, bool has_tolerance) {
  json.begin_object();
  json.member("bound", way.bound);
  json.member("distance", way.distance);
  json.key("at");
  write_position(json, way.at);
  json.member("face", std::uint64_t{way.face.value});
  json.member("other_face", std::uint64_t{way.other_face.value});
  json.member("coarse", way.is_coarse);
  json.key("beyond");
  if (has_tolerance) {
    json.begin_object();
    json.member("count", way.far_count);
    json.key("faces");
    json.begin_array();
    for (std::size_t i = 0; i < std::min(kListedFaces, way.far_faces.size()); ++i) {
      json.begin_object();
      json.member("face", std::uint64_t{way.far_faces[i].face.value});
      json.member("bound", way.far_faces[i].bound);
      json.end_object();
    }
    json.end_array();
    json.end_object();
  } else {
    json.null();
  }
  json.end_object();
}

}  // namespace

void ComparisonOptions::add(std::string_view name, std::string_view text) {
  if (name != "tolerance")
    throw Error(as_code(RequestCode::kUnknownOption), Stage::kRead,
                "a comparison has the one option \"tolerance\", and not " + in_quotes(name))
        .for_option(shortened(name));
  const auto fail = [](const std::string& why) {
    throw Error(Code::kInvalidOption, Stage::kRead, "tolerance " + why).for_option("tolerance");
  };
  if (tolerance_) fail("is given twice");
  const Real real = parse_real(text);
  if (real.fault != RealFault::kNone || !(real.value > 0)) fail("must be a number above 0, and not " + in_quotes(text));
  tolerance_ = real.value;
}

std::optional<bool> ComparisonAnswer::is_within() const {
  if (!tolerance) return std::nullopt;
  return distance.a_to_b.bound <= *tolerance && distance.b_to_a.bound <= *tolerance;
}

ComparisonAnswer compare(ComparedMesh a, ComparedMesh b, std::optional<double> tolerance, const Limits& limits,
                         RunControl& control) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  ComparisonAnswer answer;
  answer.tolerance = tolerance;
  answer.input_faces = a.mesh.face_count() + b.mesh.face_count();
  answer.distance = compare_surfaces(a.mesh, b.mesh, tolerance,
                                     {.workers = limits.workers, .serial_corners = limits.serial_corners}, control);
  answer.times.add(Stage::kRead, a.read_ms + b.read_ms);
  answer.times.add(Stage::kVerify, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  return answer;
}

std::string comparison_document(const ComparisonAnswer& answer) {
  JsonWriter json;
  json.begin_object();
  json.key("a_to_b");
  write_one_way(json, answer.distance.a_to_b, answer.tolerance.has_value());
  json.key("b_to_a");
  write_one_way(json, answer.distance.b_to_a, answer.tolerance.has_value());
  json.member("diagonal", answer.distance.diagonal);
  json.member("tolerance", answer.tolerance);
  json.member("within", answer.is_within());
  json.end_object();
  return json.take() + "\n";
}

}  // namespace remesh::api
