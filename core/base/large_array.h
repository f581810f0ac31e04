#pragma once
/// A large array of plain values: on huge pages where the system has them, or a view of a mapped
/// file.
///
/// Read by the loops at random places, so page-table misses count: above 2 MiB the memory asks for
/// huge pages. A view of a file is private to the process (copy on write): it may be changed, and
/// the file is not. Not for the loops to resize; one owner, moved or copied as a value.

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace palpate {

template <class T>
class LargeArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;
  /// Bytes that may be read past the end, so that whole vectors can be loaded there.
  static constexpr std::size_t kSlackBytes = 64;

  LargeArray() noexcept = default;
  LargeArray(const LargeArray& other) { *this = other; }
  LargeArray(LargeArray&& other) noexcept { swap(other); }
  LargeArray& operator=(const LargeArray& other) {
    if (this == &other) return *this;
    LargeArray copy;
    copy.reserve(other.size_);
    if (other.size_ > 0) std::memcpy(copy.data_, other.data_, other.size_ * sizeof(T));
    copy.size_ = other.size_;
    swap(copy);
    return *this;
  }
  LargeArray& operator=(LargeArray&& other) noexcept {
    swap(other);
    return *this;
  }
  ~LargeArray() { release(); }

  /// A view of `count` values at `at`, in memory that `owner` keeps (kSlackBytes readable behind).
  [[nodiscard]] static LargeArray view(T* at, std::size_t count, std::shared_ptr<void> owner) {
    LargeArray array;
    array.data_ = at;
    array.size_ = count;
    array.capacity_ = count;
    array.owner_ = std::move(owner);
    return array;
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] std::size_t bytes() const noexcept { return size_ * sizeof(T); }
  [[nodiscard]] T* data() noexcept { return data_; }
  [[nodiscard]] const T* data() const noexcept { return data_; }
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }
  [[nodiscard]] T* begin() noexcept { return data_; }
  [[nodiscard]] T* end() noexcept { return data_ + size_; }
  [[nodiscard]] const T* begin() const noexcept { return data_; }
  [[nodiscard]] const T* end() const noexcept { return data_ + size_; }
  [[nodiscard]] const T& back() const noexcept { return data_[size_ - 1]; }

  void reserve(std::size_t capacity) {
    if (capacity <= capacity_) return;
    LargeArray grown;
    grown.allocate(capacity);
    if (size_ > 0) std::memcpy(grown.data_, data_, size_ * sizeof(T));
    grown.size_ = size_;
    swap(grown);
  }
  /// New values are zero.
  void resize(std::size_t size) {
    if (size > capacity_) reserve(std::max(size, size_ == 0 ? size : size_ + size_ / 2));
    if (size > size_) std::memset(static_cast<void*>(data_ + size_), 0, (size - size_) * sizeof(T));
    size_ = size;
  }
  void assign(std::size_t size, const T& value) {
    resize(size);
    std::fill(begin(), end(), value);
  }
  void push_back(const T& value) {
    const T copy = value;
    resize(size_ + 1);
    data_[size_ - 1] = copy;
  }
  void append(const T* from, std::size_t count) {
    const std::size_t at = size_;
    resize(size_ + count);
    if (count > 0) std::memcpy(data_ + at, from, count * sizeof(T));
  }
  [[nodiscard]] bool operator==(const LargeArray& other) const noexcept {
    return size_ == other.size_ &&
           (size_ == 0 || std::memcmp(data_, other.data_, size_ * sizeof(T)) == 0);
  }

 private:
  static constexpr std::size_t kHugePage = std::size_t{2} << 20;

  void allocate(std::size_t capacity) {
    const std::size_t bytes = capacity * sizeof(T) + kSlackBytes;
    if (bytes < kHugePage) {
      data_ = static_cast<T*>(::operator new (bytes, std::align_val_t{64}));
    } else {
      mapped_ = (bytes + kHugePage - 1) / kHugePage * kHugePage;
      void* at = mmap(nullptr, mapped_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
      if (at == MAP_FAILED) {
        mapped_ = 0;
        throw std::bad_alloc();
      }
      madvise(at, mapped_, MADV_HUGEPAGE);
      data_ = static_cast<T*>(at);
    }
    std::memset(reinterpret_cast<char*>(data_) + capacity * sizeof(T), 0, kSlackBytes);
    capacity_ = capacity;
  }
  void release() noexcept {
    if (data_ == nullptr || owner_ != nullptr) return;
    if (mapped_ > 0) {
      munmap(data_, mapped_);
    } else {
      ::operator delete (data_, std::align_val_t{64});
    }
  }
  void swap(LargeArray& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
    std::swap(mapped_, other.mapped_);
    owner_.swap(other.owner_);
  }

  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
  std::size_t mapped_ = 0;       // bytes of an own mapping, 0: from the heap
  std::shared_ptr<void> owner_;  // of a view
};

}  // namespace palpate
