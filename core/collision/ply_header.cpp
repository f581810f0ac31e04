#include "core/collision/ply_header.h"

#include <algorithm>
#include <optional>

#include "core/collision/text_cursor.h"

namespace palpate {
namespace {

constexpr std::size_t kMaxHeaderLines = 10000;  // a header has a dozen; more is not a PLY file
constexpr std::string_view kWanted[6] = {"x", "y", "z", "nx", "ny", "nz"};

Error atLine(const std::string& name, std::size_t line, const std::string& message) {
  return inputRefused("Line " + std::to_string(line) + " of the PLY file: " + message).inFile(name);
}

std::optional<PlyType> typeOf(std::string_view word) {
  constexpr std::pair<std::string_view, PlyType> kNames[] = {
      {"char", PlyType::Int8},      {"int8", PlyType::Int8},       {"uchar", PlyType::UInt8},
      {"uint8", PlyType::UInt8},    {"short", PlyType::Int16},     {"int16", PlyType::Int16},
      {"ushort", PlyType::UInt16},  {"uint16", PlyType::UInt16},   {"int", PlyType::Int32},
      {"int32", PlyType::Int32},    {"uint", PlyType::UInt32},     {"uint32", PlyType::UInt32},
      {"float", PlyType::Float32},  {"float32", PlyType::Float32}, {"double", PlyType::Float64},
      {"float64", PlyType::Float64}};
  for (const auto& [text, type] : kNames) {
    if (text == word) return type;
  }
  return std::nullopt;
}

Result<void> parseFormat(std::string_view line, PlyHeader& header, const std::string& name,
                         std::size_t number) {
  const std::string_view format = takeWord(line);
  const std::string_view version = takeWord(line);
  if (version == "1.0" && (format == "ascii" || format == "binary_little_endian")) {
    header.binary = format != "ascii";
    return {};
  }
  return fail(atLine(name, number, "the format is not one that is read.")
                  .inField("format")
                  .butFound(std::string(format) + " " + std::string(version))
                  .wants("ascii 1.0 or binary_little_endian 1.0")
                  .advise("Save the points in one of these formats."));
}

Result<void> parseElement(std::string_view line, PlyHeader& header, const std::string& name,
                          std::size_t number) {
  PlyElement element;
  element.name = takeWord(line);
  const auto count = numberOf<std::uint64_t>(takeWord(line));
  if (element.name.empty() || !count || !trimmed(line).empty()) {
    return fail(atLine(name, number, "the element has no name and count."));
  }
  element.count = *count;
  header.elements.push_back(std::move(element));
  return {};
}

Result<void> parseProperty(std::string_view line, PlyHeader& header, const std::string& name,
                           std::size_t number) {
  if (header.elements.empty()) {
    return fail(atLine(name, number, "a property comes before the first element."));
  }
  PlyElement& element = header.elements.back();
  const std::string_view word = takeWord(line);
  if (word == "list") {
    element.hasList = true;
    return {};
  }
  const auto type = typeOf(word);
  if (!type) {
    return fail(atLine(name, number, "the property's type is unknown.")
                    .butFound(std::string(word.substr(0, 40))));
  }
  element.properties.emplace_back(std::string(takeWord(line)), *type);
  return {};
}

Result<void> findVertices(PlyHeader& header, const std::string& name) {
  const auto at = std::find_if(header.elements.begin(), header.elements.end(),
                               [](const PlyElement& e) { return e.name == "vertex"; });
  if (at == header.elements.end()) {
    return fail(inputRefused("The PLY file has no element 'vertex'.").inFile(name));
  }
  const bool listBefore =
      std::any_of(header.elements.begin(), at + 1, [](const PlyElement& e) { return e.hasList; });
  if (listBefore) {
    return fail(inputRefused("The PLY file has a list in or before the element 'vertex'.")
                    .inFile(name)
                    .advise("Save the vertices first, and without lists."));
  }
  header.vertex = static_cast<std::size_t>(at - header.elements.begin());
  for (std::size_t w = 0; w < 6; ++w) {
    const auto property = std::find_if(at->properties.begin(), at->properties.end(),
                                       [w](const auto& p) { return p.first == kWanted[w]; });
    if (property == at->properties.end()) {
      return fail(inputRefused("The vertices of the PLY file lack a property.")
                      .inFile(name)
                      .inField(std::string(kWanted[w]))
                      .wants("x, y, z, nx, ny, nz")
                      .advise("Save the points with their normals."));
    }
    header.columns[w] = static_cast<std::size_t>(property - at->properties.begin());
  }
  return {};
}

}  // namespace

std::size_t plyBytes(PlyType type) noexcept {
  switch (type) {
    case PlyType::Int8:
    case PlyType::UInt8:
      return 1;
    case PlyType::Int16:
    case PlyType::UInt16:
      return 2;
    case PlyType::Float64:
      return 8;
    default:
      return 4;
  }
}

std::size_t PlyElement::rowBytes() const noexcept {
  std::size_t bytes = 0;
  for (const auto& p : properties) bytes += plyBytes(p.second);
  return bytes;
}

Result<PlyHeader> parsePlyHeader(std::string_view bytes, const std::string& name) {
  PlyHeader header;
  LineReader lines(bytes);
  if (lines.next().value_or("") != "ply") {
    return fail(inputRefused("The file is not a PLY file.")
                    .inFile(name)
                    .wants("a first line 'ply'")
                    .advise("Save the points as PLY."));
  }
  bool format = false;
  while (const auto next = lines.next()) {
    if (lines.number() > kMaxHeaderLines) break;
    std::string_view line = *next;
    const std::string_view word = takeWord(line);
    if (word == "end_header") {
      if (!format) return fail(atLine(name, lines.number(), "the header names no format."));
      header.lines = lines.number();
      header.body = lines.rest();
      if (auto ok = findVertices(header, name); !ok) return fail(ok.error());
      return header;
    }
    Result<void> ok;
    if (word == "format") {
      ok = parseFormat(line, header, name, lines.number());
      format = true;
    } else if (word == "element") {
      ok = parseElement(line, header, name, lines.number());
    } else if (word == "property") {
      ok = parseProperty(line, header, name, lines.number());
    } else if (word != "comment" && word != "obj_info") {
      ok = fail(atLine(name, lines.number(), "the header has a word that is unknown.")
                    .butFound(std::string(word.substr(0, 40))));
    }
    if (!ok) return fail(ok.error());
  }
  return fail(inputRefused("The header of the PLY file does not end.")
                  .inFile(name)
                  .wants("a line 'end_header'")
                  .advise("The file is damaged or cut short: copy it again."));
}

}  // namespace palpate
