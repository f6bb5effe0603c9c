// Writes the first inputs of the fuzz targets, small files of every kind: make_seeds FOLDER.
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "core/io/common/bytes.h"
#include "core/io/gzip.h"
#include "core/io/mesh_files.h"

namespace {

using namespace remesh;

/// Two triangles with labels of every kind.
TriangleMesh two_triangles() {
  TriangleMesh mesh;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0.5}, Vec3{1, 1, -2}, Vec3{0, 1, 0x1p-30}})
    mesh.positions.push_back(p);
  mesh.faces.push_back({VertexId(0), VertexId(1), VertexId(2)});
  mesh.faces.push_back({VertexId(0), VertexId(2), VertexId(3)});
  for (LabelSet* set : {&mesh.labels.object, &mesh.labels.group, &mesh.labels.material}) {
    set->names = {"a", "b c"};
    set->of_face.items() = {0, 1};
  }
  return mesh;
}

std::string big_endian_ply() {
  std::string file =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\nproperty short z\n"
      "property uchar red\nelement face 1\nproperty list uchar ushort vertex_index\nproperty list uchar float uv\n"
      "end_header\n";
  for (const int v : {0, 1, 2}) file += {0, static_cast<char>(v % 2), 0, static_cast<char>(v / 2), 0, 0, 7};
  return file + std::string{3, 0, 0, 0, 1, 0, 2, 0};
}

/// A ZIP archive of one file that is not packed.
std::string stored_zip(const std::string& name, const std::string& content) {
  const auto size = static_cast<std::uint32_t>(content.size());
  const auto name_size = static_cast<std::uint16_t>(name.size());
  std::string sizes;
  const auto checksum =
      static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()));
  for (const std::uint32_t number : {checksum, size, size}) append_little_endian(sizes, number);
  append_little_endian(sizes, name_size);
  append_little_endian(sizes, std::uint16_t{0});
  const std::string file = "PK\3\4" + std::string(10, '\0') + sizes + name + content;
  std::string directory = "PK\1\2" + std::string(12, '\0') + sizes + std::string(14, '\0') + name;
  std::string end = "PK\5\6" + std::string(4, '\0');
  for (int i = 0; i < 2; ++i) append_little_endian(end, std::uint16_t{1});
  append_little_endian(end, static_cast<std::uint32_t>(directory.size()));
  append_little_endian(end, static_cast<std::uint32_t>(file.size()));
  return file + directory + end + std::string(2, '\0');
}

template <class T>
void append(std::string& out, const std::vector<T>& numbers) {
  for (const T number : numbers) append_little_endian(out, number);
}

