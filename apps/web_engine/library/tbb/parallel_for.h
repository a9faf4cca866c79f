#pragma once

#include "tbb/blocked_range.h"

namespace tbb {

template <class Range, class Body>
void parallel_for(const Range& range, const Body& body) {
    if (range.empty()) return;
    if (!range.is_divisible()) return body(range);
    parallel_for(Range(range.begin(), range.middle(), range.grainsize()), body);
    parallel_for(Range(range.middle(), range.end(), range.grainsize()), body);
}

}  // namespace tbb
