#include "snell/bvh/simd/targets.h"
#include "snell/bvh/simd/traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "snell/bvh/simd/trace_node2.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "snell/bvh/simd/kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {
TraceKernels<Node2> node2_kernels()
{
    return all_kernels<Node2>();
}
} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace snell {

HWY_EXPORT(node2_kernels);

template <>
TraceKernels<Node2> trace_kernels()
{
    return HWY_DYNAMIC_DISPATCH(node2_kernels)();
}

} // namespace snell
#endif
