#include "imaging/exchange/surface_write.h"

#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkOBJWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSTLWriter.h>
#include <vtkSmartPointer.h>

#include <bit>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <string>

#include "core/base/whole_file.h"
#include "imaging/exchange/surface_read.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr const char* kSpace = "Palpate surface, patient coordinates in mm, SPACE=LPS";

vtkSmartPointer<vtkPolyData> polyData(const SurfaceMesh& mesh) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  auto normals = vtkSmartPointer<vtkFloatArray>::New();
  normals->SetNumberOfComponents(3);
  normals->SetName("Normals");
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.vertices_mm.size()));
  normals->SetNumberOfTuples(static_cast<vtkIdType>(mesh.vertices_mm.size()));
  for (std::size_t v = 0; v < mesh.vertices_mm.size(); ++v) {
    points->SetPoint(static_cast<vtkIdType>(v), mesh.vertices_mm[v].data());
    normals->SetTypedTuple(static_cast<vtkIdType>(v), mesh.normals[v].data());
  }
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  const auto count = static_cast<vtkIdType>(mesh.triangles.size());
  cells->AllocateExact(count, count * 3);
  for (const auto& t : mesh.triangles) cells->InsertNextCell({t[0], t[1], t[2]});
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetPointData()->SetNormals(normals);
  return data;
}

/// VTK prints errors, with file names, unless somebody listens. True when it reported none.
template <class Writer>
bool run(Writer& writer, vtkPolyData& data, const fs::path& file) {
  auto listener = vtkSmartPointer<vtkCallbackCommand>::New();
  bool failed = false;
  listener->SetClientData(&failed);
  listener->SetCallback(
      [](vtkObject*, unsigned long, void* seen, void*) { *static_cast<bool*>(seen) = true; });
  writer.AddObserver(vtkCommand::ErrorEvent, listener);
  writer.SetInputData(&data);
  writer.SetFileName(file.c_str());
  return writer.Write() == 1 && !failed && writer.GetErrorCode() == 0;
}

bool writeStl(vtkPolyData& data, const fs::path& file) {
  auto writer = vtkSmartPointer<vtkSTLWriter>::New();
  writer->SetFileTypeToBinary();
  writer->SetHeader(kSpace);
  return run(*writer, data, file);
}

template <class T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

/// VTK's writer leaves normals out, which shading needs.
bool writePly(const SurfaceMesh& mesh, const std::array<std::uint8_t, 3>& colour,
              const fs::path& file) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment " + std::string(kSpace) +
                      "\nelement vertex " + std::to_string(mesh.vertices_mm.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\n"
                      "property float nx\nproperty float ny\nproperty float nz\n"
                      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                      "element face " +
                      std::to_string(mesh.triangles.size()) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t v = 0; v < mesh.vertices_mm.size(); ++v) {
    append(bytes, mesh.vertices_mm[v].data(), 3);
    append(bytes, mesh.normals[v].data(), 3);
    append(bytes, colour.data(), 3);
  }
  for (const auto& t : mesh.triangles) {
    bytes += '\3';
    append(bytes, t.data(), 3);
  }
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << bytes;
  out.close();
  return out.good();
}

/// VTK's writer takes no comment: it is put before what the writer wrote.
bool writeObj(vtkPolyData& data, const fs::path& file) {
  auto writer = vtkSmartPointer<vtkOBJWriter>::New();
  if (!run(*writer, data, file)) return false;
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << "# " << kSpace << "\n" << text;
  out.close();
  return !text.empty() && out.good();
}

bool write(const SurfaceMesh& mesh, const std::array<std::uint8_t, 3>& colour,
           ExchangeFormat format, const fs::path& file) {
  if (format == ExchangeFormat::Ply) return writePly(mesh, colour, file);
  const auto data = polyData(mesh);
  return format == ExchangeFormat::Stl ? writeStl(*data, file) : writeObj(*data, file);
}

}  // namespace

Result<void> writeSurface(const SurfaceMesh& mesh, const std::array<std::uint8_t, 3>& colour,
                          ExchangeFormat format, const fs::path& file) {
  auto whole = WholeFile::beside(file);
  if (!whole) return fail(whole.error());
  errno = 0;
  if (!write(mesh, colour, format, whole->hiddenName())) {
    return fail(cannotWrite(file, errno != 0 ? errno : EIO));
  }
  // VTK does not notice every full disk.
  const auto back = readSurface(whole->hiddenName(), format);
  if (!back || back->triangles.size() > mesh.triangles.size() ||
      back->vertices_mm.size() > mesh.vertices_mm.size()) {
    return fail(cannotWrite(file, ENOSPC));
  }
  return whole->commit();
}

}  // namespace palpate
