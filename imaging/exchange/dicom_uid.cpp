#include "imaging/exchange/dicom_uid.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>

namespace palpate {
namespace {

using Uuid = std::array<std::uint8_t, 16>;

/// The UUID as one whole number in decimal, at most 39 digits.
std::string uid(Uuid bytes, unsigned version) {
  bytes[6] = static_cast<std::uint8_t>((bytes[6] & 0x0FU) | version << 4U);
  bytes[8] = static_cast<std::uint8_t>((bytes[8] & 0x3FU) | 0x80U);  // RFC 9562's variant
  std::string digits;
  while (std::any_of(bytes.begin(), bytes.end(), [](std::uint8_t b) { return b != 0; })) {
    unsigned rest = 0;
    for (std::uint8_t& byte : bytes) {
      const unsigned value = rest << 8U | byte;
      byte = static_cast<std::uint8_t>(value / 10U);
      rest = value % 10U;
    }
    digits.insert(digits.begin(), static_cast<char>('0' + rest));
  }
  return "2.25." + digits;
}

}  // namespace

std::string randomUid() {
  std::random_device random;
  Uuid bytes{};
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() & 0xFFU);
  return uid(bytes, 4);
}

std::string uidOf(std::string_view text) {
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> hash{};
  unsigned size = 0;
  EVP_Digest(text.data(), text.size(), hash.data(), &size, EVP_sha256(), nullptr);
  Uuid bytes{};
  std::copy_n(hash.begin(), bytes.size(), bytes.begin());
  return uid(bytes, 8);  // RFC 9562: a UUID of the maker's own kind
}

}  // namespace palpate
