// Per-target include guard, as Highway wants it.
#if defined(PALPATE_PACK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PALPATE_PACK_INL_H_
#undef PALPATE_PACK_INL_H_
#else
#define PALPATE_PACK_INL_H_
#endif

#include <hwy/highway.h>

#include "core/collision/pack_table.h"

HWY_BEFORE_NAMESPACE();
namespace palpate {
namespace HWY_NAMESPACE {

/// The lanes of a mask to the front. Highway's own Compress (1.0.3) with GCC copies its table to
/// the stack at every call below AVX-512, which costs four times the whole step; this one doesn't.
template <class D>
class Packer {
 public:
  using M = hwy::HWY_NAMESPACE::Mask<D>;
  HWY_INLINE explicit Packer(M mask) : mask_(mask) {
    namespace hn = hwy::HWY_NAMESPACE;
    const D d;
    count_ = hn::CountTrue(d, mask);
    if (hn::Lanes(d) <= 8) {
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, mask, bits);
      lanes_ = kPackTable.lane[bits[0]].data();
    }
  }
  [[nodiscard]] HWY_INLINE std::size_t count() const { return count_; }
  /// Writes a whole vector; the first count() lanes are those of the mask.
  template <class T, class V>
  HWY_INLINE void store(V v, T* to) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::Rebind<T, D> dt;
#if HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_AVX3
    hn::StoreU(hn::Compress(v, hn::RebindMask(dt, mask_)), dt, to);
#elif HWY_TARGET == HWY_SCALAR
    hn::StoreU(v, dt, to);
#else
    const hn::RebindToSigned<decltype(dt)> di;
    hn::StoreU(hn::TableLookupLanes(v, hn::IndicesFromVec(dt, hn::LoadU(di, lanes_))), dt, to);
#endif
  }

 private:
  M mask_;
  std::size_t count_ = 0;
  const std::int32_t* lanes_ = nullptr;
};

}  // namespace HWY_NAMESPACE
}  // namespace palpate
HWY_AFTER_NAMESPACE();

#endif
