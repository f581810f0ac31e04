#include "core/collision/shell_file.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/collision/input_file.h"
#include "core/collision/ply_header.h"
#include "core/collision/text_cursor.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

struct Points {
  std::vector<Eigen::Vector3d> points, normals;
};

// `where`: "Line 12" or "Vertex 3".
Result<void> addPoint(const double value[6], const std::string& where, const std::string& name,
                      Points& to) {
  for (int i = 0; i < 6; ++i) {
    if (!std::isfinite(value[i])) {
      return fail(inputRefused(where + " of the PLY file: a number is not finite.").inFile(name));
    }
  }
  const Eigen::Vector3d normal(value[3], value[4], value[5]);
  const double largest = normal.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) {
    return fail(
        inputRefused(where + " of the PLY file: the normal has no direction.").inFile(name));
  }
  to.points.emplace_back(metres(value[0]), metres(value[1]), metres(value[2]));
  // Of any length: brought to about 1 by a power of two, for squares of very long and very short
  // ones do not fit a double. What is of ordinary length keeps its bits.
  int exponent = 0;
  static_cast<void>(std::frexp(largest, &exponent));
  to.normals.push_back(normal.unaryExpr([=](double c) { return std::ldexp(c, -exponent); }));
  return {};
}

Error cutShort(const std::string& name, std::uint64_t found, std::uint64_t wanted) {
  return inputRefused("The PLY file is cut short.")
      .inFile(name)
      .inField("vertex")
      .butFound(std::to_string(found))
      .wants(std::to_string(wanted))
      .advise("Copy it again from where it came.");
}

// A word of an ascii row for every property of the vertex; the wanted six are kept.
Result<void> parseRow(std::string_view line, const PlyHeader& header, std::size_t number,
                      const std::string& name, Points& to) {
  const PlyElement& vertex = header.elements[header.vertex];
  const std::string where = "Line " + std::to_string(number);
  double value[6] = {};
  for (std::size_t column = 0; column < vertex.properties.size(); ++column) {
    const std::string_view word = takeWord(line);
    const auto parsed = numberOf<double>(word);
    if (!parsed) {
      return fail(inputRefused(where + " of the PLY file: a field is not a number.")
                      .inFile(name)
                      .inField(vertex.properties[column].first)
                      .butFound(word.empty() ? "nothing" : std::string(word.substr(0, 40))));
    }
    for (std::size_t w = 0; w < 6; ++w) {
      if (header.columns[w] == column) value[w] = *parsed;
    }
  }
  if (!trimmed(line).empty()) {
    return fail(inputRefused(where + " of the PLY file: there are more fields than properties.")
                    .inFile(name)
                    .wants(std::to_string(vertex.properties.size())));
  }
  return addPoint(value, where, name, to);
}

Result<Points> parseAscii(const PlyHeader& header, const std::string& name) {
  LineReader lines(header.body);
  const PlyElement& vertex = header.elements[header.vertex];
  for (std::size_t e = 0; e < header.vertex; ++e) {
    for (std::uint64_t row = 0; row < header.elements[e].count; ++row) {
      if (!lines.next()) return fail(cutShort(name, 0, vertex.count));
    }
  }
  Points points;
  for (std::uint64_t row = 0; row < vertex.count; ++row) {
    const auto line = lines.next();
    if (!line) return fail(cutShort(name, row, vertex.count));
    auto ok = parseRow(*line, header, header.lines + lines.number(), name, points);
    if (!ok) return fail(ok.error());
  }
  return points;
}

template <class T>
double scalar(const char* at) {
  static_assert(std::endian::native == std::endian::little, "binary PLY is read as it lies");
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

double scalarOf(PlyType type, const char* at) {
  switch (type) {
    case PlyType::Int8:
      return scalar<std::int8_t>(at);
    case PlyType::UInt8:
      return scalar<std::uint8_t>(at);
    case PlyType::Int16:
      return scalar<std::int16_t>(at);
    case PlyType::UInt16:
      return scalar<std::uint16_t>(at);
    case PlyType::Int32:
      return scalar<std::int32_t>(at);
    case PlyType::UInt32:
      return scalar<std::uint32_t>(at);
    case PlyType::Float32:
      return scalar<float>(at);
    case PlyType::Float64:
      break;
  }
  return scalar<double>(at);
}

Result<Points> parseBinary(const PlyHeader& header, const std::string& name) {
  const PlyElement& vertex = header.elements[header.vertex];
  std::string_view body = header.body;
  for (std::size_t e = 0; e < header.vertex; ++e) {
    const PlyElement& before = header.elements[e];
    const std::size_t row = before.rowBytes();
    if (row != 0 && before.count > body.size() / row) {
      return fail(cutShort(name, 0, vertex.count));
    }
    body.remove_prefix(static_cast<std::size_t>(before.count) * row);
  }
  const std::size_t row = vertex.rowBytes();
  if (vertex.count > body.size() / row) {
    return fail(cutShort(name, body.size() / row, vertex.count));
  }
  std::size_t offset[6] = {};
  for (std::size_t w = 0; w < 6; ++w) {
    for (std::size_t c = 0; c < header.columns[w]; ++c) {
      offset[w] += plyBytes(vertex.properties[c].second);
    }
  }
  Points points;
  for (std::uint64_t i = 0; i < vertex.count; ++i) {
    const char* at = body.data() + static_cast<std::size_t>(i) * row;
    double value[6];
    for (std::size_t w = 0; w < 6; ++w) {
      value[w] = scalarOf(vertex.properties[header.columns[w]].second, at + offset[w]);
    }
    auto ok = addPoint(value, "Vertex " + std::to_string(i), name, points);
    if (!ok) return fail(ok.error());
  }
  return points;
}

}  // namespace

Result<PointShell> parseShell(std::string_view bytes, const std::string& name) {
  const auto header = parsePlyHeader(bytes, name);
  if (!header) return fail(header.error());
  auto points = header->binary ? parseBinary(*header, name) : parseAscii(*header, name);
  if (!points) return fail(points.error());
  auto shell = PointShell::fromPoints(std::move(points->points), std::move(points->normals));
  if (!shell) return fail(Error(shell.error()).inFile(name));
  return shell;
}

Result<PointShell> readShellFile(const std::filesystem::path& file) {
  const auto bytes = readInputFile(file);
  if (!bytes) return fail(bytes.error());
  return parseShell(*bytes, file.string());
}

}  // namespace palpate
