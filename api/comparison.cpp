#include "api/comparison.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <utility>

#include "api/json_writer.h"
#include "api/quoting.h"
#include "api/request_code.h"
#include "core/io/common/number_parsing.h"

namespace remesh::api {
namespace {

/// The far faces that an answer lists.
constexpr std::size_t kListedFaces = 100;

void write_one_way(JsonWriter& json, const verification::OneWayDistance& way, bool has_tolerance) {
  json.member("bound", way.bound);
  json.member("distance", way.distance);
  json.values("at", std::array{way.at.x, way.at.y, way.at.z});
  json.member("face", std::uint64_t{way.face.value});
  json.member("other_face", std::uint64_t{way.other_face.value});
  json.member("coarse", way.is_coarse);
  json.key("beyond");
  if (!has_tolerance) return json.null();
  json.object([&] {
    json.member("count", way.far_count);
    const std::span far_faces(way.far_faces);
    json.objects("faces", far_faces.first(std::min(kListedFaces, far_faces.size())), [&](const auto& far) {
      json.member("face", std::uint64_t{far.face.value});
      json.member("bound", far.bound);
    });
  });
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
  const bool has_tolerance = answer.tolerance.has_value();
  json.object([&] {
    json.object("a_to_b", [&] { write_one_way(json, answer.distance.a_to_b, has_tolerance); });
    json.object("b_to_a", [&] { write_one_way(json, answer.distance.b_to_a, has_tolerance); });
    json.member("diagonal", answer.distance.diagonal);
    json.member("tolerance", answer.tolerance);
    json.member("within", answer.is_within());
  });
  return json.take() + "\n";
}

}  // namespace remesh::api