/// A triangle in Gmsh's binary format.
std::string binary_msh(const std::string& version) {
  using Ints = std::vector<std::int32_t>;
  using Sizes = std::vector<std::uint64_t>;
  std::string file = "$MeshFormat\n" + version + " 1 8\n";
  append(file, Ints{1});
  file += "\n$EndMeshFormat\n$Nodes\n";
  const bool is_new = version == "4.1";
  if (is_new) {
    append(file, Sizes{1, 3, 1, 3});
    append(file, Ints{2, 1, 0});
    append(file, Sizes{3, 1, 2, 3});
  } else {
    file += "3\n";
  }
  for (const int v : {0, 1, 2}) {
    if (!is_new) append(file, Ints{v + 1});
    append(file, std::vector<double>{double(v % 2), double(v / 2), 0.5});
  }
  file += "\n$EndNodes\n$Elements\n";
  if (is_new) {
    append(file, Sizes{1, 1, 1, 1});
    append(file, Ints{2, 1, 2});
    append(file, Sizes{1, 1, 1, 2, 3});
  } else {
    file += "1\n";
    append(file, Ints{2, 1, 2, 1, 7, 1, 1, 2, 3});
  }
  return file + "\n$EndElements\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  RunControl control;
  const TriangleMesh mesh = two_triangles();
  const IdVector<FaceId, PatchId> patches(2, PatchId(0));
  const auto written = [&](Format format) { return write_mesh(format, {mesh, patches, {"a comment"}}, control); };

  const auto written_as = [&](const Writing& writing) {
    return write_mesh(Format::kMsh, {mesh, patches, {}, {}, writing}, control);
  };

  const std::map<std::string, std::vector<std::string>> seeds{
      {"head",
       {"GET /v1/capabilities?a=b%20c HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "POST http://x/v1/remesh HTTP/1.0\r\nContent-Length: 5\r\nTraceparent: "
        "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01\r\n\r\n",
        "OPTIONS * HTTP/1.1\r\nhost:x\r\nTransfer-Encoding:\tchunked \r\n\r\n"}},
      {"chunked", {"5\r\nhello\r\n0\r\n\r\n", "1;a=b\r\nx\r\n00A\r\n0123456789\r\n0\r\nA: b\r\n\r\n"}},
      {"options",
       {"refine=true&min_angle_deg=3e1&max_edge_length=0.5&barriers=object,group&repair=none",
        "reference_axis=1,0,0&format=obj&plane_tolerance=auto&max_output_faces=1000&gradation=1.5&proximity=1"}},
      {"multipart",
       {"multipart/form-data; boundary=b\n--b\r\nContent-Disposition: form-data; name=\"mesh\"; "
        "filename=\"a.obj\"\r\nContent-Type: model/obj\r\n\r\nv 0 0 0\r\n--b\r\nContent-Disposition: form-data; "
        "name=\"options\"\r\n\r\n{}\r\n--b--\r\n"}},
      {"obj",
       {written(Format::kObj), "v 0 0\nv 1 0 0 1 0 0\r\nv +1e0 .5 -1.#IND\nf 1/1 -2//3 \\\n3/4/5 # six\nl 1 2\np 1\n",
        "mtllib a.mtl\ng a b\no\nusemtl\ns off\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n"}},
      {"obj_ways", {written(Format::kObj), "v 0 0\nv 1 0 0 1\nv 0 1 0 # c\r\nvn 0 0 1\rg a\tb\nf 1//1 -1/2 2/\n"}},
      {"stl",
       {written(Format::kStl), written(Format::kStl) + "x",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\nendsolid a\n"
        "SOLID\nFACET\nOUTER LOOP\nVERTEX 1 0 0\nVERTEX 1 1 0\nVERTEX 0 1 0\nENDLOOP x\nENDFACET\nENDSOLID\n"}},
      {"ply",
       {written(Format::kPly), big_endian_ply(),
        "ply\r\nformat ascii 1.0\r\ncomment group 1 lid\r\nelement vertex 3\r\nproperty double x\r\nproperty double "
        "y\r\n"
        "property double z\r\nelement edge 1\r\nproperty int a\r\nelement face 1\r\nproperty list uchar int "
        "vertex_indices\r\nproperty int group\r\nend_header\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n7\r\n3 0 1 2 1\r\n"}},
      {"off",
       {written(Format::kOff), "STCNOFF 3 1\n0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2 255 0 0 # red\n",
        std::string("OFF BINARY\n\0\0\0\3\0\0\0\1\0\0\0\0", 23) + std::string(36, '\0') +
            std::string("\0\0\0\3\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0\0", 20)}},
      {"vtu",
       {written(Format::kVtu),
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><Points><DataArray "
        "type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 "
        "0</DataArray></Points><Polys><DataArray "
        "type=\"Int32\" Name=\"connectivity\">0 1 2</DataArray><DataArray type=\"Int32\" Name=\"offsets\">3</DataArray>"
        "</Polys></Piece></PolyData></VTKFile>",
        "<VTKFile type=\"PolyData\" compressor=\"vtkZLibDataCompressor\"><PolyData><Piece NumberOfPoints=\"1\"><Points>"
        "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"appended\" "
        "offset=\"0\"/></Points></Piece></PolyData>"
        "<AppendedData encoding=\"base64\">_AQAAABgAAAAAAAAACwAAAA==eJxjYEAGAAAYAAE=</AppendedData></VTKFile>",
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 "
        "1 2\n"
        "CELL_DATA 1\nSCALARS group int\nLOOKUP_TABLE default\n7\n"}},
      {"glb",
       {written(Format::kGlb),
        R"({"asset":{"version":"2.0"},"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
        R"("componentType":5126,"count":3,"type":"VEC3"}],"nodes":[{"mesh":0,"children":[1]},{"scale":[2,2,2],"mesh":0}],)"
        R"("buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"scenes":[{"nodes":[0]}]})"}},
      {"threemf",
       {stored_zip(
           "3D/3dmodel.model",
           "<model unit=\"inch\"><resources><basematerials id=\"1\"><base name=\"a\"/></basematerials><object id=\"2\" "
           "pid=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/><vertex "
           "x=\"0\" "
           "y=\"1\" z=\"0\"/></vertices><triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\" p1=\"0\"/></triangles></mesh>"
           "</object><object id=\"3\"><components><component objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 5 6 "
           "7\"/></components></object></resources><build><item objectid=\"3\"/></build></model>")}},
      {"msh",
       {written(Format::kMsh), written_as({.msh_version = MshVersion::k41}), binary_msh("2.2"), binary_msh("4.1")}},
      {"mesh",
       {written(Format::kMesh),
        "MeshVersionFormatted 1 Dimension\n3 # reference 2: a b\nVertices 3 0 0 0 0 1 0 0 0 0 1 0 0 Edges 1 1 2 0\n"
        "Quadrilaterals 1 1 2 3 1 2 End"}},
      {"inp",
       {"*PART, NAME=a\n*NODE\n1,0,0,0\n2,1.,0.,0.\n3,0.,1D0,0.\n*ELEMENT, TYPE=S3,\nELSET=b\n4,1,2,\n3\n*ELSET, "
        "ELSET=c, "
        "GENERATE\n1,9,2\n*END PART\n"}},
      {"bdf",
       {"BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID           2              1.      0.    1.-3\nGRID*                  3      "
        "                        0.              1.\n*                     0.\nCTRIA3,4,5,1,2,3\nENDDATA\n"}},
      {"json",
       {R"({"vertices":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]],"labels":{"group":{"names":["a"],"of_face":[0]}}})",
        R"({"mesh":{"vertices":[[0,0,0],[1,0,0],[0,1,1e-3]],"faces":[[0,1,2]],"face_groups":[3]},"options":{"refine":false,"barriers":["group"]}})",
        R"({"vertices":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]],"faces":[[0,1,2,3]],"what":{"ever":[null,true,"\u00e9"]}})"}},
      {"gzip", {gzip(written(Format::kObj), control), gzip("", control) + gzip("abc", control), "plain"}},
      {"pipeline",
       {// A tetrahedron, unrefined and refined; two squares across each other.
        std::string("\0\1\1\0\0\0\4\0\0\0\4\0\0\0\4\0\0\2\1\0\0\1\3\0\1\2\3\0\2\0\3", 31),
        std::string("\1\1\1\0\0\0\4\0\0\0\4\0\0\0\4\0\0\2\1\0\0\1\3\0\1\2\3\0\2\0\3", 31),
        std::string("\0\5\1\0\0\2\4\0\2\4\4\2\0\4\2\2\0\0\2\0\4\2\4\4\2\4\0\2\0\1\2\3\2\4\5\6\7", 37)}},
  };
  for (const auto& [target, contents] : seeds) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / target;
    std::filesystem::create_directories(folder);
    for (std::size_t i = 0; i < contents.size(); ++i) {
      std::ofstream file(folder / ("seed" + std::to_string(i)), std::ios::binary);
      file << contents[i];
      if (!file) {
        std::cerr << "cannot write to " << folder << "\n";
        return 1;
      }
    }
  }
  return 0;
}
