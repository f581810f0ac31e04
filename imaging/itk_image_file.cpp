#include "imaging/itk_image_file.h"

#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <string>

namespace palpate {
namespace fs = std::filesystem;
namespace {

using Component = itk::ImageIOBase::IOComponentType;

itk::ImageIOBase::Pointer makeIo(VolumeFormat format, const fs::path& file) {
  itk::ImageIOBase::Pointer io;
  switch (format) {
    case VolumeFormat::Nifti:
      io = itk::NiftiImageIO::New();
      break;
    case VolumeFormat::Nrrd:
      io = itk::NrrdImageIO::New();
      break;
    case VolumeFormat::MetaImage: {
      auto meta = itk::MetaImageIO::New();
      meta->SetDoublePrecision(17);  // its default of 6 digits moves corners
      io = meta;
      break;
    }
  }
  io->SetFileName(file.string());
  return io;
}

StoredType storedType(Component component) {
  switch (component) {
    case Component::UCHAR:
      return StoredType::UInt8;
    case Component::CHAR:
      return StoredType::Int8;
    case Component::USHORT:
      return StoredType::UInt16;
    case Component::SHORT:
      return StoredType::Int16;
    case Component::UINT:
      return StoredType::UInt32;
    case Component::INT:
      return StoredType::Int32;
    case Component::ULONG:
    case Component::ULONGLONG:
      return StoredType::UInt64;
    case Component::LONG:
    case Component::LONGLONG:
      return StoredType::Int64;
    case Component::FLOAT:
      return StoredType::Float32;
    case Component::DOUBLE:
      return StoredType::Float64;
    default:
      return StoredType::Other;
  }
}
static_assert(sizeof(long) == 8, "ITK's LONG is read as 64 bits");

Component componentOf(StoredType type) {
  if (type == StoredType::UInt8) return Component::UCHAR;
  return type == StoredType::Int16 ? Component::SHORT : Component::FLOAT;
}

void selectWhole(itk::ImageIOBase& io) {
  const unsigned n = io.GetNumberOfDimensions();
  itk::ImageIORegion region(n);
  for (unsigned d = 0; d < n; ++d) region.SetSize(d, io.GetDimensions(d));
  io.SetIORegion(region);
}

HeaderTexts textsOf(const itk::MetaDataDictionary& dictionary) {
  HeaderTexts texts;
  for (const std::string& key : dictionary.GetKeys()) {
    std::string text;
    if (itk::ExposeMetaData<std::string>(dictionary, key, text)) texts.emplace_back(key, text);
  }
  return texts;
}

ItkImageHeader headerOf(itk::ImageIOBase& io, VolumeFormat format) {
  ItkImageHeader header;
  const unsigned n = io.GetNumberOfDimensions();
  for (unsigned d = 3; d < n; ++d) header.volumes *= io.GetDimensions(d);
  header.components = io.GetNumberOfComponents();
  header.type = storedType(io.GetComponentType());
  header.bytesPerValue = io.GetComponentSize();
  for (unsigned d = 0; d < std::min(3U, n); ++d) {
    header.dims[d] = io.GetDimensions(d);
    header.spacing_mm[d] = io.GetSpacing(d);
    header.origin_mm[d] = io.GetOrigin(d);
    const auto axis = io.GetDirection(d);
    for (unsigned r = 0; r < 3; ++r) header.direction[3 * d + r] = r < axis.size() ? axis[r] : 0.0;
  }
  if (format == VolumeFormat::Nrrd) {
    std::string space;
    header.saysPatientSpace =
        itk::ExposeMetaData<std::string>(io.GetMetaDataDictionary(), "NRRD_space", space);
    header.texts = textsOf(io.GetMetaDataDictionary());
  }
  return header;
}

}  // namespace

std::optional<ItkImageHeader> readItkHeader(VolumeFormat format, const fs::path& file) {
  try {
    const auto io = makeIo(format, file);
    io->ReadImageInformation();
    return headerOf(*io, format);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

std::vector<char> readItkVoxels(VolumeFormat format, const fs::path& file) {
  try {
    const auto io = makeIo(format, file);
    io->ReadImageInformation();
    selectWhole(*io);
    std::vector<char> bytes(io->GetImageSizeInBytes());
    io->Read(bytes.data());
    return bytes;
  } catch (const std::exception&) {
    return {};
  }
}

bool writeItkImage(VolumeFormat format, const fs::path& file, const ItkImageHeader& header,
                   const void* voxels, bool compress) {
  try {
    const auto io = makeIo(format, file);
    io->SetNumberOfDimensions(3);
    io->SetNumberOfComponents(1);
    io->SetPixelType(itk::IOPixelEnum::SCALAR);
    io->SetComponentType(componentOf(header.type));
    for (unsigned d = 0; d < 3; ++d) {
      io->SetDimensions(d, header.dims[d]);
      io->SetSpacing(d, header.spacing_mm[d]);
      io->SetOrigin(d, header.origin_mm[d]);
      io->SetDirection(d, std::vector<double>(header.direction.begin() + 3 * d,
                                              header.direction.begin() + 3 * d + 3));
    }
    selectWhole(*io);
    for (const auto& [key, text] : header.texts) {
      itk::EncapsulateMetaData<std::string>(io->GetMetaDataDictionary(), key, text);
    }
    io->SetUseCompression(compress);
    if (compress)
      io->SetCompressionLevel(2);  // level 9 takes ten times as long for a tenth of the bytes
    io->WriteImageInformation();
    io->Write(voxels);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace palpate
