#include "snell/bvh/simd/targets.h"
#include "snell/bvh/simd/traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "snell/bvh/simd/trace_quantised.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "snell/bvh/simd/kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {
TraceKernels<QuantisedNode> quantised_kernels()
{
    return all_kernels<QuantisedNode>();
}
} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace snell {

HWY_EXPORT(quantised_kernels);

template <>
TraceKernels<QuantisedNode> trace_kernels()
{
    return HWY_DYNAMIC_DISPATCH(quantised_kernels)();
}

} // namespace snell
#endif
