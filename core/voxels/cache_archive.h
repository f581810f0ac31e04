#pragma once
/// Values and arrays to and from the bytes of a cache file. Internal to tree_cache.cpp.

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/large_array.h"

namespace palpate {

/// Arrays begin at multiples of this in the file, so that they can be used where they are mapped,
/// and have LargeArray's slack behind them.
inline constexpr std::size_t kCacheAlignment = 64;

/// Appends.
class CacheWriter {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  template <class Array>
  void array(const Array& v) {
    value(static_cast<std::uint64_t>(v.size()));
    bytes_.resize((bytes_.size() + kCacheAlignment - 1) / kCacheAlignment * kCacheAlignment, '\0');
    if (v.size() > 0) {
      bytes_.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(v.data()[0]));
    }
    bytes_.append(LargeArray<char>::kSlackBytes, '\0');
  }
  [[nodiscard]] std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;  // after the header, whose size is a multiple of the alignment
};

/// Reads what CacheWriter wrote; every length is checked against what is left before anything is
/// taken. With an owner arrays are views of its memory, which is aligned; without they are copied.
class CacheReader {
 public:
  CacheReader(char* bytes, std::size_t size, std::shared_ptr<void> owner)
      : bytes_(bytes), size_(size), owner_(std::move(owner)) {}

  template <class T>
  void value(T& v) {
    if (size_ - at_ < sizeof v) {
      good_ = false;
      return;
    }
    if constexpr (std::is_same_v<T, bool>) {
      v = bytes_[at_] != 0;  // any other byte would not be a bool
    } else {
      std::memcpy(&v, bytes_ + at_, sizeof v);
    }
    at_ += sizeof v;
  }
  template <class T>
  void array(LargeArray<T>& v) {
    const std::size_t count = begin(sizeof(T));
    if (!good_) return;
    if (owner_ != nullptr && count > 0) {
      v = LargeArray<T>::view(reinterpret_cast<T*>(bytes_ + at_), count, owner_);
    } else {
      v.resize(count);
      if (count != 0) std::memcpy(v.data(), bytes_ + at_, count * sizeof(T));
    }
    end(count * sizeof(T));
  }
  template <class T>
  void array(std::vector<T>& v) {
    const std::size_t count = begin(sizeof(T));
    if (!good_) return;
    v.resize(count);
    if (count != 0) std::memcpy(v.data(), bytes_ + at_, count * sizeof(T));
    end(count * sizeof(T));
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool atEnd() const { return good_ && at_ == size_; }

 private:
  std::size_t begin(std::size_t each) {
    std::uint64_t count = 0;
    value(count);
    const std::size_t start = (at_ + kCacheAlignment - 1) / kCacheAlignment * kCacheAlignment;
    constexpr std::size_t kSlack = LargeArray<char>::kSlackBytes;
    if (!good_ || start > size_ || size_ - start < kSlack ||
        count > (size_ - start - kSlack) / each) {
      good_ = false;
      return 0;
    }
    at_ = start;
    return static_cast<std::size_t>(count);
  }
  void end(std::size_t bytes) { at_ += bytes + LargeArray<char>::kSlackBytes; }

  char* bytes_;
  std::size_t size_, at_ = 0;
  std::shared_ptr<void> owner_;
  bool good_ = true;
};

}  // namespace palpate
