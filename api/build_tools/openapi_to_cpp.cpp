// Converts openapi.yaml to a C++ source that contains it as JSON. Usage: openapi_to_cpp IN.yaml OUT.cpp
#include <yaml-cpp/yaml.h>

#include <exception>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

namespace {

using Json = nlohmann::ordered_json;

// Converts a scalar. A plain one gets its type by YAML 1.2's core schema; a quoted one (tag "!") is a string.
Json scalar_to_json(const YAML::Node& node) {
  const std::string& text = node.Scalar();
  if (node.Tag() == "!") return text;
  if (text == "true" || text == "false") return text == "true";
  if (text.empty() || text == "null" || text == "~") return nullptr;
  const bool may_be_number = text.find_first_not_of("0123456789+-.eE") == std::string::npos;
  if (may_be_number && Json::accept(text)) return Json::parse(text);
  return text;
}

Json to_json(const YAML::Node& node) {
  if (node.IsSequence()) {
    Json array = Json::array();
    for (const YAML::Node& item : node) array.push_back(to_json(item));
    return array;
  }
  if (node.IsMap()) {
    Json object = Json::object();
    for (const auto& entry : node) {
      const std::string key = entry.first.as<std::string>();
      if (object.contains(key)) throw std::runtime_error("the key '" + key + "' stands twice");
      object[key] = to_json(entry.second);
    }
    return object;
  }
  return node.IsScalar() ? scalar_to_json(node) : Json(nullptr);
}

// Writes the text as numbers, because compilers may reject string literals above 65,536 characters, even concatenated
// ones.
void write_source(std::ostream& out, const std::string& json) {
  out << "namespace remesh::api {\nextern const char* const kOpenapiJson;\nnamespace {\nconstexpr char kText[] = {";
  constexpr std::size_t kInLine = 24;
  for (std::size_t i = 0; i < json.size(); ++i) out << (i % kInLine == 0 ? "\n    " : " ") << int{json[i]} << ",";
  out << "\n    10, 0};\n}  // namespace\nconst char* const kOpenapiJson = kText;\n}  // namespace remesh::api\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: openapi_to_cpp IN.yaml OUT.cpp\n";
    return 2;
  }
  try {
    const std::string json = to_json(YAML::LoadFile(argv[1])).dump(2);
    std::ofstream out(argv[2]);
    write_source(out, json);
    out.close();
    if (!out) throw std::runtime_error(std::string("cannot write ") + argv[2]);
  } catch (const std::exception& error) {
    std::cerr << argv[1] << ": " << error.what() << "\n";
    return 1;
  }
}
