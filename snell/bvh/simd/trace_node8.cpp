#include "snell/bvh/simd/targets.h"
#include "snell/bvh/simd/traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "snell/bvh/simd/trace_node8.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "snell/bvh/simd/kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {
TraceKernels<Node8> node8_kernels()
{
    return all_kernels<Node8>();
}
} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace snell {

HWY_EXPORT(node8_kernels);

template <>
TraceKernels<Node8> trace_kernels()
{
    return HWY_DYNAMIC_DISPATCH(node8_kernels)();
}

std::vector<std::int64_t> traversal_targets()
{
    return hwy::SupportedAndGeneratedTargets();
}

} // namespace snell
#endif
