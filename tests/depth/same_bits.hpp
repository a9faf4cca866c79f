#pragma once

#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "depth/solver.hpp"
#include "simd/dispatch.hpp"

namespace talus::test {

/// What `run` returns, a solver at the end of a run, has the same hash and as many updated cells on 1, 2 and 5 threads
/// and any instruction set.
template <class Run>
void expect_same_bits(const Run& run) {
    std::uint64_t expected = 0, updates = 0;
    const auto expect_same = [&](const std::string& with) {
        const depth::Solver solver = run();
        if (expected == 0) expected = solver.hash(), updates = solver.cell_updates();
        EXPECT_EQ(solver.hash(), expected) << with;
        EXPECT_EQ(solver.cell_updates(), updates) << with;
    };
    for (const std::size_t threads : {1, 2, 5}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        expect_same(std::to_string(threads) + " threads");
    }
    for (const std::string& set : simd::instruction_sets()) {
        ASSERT_TRUE(simd::choose_instruction_set(set));
        expect_same(set);
    }
    ASSERT_TRUE(simd::choose_instruction_set(simd::instruction_sets().front()));
}

}  // namespace talus::test
