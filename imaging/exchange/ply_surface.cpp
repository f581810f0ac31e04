#include "imaging/exchange/ply_surface.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

#include "imaging/exchange/surface_text.h"

namespace palpate {
namespace {

enum class Encoding { Text, Little, Big };
enum class Type { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };

struct Property {
  std::string_view name;
  Type type{};
  std::optional<Type> count;  ///< Of a list.
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding{};
  std::vector<Element> elements;
};

// No file has more; a header of a million elements without properties would cost time for nothing.
constexpr std::size_t kMaxElements = 64;
constexpr std::size_t kMaxCorners = 64;

std::optional<Type> typeOf(std::string_view word) {
  if (word == "char" || word == "int8") return Type::Int8;
  if (word == "uchar" || word == "uint8") return Type::UInt8;
  if (word == "short" || word == "int16") return Type::Int16;
  if (word == "ushort" || word == "uint16") return Type::UInt16;
  if (word == "int" || word == "int32") return Type::Int32;
  if (word == "uint" || word == "uint32") return Type::UInt32;
  if (word == "float" || word == "float32") return Type::Float32;
  if (word == "double" || word == "float64") return Type::Float64;
  return std::nullopt;
}

std::size_t sizeOf(Type type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool parseProperty(std::string_view line, Element& element) {
  Property property;
  std::string_view word = takeWord(line);
  if (word == "list") {
    property.count = typeOf(takeWord(line));
    if (!property.count) return false;
    word = takeWord(line);
  }
  const auto type = typeOf(word);
  property.name = takeWord(line);
  if (!type || property.name.empty() || element.properties.size() >= kMaxElements) return false;
  property.type = *type;
  element.properties.push_back(property);
  return true;
}

bool parseFormat(std::string_view line, Header& header) {
  const std::string_view word = takeWord(line);
  if (word == "ascii") header.encoding = Encoding::Text;
  if (word == "binary_little_endian") header.encoding = Encoding::Little;
  if (word == "binary_big_endian") header.encoding = Encoding::Big;
  return word == "ascii" || word.starts_with("binary_");
}

bool parseHeaderLine(std::string_view line, Header& header) {
  const std::string_view key = takeWord(line);
  if (key == "format") return parseFormat(line, header);
  if (key == "property") {
    return !header.elements.empty() && parseProperty(line, header.elements.back());
  }
  if (key != "element") return true;  // comment, obj_info
  Element element;
  element.name = takeWord(line);
  const auto count = numberFrom<std::uint64_t>(takeWord(line));
  if (!count || header.elements.size() >= kMaxElements) return false;
  element.count = *count;
  header.elements.push_back(element);
  return true;
}

std::optional<Header> takeHeader(std::string_view& bytes) {
  if (takeLine(bytes) != "ply") return std::nullopt;
  Header header;
  while (!bytes.empty()) {
    const std::string_view line = takeLine(bytes);
    if (line == "end_header") return header;
    if (!parseHeaderLine(line, header)) return std::nullopt;
  }
  return std::nullopt;
}

template <class Number>
double numberAt(const char* bytes, bool swap) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes, raw.size());
  if (swap) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<Number>(raw));
}

double binary(Type type, const char* bytes, bool swap) {
  switch (type) {
    case Type::Int8:
      return numberAt<std::int8_t>(bytes, swap);
    case Type::UInt8:
      return numberAt<std::uint8_t>(bytes, swap);
    case Type::Int16:
      return numberAt<std::int16_t>(bytes, swap);
    case Type::UInt16:
      return numberAt<std::uint16_t>(bytes, swap);
    case Type::Int32:
      return numberAt<std::int32_t>(bytes, swap);
    case Type::UInt32:
      return numberAt<std::uint32_t>(bytes, swap);
    case Type::Float32:
      return numberAt<float>(bytes, swap);
    case Type::Float64:
      return numberAt<double>(bytes, swap);
  }
  return 0.0;
}

/// The next value of the body; empty at its end.
std::optional<double> takeValue(std::string_view& body, Type type, Encoding encoding) {
  if (encoding == Encoding::Text) return numberFrom<double>(takeWord(body));
  const std::size_t size = sizeOf(type);
  if (body.size() < size) return std::nullopt;
  static_assert(std::endian::native == std::endian::little);
  const double value = binary(type, body.data(), encoding == Encoding::Big);
  body.remove_prefix(size);
  return value;
}

/// A value as an index or a count; empty where it is none.
std::optional<std::uint32_t> wholeOf(const std::optional<double>& value) {
  if (!value || !(*value >= 0.0 && *value < 4294967295.0) || *value != std::trunc(*value)) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(*value);
}

bool takeVertex(std::string_view& body, const Element& element, Encoding encoding,
                SurfaceMesh& mesh) {
  Eigen::Vector3f p = Eigen::Vector3f::Constant(std::nanf(""));
  for (const Property& property : element.properties) {
    if (property.count) return false;
    const auto value = takeValue(body, property.type, encoding);
    if (!value) return false;
    if (property.name == "x") p[0] = static_cast<float>(*value);
    if (property.name == "y") p[1] = static_cast<float>(*value);
    if (property.name == "z") p[2] = static_cast<float>(*value);
  }
  mesh.vertices_mm.push_back(p);
  return true;
}

bool takeList(std::string_view& body, const Property& property, Encoding encoding,
              std::vector<std::uint32_t>* corners) {
  const auto count = wholeOf(takeValue(body, *property.count, encoding));
  // Each value takes a byte of the file or more.
  if (!count || *count > body.size() || (corners != nullptr && *count > kMaxCorners)) return false;
  for (std::uint32_t c = 0; c < *count; ++c) {
    const auto value = takeValue(body, property.type, encoding);
    if (!value) return false;
    if (corners == nullptr) continue;
    const auto index = wholeOf(value);
    if (!index) return false;
    corners->push_back(*index);
  }
  return true;
}

/// Faces, and elements of other names, whose values are passed over.
bool takeOther(std::string_view& body, const Element& element, Encoding encoding,
               SurfaceMesh& mesh) {
  std::vector<std::uint32_t> corners;
  for (const Property& property : element.properties) {
    const bool isFace = element.name == "face" &&
                        (property.name == "vertex_indices" || property.name == "vertex_index");
    if (!property.count) {
      if (!takeValue(body, property.type, encoding)) return false;
    } else if (!takeList(body, property, encoding, isFace ? &corners : nullptr)) {
      return false;
    }
  }
  for (std::size_t c = 2; c < corners.size(); ++c) {
    mesh.triangles.push_back({corners[0], corners[c - 1], corners[c]});
  }
  return true;
}

}  // namespace

std::optional<SurfaceMesh> parsePly(std::string_view bytes) {
  std::string_view body = bytes;
  const auto header = takeHeader(body);
  if (!header) return std::nullopt;
  SurfaceMesh mesh;
  for (const Element& element : header->elements) {
    // An element with properties takes a byte or more, so that counts are bounded by the file.
    if (element.properties.empty()) continue;
    if (element.count > body.size()) return std::nullopt;
    const bool isVertex = element.name == "vertex";
    for (std::uint64_t n = 0; n < element.count; ++n) {
      if (!(isVertex ? takeVertex(body, element, header->encoding, mesh)
                     : takeOther(body, element, header->encoding, mesh))) {
        return std::nullopt;
      }
    }
  }
  return mesh;
}

}  // namespace palpate
