#include "snell/view/timings.h"

#include <algorithm>
#include <vector>

namespace snell::view {

void TimingSeries::add(double ms)
{
    constexpr std::size_t kept = 1000;
    values_.push_back(ms);
    if (values_.size() > kept) values_.pop_front();
    ++count_;
}

double TimingSeries::percentile(double p) const
{
    if (values_.empty()) return 0.0;
    std::vector<double> sorted(values_.begin(), values_.end());
    const auto at = static_cast<std::size_t>(std::clamp(p, 0.0, 1.0) * static_cast<double>(sorted.size() - 1) + 0.5);
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(at), sorted.end());
    return sorted[at];
}

} // namespace snell::view
