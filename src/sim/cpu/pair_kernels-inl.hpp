// The kernels of sim/physics/kernel.hpp on vectors; included once per instruction set.
#if defined(TALUS_PAIR_KERNELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TALUS_PAIR_KERNELS_INL
#undef TALUS_PAIR_KERNELS_INL
#else
#define TALUS_PAIR_KERNELS_INL
#endif

#include <hwy/highway.h>

#include "sim/physics/kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::cpu::HWY_NAMESPACE {

struct WendlandC2 {
    static float value_at_zero() { return kernels::WendlandC2::value(0.0f); }
    template <class D, class V>
    static V value(D d, V q) {
        namespace hn = hwy::HWY_NAMESPACE;
        const V t = hn::Sub(hn::Set(d, 1.0f), q), t2 = hn::Mul(t, t);
        const V shape = hn::MulAdd(q, hn::Set(d, 4.0f), hn::Set(d, 1.0f));
        return hn::Mul(hn::Mul(hn::Mul(t2, t2), shape), hn::Set(d, float(21 / (2 * std::numbers::pi))));
    }
    template <class D, class V>
    static V slope_over_q(D d, V q) {
        namespace hn = hwy::HWY_NAMESPACE;
        const V t = hn::Sub(hn::Set(d, 1.0f), q);
        return hn::Mul(hn::Mul(hn::Mul(t, t), t), hn::Set(d, float(210 / std::numbers::pi)));
    }
};

struct CubicSpline {
    static float value_at_zero() { return kernels::CubicSpline::value(0.0f); }
    template <class D, class V>
    static V value(D d, V q) {
        namespace hn = hwy::HWY_NAMESPACE;
        const V one = hn::Set(d, 1.0f), t = hn::Sub(one, q), c = hn::Set(d, float(8 / std::numbers::pi));
        const V inner = hn::MulAdd(hn::Mul(hn::Mul(q, q), hn::Set(d, 6.0f)), hn::Sub(q, one), one);
        const V outer = hn::Mul(hn::Mul(hn::Mul(t, t), t), hn::Set(d, 2.0f));
        return hn::Mul(c, hn::IfThenElse(hn::Le(q, hn::Set(d, 0.5f)), inner, outer));
    }
    template <class D, class V>
    static V slope_over_q(D d, V q) {
        namespace hn = hwy::HWY_NAMESPACE;
        const V t = hn::Sub(hn::Set(d, 1.0f), q), c = hn::Set(d, float(48 / std::numbers::pi));
        const V half = hn::Set(d, 0.5f);
        const V inner = hn::NegMulAdd(q, hn::Set(d, 3.0f), hn::Set(d, 2.0f));
        const V outer = hn::Div(hn::Mul(t, t), hn::Max(q, half));
        return hn::Mul(c, hn::IfThenElse(hn::Le(q, half), inner, outer));
    }
};

struct Spiky {
    static float value_at_zero() { return kernels::Spiky::value(0.0f); }
    template <class D, class V>
    static V value(D d, V q) {
        namespace hn = hwy::HWY_NAMESPACE;
        const V t = hn::Sub(hn::Set(d, 1.0f), q);
        return hn::Mul(hn::Mul(hn::Mul(t, t), t), hn::Set(d, float(15 / std::numbers::pi)));
    }
    template <class D, class V>
    static V slope_over_q(D d, V q) {
        namespace hn = hwy::HWY_NAMESPACE;
        const V t = hn::Sub(hn::Set(d, 1.0f), q);
        const V c = hn::Set(d, float(45 / std::numbers::pi));
        return hn::Div(hn::Mul(c, hn::Mul(t, t)), hn::Max(q, hn::Set(d, 1e-6f)));
    }
};

struct Poly6Spiky {
    static float value_at_zero() { return kernels::Poly6::value(0.0f); }
    template <class D, class V>
    static V value(D d, V q) {
        namespace hn = hwy::HWY_NAMESPACE;
        const V t = hn::NegMulAdd(q, q, hn::Set(d, 1.0f));
        return hn::Mul(hn::Mul(hn::Mul(t, t), t), hn::Set(d, float(315 / (64 * std::numbers::pi))));
    }
    template <class D, class V>
    static V slope_over_q(D d, V q) {
        return Spiky::slope_over_q(d, q);
    }
};

}  // namespace talus::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
