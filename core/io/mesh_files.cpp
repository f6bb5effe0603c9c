#include "core/io/mesh_files.h"

#include "core/base/error.h"
#include "core/io/msh.h"
#include "core/io/obj.h"
#include "core/io/off.h"
#include "core/io/ply.h"
#include "core/io/stl.h"
#include "core/io/vtu.h"

namespace remesh {

ReadResult read_mesh(Format format, std::string_view content, const ReadLimits& limits, RunControl& control) {
  switch (format) {
    case Format::kObj: return read_obj(content, limits, control);
    case Format::kStl: return read_stl(content, limits, control);
    case Format::kPly: return read_ply(content, limits, control);
    case Format::kOff: return read_off(content, limits, control);
    case Format::kJson:
    case Format::kStlAscii:
    case Format::kVtu:
    case Format::kMsh: break;
  }
  throw Error(Code::kUnsupportedMediaType, Stage::kRead,
              "the format " + std::string(format_name(format)) + " is not read here");
}

std::string write_mesh(Format format, const TriangleMesh& mesh, const IdVector<FaceId, PatchId>& face_patch,
                       const std::vector<std::string>& comments, RunControl& control) {
  control.enter(Stage::kWrite);
  switch (format) {
    case Format::kObj: return write_obj(mesh, comments, control);
    case Format::kStl: return write_stl(mesh, comments, control);
    case Format::kStlAscii: return write_stl_ascii(mesh, control);
    case Format::kPly: return write_ply(mesh, comments, control);
    case Format::kOff: return write_off(mesh, comments, control);
    case Format::kVtu: return write_vtu(mesh, face_patch, comments, control);
    case Format::kMsh: return write_msh(mesh, face_patch, comments, control);
    case Format::kJson: break;
  }
  throw Error(Code::kNotAcceptable, Stage::kWrite,
              "the format " + std::string(format_name(format)) + " is not written here");
}

}  // namespace remesh
