#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#include "sim/device/backend.hpp"
#include "simd/parallel.hpp"

namespace talus::sim::device {

/// Runs kernels as plain loops over the threads of the processor. Results do not depend on their number. Counts the
/// bytes that a card would copy.
class HostExecutor {
  public:
    [[nodiscard]] static std::string name() { return "host"; }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }

    [[nodiscard]] void* allocate(std::size_t bytes) {
        bytes_ += bytes;
        return ::operator new(bytes, alignment);
    }
    void release(void* memory, std::size_t bytes) {
        bytes_ -= bytes;
        ::operator delete(memory, alignment);
    }
    [[nodiscard]] Traffic traffic() const { return traffic_; }
    void upload(void* to, const void* from, std::size_t bytes) {
        traffic_.to_device += bytes;
        copy(to, from, bytes);
    }
    void download(void* to, const void* from, std::size_t bytes) {
        traffic_.to_host += bytes;
        copy(to, from, bytes);
    }
    static void copy(void* to, const void* from, std::size_t bytes) {
        if (bytes > 0) std::memcpy(to, from, bytes);
    }

    /// Calls kernel(i) for every i below `count`.
    template <class Kernel>
    static void for_each(std::size_t count, const Kernel& kernel) {
        simd::parallel_ranges(count, 256, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) kernel(static_cast<std::uint32_t>(i));
        });
    }
    /// The values kernel(i) joined; in a fixed order.
    template <class Value, class Kernel, class Join>
    [[nodiscard]] Value reduce(std::size_t count, const Value& identity, const Kernel& kernel, const Join& join) {
        traffic_.to_host += (count + reduce_span - 1) / reduce_span * sizeof(Value);  // as a card
        return simd::reduce_ranges(
            count, reduce_span, identity,
            [&](std::size_t first, std::size_t last, Value value) {
                for (std::size_t i = first; i < last; ++i) value = join(value, kernel(static_cast<std::uint32_t>(i)));
                return value;
            },
            join);
    }
    /// Every value becomes the sum of those before it; the sum of all stands behind them, and is returned.
    std::uint32_t sum_up(std::uint32_t* values, std::size_t count) {
        traffic_.to_host += sizeof *values;
        std::uint32_t sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t here = values[i];
            values[i] = sum;
            sum += here;
        }
        return values[count] = sum;
    }
    /// Sorts keys of `bits` bits, and values with them; equal keys keep their order. `swap`: room for as many.
    static void sort(std::uint64_t* keys, std::uint64_t* /*keys_swap*/, std::uint32_t* values,
                     std::uint32_t* values_swap, std::size_t count, int /*bits*/) {
        std::vector<std::uint32_t> order(count);
        for (std::uint32_t i = 0; i < count; ++i) order[i] = i;
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
        for (std::size_t i = 0; i < count; ++i) values_swap[i] = values[order[i]];
        std::copy_n(values_swap, count, values);
        std::sort(keys, keys + count);
    }

  private:
    static constexpr std::align_val_t alignment{64};
    static constexpr std::size_t reduce_span = 4096;
    std::size_t bytes_ = 0;
    Traffic traffic_;
};

}  // namespace talus::sim::device
