#pragma once

#include "tbb/blocked_range.h"

namespace tbb {

template <class Range, class Value, class Body, class Join>
Value parallel_deterministic_reduce(const Range& range, const Value& identity, const Body& body, const Join& join) {
    if (range.empty()) return identity;
    if (!range.is_divisible()) return body(range, identity);
    const Value left =
        parallel_deterministic_reduce(Range(range.begin(), range.middle(), range.grainsize()), identity, body, join);
    return join(left, parallel_deterministic_reduce(Range(range.middle(), range.end(), range.grainsize()), identity,
                                                    body, join));
}

}  // namespace tbb
