/// Measures reading and writing of text. For comparison, it measures the libraries, and a loop that does the least that
/// any reader must do.
/// Usage: io_bench FILE.obj RUNS; prints the times of all runs as JSON, in milliseconds: {"name": [...], ...}.
#include <tbb/task_arena.h>
#include <tiny_obj_loader.h>

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "api/json_reader.h"
#include "core/io/obj.h"
#include "tests/bench/json_text.h"
#include "tests/bench/timing.h"
#include "tests/support/shapes.h"

namespace remesh::bench {
namespace {

/// Reads the numbers of `v` and `f` records in the plainest loop. It finds no error and knows no grammar.
std::size_t read_numbers(const std::string& text) {
  std::vector<double> coordinates;
  std::vector<int> indices;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto take = [&](auto value, auto& values) {
    while (at != end && *at == ' ') ++at;
    const auto [stop, status] = std::from_chars(at, end, value);
    if (stop == at) return false;
    at = stop;
    values.push_back(value);
    return true;
  };
  while (at != end) {
    const char kind = *at++;
    if (kind == 'v')
      for (int axis = 0; axis < 3; ++axis) take(0.0, coordinates);
    if (kind == 'f')
      while (take(0, indices)) {
      }
    while (at != end && *at != '\n') ++at;
    if (at != end) ++at;
  }
  return coordinates.size() + indices.size();
}

void read_by_tinyobjloader(const std::string& text) {
  std::istringstream stream(text);
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &stream, nullptr, false);
}

/// Takes every event of nlohmann-json's parser and drops it.
struct Nothing {
  double sum = 0;
  bool null() { return true; }
  bool boolean(bool) { return true; }
  bool number_integer(std::int64_t) { return true; }
  bool number_unsigned(std::uint64_t value) {
    sum += static_cast<double>(value);
    return true;
  }
  bool number_float(double value, const std::string&) {
    sum += value;
    return true;
  }
  bool string(std::string&) { return true; }
  bool binary(nlohmann::json::binary_t&) { return true; }
  bool start_object(std::size_t) { return true; }
  bool key(std::string&) { return true; }
  bool end_object() { return true; }
  bool start_array(std::size_t) { return true; }
  bool end_array() { return true; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) { return false; }
};

int run(const char* path, int runs) {
  std::ifstream file(path, std::ios::binary);
  const std::string obj{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  const TriangleMesh mesh = shapes::as_triangles(read_obj(obj, {}, control).mesh);
  const std::string json = json_of(mesh);
  std::map<std::string, std::vector<double>> times;
  tbb::task_arena one(1), two(2);
  // They alternate, so that changes in the speed of the machine affect all alike.
  for (int i = 0; i < runs; ++i) {
    times["from_chars loop"].push_back(milliseconds([&] { (void)read_numbers(obj); }));
    times["tinyobjloader"].push_back(milliseconds([&] { read_by_tinyobjloader(obj); }));
    times["read_obj, 1 thread"].push_back(
        milliseconds([&] { one.execute([&] { (void)read_obj(obj, {}, control); }); }));
    times["read_obj, 2 threads"].push_back(
        milliseconds([&] { two.execute([&] { (void)read_obj(obj, {}, control); }); }));
    times["write_obj, 1 thread"].push_back(
        milliseconds([&] { one.execute([&] { (void)write_obj(mesh, {}, control); }); }));
    times["write_obj, 2 threads"].push_back(
        milliseconds([&] { two.execute([&] { (void)write_obj(mesh, {}, control); }); }));
    times["nlohmann-json, events"].push_back(milliseconds([&] {
      Nothing nothing;
      nlohmann::json::sax_parse(json, &nothing);
    }));
    times["read_json"].push_back(milliseconds([&] {
      api::OptionReader options;
      (void)api::read_json(json, {}, control, options);
    }));
  }
  std::printf("%s\n", nlohmann::json(times).dump().c_str());
  return 0;
}

}  // namespace
}  // namespace remesh::bench

int main(int argc, char** argv) {
  if (argc != 3 || std::atoi(argv[2]) < 1) {
    std::fprintf(stderr, "usage: io_bench FILE.obj RUNS\n");
    return 2;
  }
  return remesh::bench::run(argv[1], std::atoi(argv[2]));
}
