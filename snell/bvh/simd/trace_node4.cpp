#include "snell/bvh/simd/targets.h"
#include "snell/bvh/simd/traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "snell/bvh/simd/trace_node4.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "snell/bvh/simd/kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {
TraceKernels<Node4> node4_kernels()
{
    return all_kernels<Node4>();
}
} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace snell {

HWY_EXPORT(node4_kernels);

template <>
TraceKernels<Node4> trace_kernels()
{
    return HWY_DYNAMIC_DISPATCH(node4_kernels)();
}

} // namespace snell
#endif
