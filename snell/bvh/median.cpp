// The spatial median: what a first course builds.
#include "snell/bvh/partition.h"
#include "snell/bvh/top_down.h"

namespace snell {
namespace {

class MedianSplitter : public RefPartition
{
  public:
    using Part = RefPart;
    using RefPartition::RefPartition;

    void split(const Part& part, bool halve_it, Part& left, Part& right)
    {
        const Box centres = part.extents.centre.box(); // of twice the centres
        int axis = 0;
        double widest = -1;
        for (int i = 0; i < 3; ++i) {
            const double width = double(centres.upper[i]) - centres.lower[i];
            if (width > widest) axis = i, widest = width;
        }
        const float middle = 0.5f * centres.lower[axis] + 0.5f * centres.upper[axis];
        // Rounding may put the middle of neighbouring floats, or of infinite ones, on an end: then nothing is below.
        if (halve_it || !(centres.lower[axis] < middle)) return halve(part, left, right);
        RefPartition::split(
            part, [&](const PrimitiveRef& ref) { return centre2(ref, axis) < middle; }, left, right);
    }
};

} // namespace

BinaryTree build_median(const PackedScene&, std::vector<PrimitiveRef> refs, const BuildOptions&)
{
    const std::size_t count = refs.size();
    if (count == 0) return {};
    MedianSplitter splitter(std::move(refs));
    return TopDown(splitter).run(count);
}

} // namespace snell
